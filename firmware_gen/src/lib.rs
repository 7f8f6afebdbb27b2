//! Fixed-point C from a calibrated model, proven over every input.
//!
//! `design` searches the cheapest form that meets the error bound, the bit-exact twin in `ir` evaluates it, `prove`
//! checks it on every input, `emit` writes it as C. Text and twin are made from one [`ir::Program`].
//!
//! Inside the search `[unit]` is the unit of the output, micrometers unless another is asked for, and times are echo
//! codes; at the border distances are m.

pub mod affine;
pub mod design;
pub mod device;
pub mod emit;
pub mod error;
pub mod form;
pub mod ir;
pub mod lower;
pub mod minimax;
pub mod output;
pub mod prove;
pub mod reference;
pub mod target;
pub mod types;

pub use design::{Design, Failure, Progress, Reachable, Request, design};
pub use device::{Axis, Device};
pub use emit::{Measurement, Package, Provenance, emit};
pub use error::Error;
pub use output::Output;
pub use target::{Prefer, Target};
