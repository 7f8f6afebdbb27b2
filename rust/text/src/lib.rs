//! A table as text, some megabytes of whole lines at a time.
//!
//! From the bottom to the top; each module uses only those before it:
//!
//! - [`number`]: one field as a number;
//! - [`digits`]: one number as the fewest digits that are the number again;
//! - [`lines`]: where the lines end;
//! - [`columns`]: the numbers of some columns;
//! - [`fields`]: the fields of some columns as texts, quoted ones too;
//! - [`results`]: the lines again, with results behind each of them.
//!
//! What is not plain is declined, never guessed: who asks has another way for it. Nothing here reads a file
//! or knows of Python.

#![cfg_attr(test, allow(clippy::suboptimal_flops))] // tests state expected values plainly

mod bytes;
pub mod columns;
pub mod digits;
pub mod fields;
pub mod lines;
pub mod number;
pub mod results;
