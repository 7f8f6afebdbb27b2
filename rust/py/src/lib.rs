//! Python binding of echocal: arguments are converted and checked here, and kernels become NumPy ufuncs.

use pyo3::prelude::*;

mod batch;
mod border;
mod columns;
mod columns_layout;
mod domain;
mod errors;
mod firmware;
mod firmware_request;
mod infer;
mod infer_checks;
mod infer_classes;
mod laws;
mod model;
mod registry;
mod sums;
mod text;
mod threads;

/// The compiled core of echocal.
#[pymodule]
mod _core {
    use pyo3::prelude::*;

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
    use super::firmware::{
        CoreFirmware, design_firmware, echo_times, firmware_targets, output_units,
    };
    #[pymodule_export]
    use super::infer::{fit_hypotheses, posterior, preferred_form};
    #[pymodule_export]
    use super::infer_classes::{
        CoreForm, CoreHypothesisFit, CoreOutcome, CorePosterior, CorePrior, CoreSearchOptions,
    };
    #[pymodule_export]
    use super::model::CoreModel;
    #[pymodule_export]
    use super::registry::{effects, laws, quantities};
    #[pymodule_export]
    use super::sums::{CoreNoiseModel, CoreSums, whitened};
    #[pymodule_export]
    use super::text::{CoreLines, CoreScanner};

    /// Takes over what the environment says.
    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::threads::limit_from_environment()
    }
}
