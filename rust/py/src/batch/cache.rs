//! Kernels and ufuncs that were asked for, kept for the life of the process.
//!
//! A ufunc's name says how to make it again, so that it can be pickled by name: another process
//! asks the module for an attribute of that name.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

use echocal_core::Law;
use echocal_core::batch::{Kernel, Output, absorption, echo, speed_of_sound};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use super::arguments::Label;
use super::ufunc::ufunc;
use crate::errors::to_python;

/// A function over columns, before its laws are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    SpeedOfSound,
    Absorption,
    TimeOfFlight,
    Distance,
    Error,
}

impl Function {
    const ALL: [Self; 5] = [
        Self::SpeedOfSound,
        Self::Absorption,
        Self::TimeOfFlight,
        Self::Distance,
        Self::Error,
    ];

    /// Its name and the unit of its result.
    pub fn label(self) -> Label {
        let (name, unit) = match self {
            Self::SpeedOfSound => ("speed_of_sound", "m/s"),
            Self::Absorption => ("absorption", "dB/m"),
            Self::TimeOfFlight => ("time_of_flight", "s"),
            Self::Distance => ("distance", "m"),
            Self::Error => ("error", "m"),
        };
        Label { name, unit }
    }

    /// The kernel; `laws` is a law's text, of an error two of them with a bar between.
    fn kernel(self, laws: &str, at_frequency: bool) -> PyResult<Box<dyn Kernel>> {
        let parse = |text: &str| Law::parse(text).map_err(|e| to_python(&e));
        let (output, law) = match self {
            Self::Absorption => return Ok(absorption()),
            Self::SpeedOfSound => return Ok(speed_of_sound(parse(laws)?, at_frequency)),
            Self::TimeOfFlight => (Output::TimeOfFlight, laws),
            Self::Distance => (Output::Distance, laws),
            Self::Error => {
                let (reading, law) = laws.split_once('|').unwrap_or((laws, laws));
                (Output::Error(parse(reading)?), law)
            }
        };
        Ok(echo(output, parse(law)?, at_frequency))
    }
}

/// A kernel and the ufunc made of it.
pub struct Entry {
    name: String,
    kernel: Arc<dyn Kernel>,
    ufunc: PyOnceLock<Py<PyAny>>,
}

impl Entry {
    pub fn new(name: String, kernel: Box<dyn Kernel>) -> Self {
        Self {
            name,
            kernel: kernel.into(),
            ufunc: PyOnceLock::new(),
        }
    }

    pub fn kernel(&self) -> &dyn Kernel {
        &*self.kernel
    }

    pub fn ufunc<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyAny>> {
        let make = || ufunc(py, &self.name, self.kernel.clone()).map(Bound::unbind);
        Ok(self.ufunc.get_or_try_init(py, make)?.bind(py))
    }
}

type Entries = HashMap<String, &'static Entry>;
static ENTRIES: LazyLock<[Mutex<Entries>; 10]> = LazyLock::new(Default::default);

/// Entries of the default law: a call with plain numbers has no time for a lock and a hash.
static DEFAULTS: [OnceLock<&'static Entry>; 5] = [const { OnceLock::new() }; 5];

/// The law that the functions take by default.
pub const DEFAULT_LAW: &str = "cramer";

/// The entry of a function with its laws; made at the first call.
pub fn entry(function: Function, laws: &str, at_frequency: bool) -> PyResult<&'static Entry> {
    if at_frequency || laws != DEFAULT_LAW {
        return found(function, laws, at_frequency);
    }
    let place = &DEFAULTS[function as usize];
    match place.get() {
        Some(entry) => Ok(entry),
        None => found(function, laws, at_frequency).map(|entry| *place.get_or_init(|| entry)),
    }
}

fn found(function: Function, laws: &str, at_frequency: bool) -> PyResult<&'static Entry> {
    let place = &ENTRIES[2 * (function as usize) + usize::from(at_frequency)];
    let mut entries = place.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(entry) = entries.get(laws) {
        return Ok(entry);
    }
    let kernel = function.kernel(laws, at_frequency)?;
    let name = encoded(function, laws, at_frequency);
    let entry = Box::leak(Box::new(Entry::new(name, kernel)));
    entries.insert(laws.to_owned(), entry);
    Ok(entry)
}

/// `distance:cramer`, `speed_of_sound@frequency:331,3+0,606*T`: no dots, which pickle would split at.
fn encoded(function: Function, laws: &str, at_frequency: bool) -> String {
    let frequency = if at_frequency { "@frequency" } else { "" };
    format!(
        "{}{frequency}:{}",
        function.label().name,
        laws.replace('.', ",")
    )
}

/// The ufunc of an encoded name; `None` where the name is none.
pub fn decoded<'py>(py: Python<'py>, name: &str) -> Option<PyResult<Bound<'py, PyAny>>> {
    let (head, laws) = name.split_once(':')?;
    let plain = head.strip_suffix("@frequency");
    let (head, at_frequency) = (plain.unwrap_or(head), plain.is_some());
    let function = Function::ALL.into_iter().find(|f| f.label().name == head)?;
    if function == Function::Absorption && (at_frequency || !laws.is_empty()) {
        return None; // it has no law: every text would be another name of the same
    }
    let entry = entry(function, &laws.replace(',', "."), at_frequency);
    Some(entry.and_then(|entry| entry.ufunc(py).cloned()))
}
