//! Python binding of echocal: conversion only.

use pyo3::prelude::*;

mod domain;
mod errors;
mod firmware;
mod model;
mod registry;

/// The compiled core of echocal.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::domain::{departure, departure_names, departures};
    #[pymodule_export]
    use super::firmware::{CoreFirmware, design_firmware};
    #[pymodule_export]
    use super::model::CoreModel;
    #[pymodule_export]
    use super::registry::{effects, laws, quantities};
}
