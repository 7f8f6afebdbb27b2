//! Fixed-point C from a calibrated model, proven over every input.
//!
//! [`design`](design()) searches the cheapest form that meets the error bound. The bit-exact twin in [`ir`] evaluates it.
//! [`mod@prove`] checks it on every input. [`mod@emit`] writes it as C. Text and twin are made from one [`ir::Program`].
//!
//! The rooms, from the ground up. A file imports only rooms above its own line in this list, and no two files import each
//! other; `tests/firmware/test_rooms.py` reads this list and checks it.
//!
//! 1. `types`: integer types of C and their ranges. `error`: the errors. `affine`, `jet`, `minimax`: numerics. `hash`:
//!    the hash of all outputs.
//! 2. `axis`: the codes of one quantity. `output`: the unit and the type of the result.
//! 3. `device`: the codes that the device measures. `filter`: the median of the last outputs.
//! 4. `ir`: programs of exact integer operations, and the twin.
//! 5. `reference`: the model that a program must follow. `target`: costs on each core.
//! 6. `lower`: a calibrated model as that reference. `form`: ways to compute the speed factor. `prove`: the proof.
//! 7. `design`: the search.
//! 8. `emit`: the texts.
//!
//! In the code `[unit]` is the unit of the output, micrometers by default. Times are echo codes. In the public interface
//! distances are in meters.

pub mod affine;
pub mod axis;
pub mod design;
pub mod device;
pub mod emit;
pub mod error;
pub mod filter;
pub mod form;
pub mod hash;
pub mod ir;
pub mod jet;
pub mod lower;
pub mod minimax;
pub mod output;
pub mod prove;
pub mod reference;
pub mod target;
pub mod types;

pub use axis::{Axis, Codes, Curve};
pub use design::{Design, Failure, Progress, Reachable, Request, design};
pub use device::{Device, Status};
pub use emit::{Measurement, Package, Provenance, Uncertainty, emit};
pub use error::Error;
pub use filter::Filter;
pub use output::Output;
pub use target::{Prefer, Target};
