//! Python binding of echocal: arguments are converted and checked here, and kernels become NumPy ufuncs.

use pyo3::prelude::*;

mod batch;
mod border;
mod columns;
mod domain;
mod errors;
mod firmware;
mod infer;
mod laws;
mod model;
mod noise;
mod registry;
mod sums;

/// The compiled core of echocal.
#[pymodule]
mod _core {
    /// Version of the crates and of the package.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "the name that Python's packages use")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use super::batch::{
        absorption, distance, error, instruction_sets, module_attribute, set_instruction_set,
        speed_of_sound, time_of_flight,
    };
    #[pymodule_export]
    use super::columns::CoreColumns;
    #[pymodule_export]
    use super::domain::{departure, departure_names, departures};
    #[pymodule_export]
    use super::firmware::{CoreFirmware, design_firmware, echo_times};
    #[pymodule_export]
    use super::infer::{left_over, posterior, weigh};
    #[pymodule_export]
    use super::model::CoreModel;
    #[pymodule_export]
    use super::noise::{log_density, slips};
    #[pymodule_export]
    use super::registry::{effects, laws, quantities};
    #[pymodule_export]
    use super::sums::{CoreSums, whitened};
}
