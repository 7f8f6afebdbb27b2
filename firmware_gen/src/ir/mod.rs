//! Straight-line programs of exact integer operations: the one form from which the C text, the bit-exact twin and the
//! overflow proof are all made, so that they cannot drift apart.
//!
//! The meaning of a node is mathematics, not machine arithmetic: `a + b` is the exact sum. Each node also *claims* a
//! type in which its operands and its result fit. [`Builder`] derives the claims, the proof checks them on every
//! input, and the C text spells them out as casts; while they hold, C99 computes the exact value on any `int` width,
//! with no signed overflow, no wrap-around and no shift of a negative number.

mod block;
mod builder;
mod program;
mod twin;

pub use crate::types::{IntegerType, Range};
pub use block::{Block, LANES};
pub use builder::{Builder, told};
pub use program::{Node, Operation, Program, Table, TableId, Value};
pub use twin::Overflow;
