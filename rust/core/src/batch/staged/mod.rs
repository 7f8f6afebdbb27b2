//! Models over blocks of rows, stage by stage.
//!
//! All effects in one function, on registers of several numbers with a derivative, would take the
//! compiler more than ten minutes, and run slowly where a model has one effect. Here each effect
//! is a function of its own, which changes the variable of its stage over a block of rows; between
//! the functions the variables lie in the first caches. The operations are those of
//! [`Model::simulate`](crate::Model::simulate), in the same order: the same bits.

mod kernels;
mod newton;
mod pass;
mod reader;
mod tracks;

pub(crate) use pass::{Pass, is_alone, prepare};
pub(crate) use reader::BlockReader;
pub use tracks::{BLOCK, Line};
pub(crate) use tracks::{Reading, TRACKS, tracks_of};
