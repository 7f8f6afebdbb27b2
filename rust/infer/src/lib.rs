//! What a table of readings says about the causes of its errors.
//!
//! From the bottom to the top; each module uses only those before it:
//!
//! - [`gram`]: one pass over the rows, which leaves sums of products of columns;
//! - [`columns`]: what each candidate cause would add to the readings;
//! - [`noise`]: models of noise, and the sums whitened for each;
//! - [`solve`]: the log evidence of one hypothesis, from small linear systems;
//! - [`search`]: priors, hypotheses, pruning, and the posterior over all hypotheses.
//!
//! The physics is in [`echocal_core`]; nothing here reads a file or knows of Python.

#![cfg_attr(test, allow(clippy::suboptimal_flops))] // tests state expected values plainly

pub mod columns;
pub mod gram;
pub mod noise;
mod numeric;
mod parallel;
pub mod search;
pub mod solve;
