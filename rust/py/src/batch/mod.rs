//! The batch functions of `echocal`: arguments in, result out.

mod cache;
mod call;
mod functions;
mod ufunc;

pub use functions::{
    absorption, distance, error, instruction_sets, module_attribute, set_instruction_set,
    speed_of_sound, time_of_flight,
};
