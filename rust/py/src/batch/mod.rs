//! The batch functions of `echocal`: arguments in, result out.

mod absurd;
mod arguments;
mod cache;
mod call;
mod direct;
mod documentation;
mod explain;
mod functions;
mod module;
mod output;
mod precision;
mod ufunc;

pub use absurd::{ANY, range_of};
pub use arguments::{Input, Label, Options, Threads};
pub use cache::Entry;
pub use call::call;
pub use functions::{absorption, distance, error, speed_of_sound, time_of_flight};
pub use module::{instruction_sets, module_attribute, set_instruction_set};
