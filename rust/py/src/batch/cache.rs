//! Kernels and ufuncs that were asked for: those of the default law for the life of the process, of each
//! other law while it is among the last that were used.
//!
//! A ufunc's name says how to make it again, so that it can be pickled by name: another process
//! asks the module for an attribute of that name.

use std::ops::Deref;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError};

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

    /// Whether somebody else has the ufunc. Python pickles it by name, so it must stay the one of its name.
    #[allow(unsafe_code)]
    fn is_held(&self, py: Python<'_>) -> bool {
        // SAFETY: the pointer leads to a living object, and Python is attached.
        let count = |ufunc: &Py<PyAny>| unsafe { pyo3::ffi::Py_REFCNT(ufunc.as_ptr()) };
        self.ufunc.get(py).map(count).is_some_and(|count| count > 1)
    }

    pub fn kernel(&self) -> &dyn Kernel {
        &*self.kernel
    }

    pub fn ufunc<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyAny>> {
        let make = || ufunc(py, &self.name, self.kernel.clone()).map(Bound::unbind);
        Ok(self.ufunc.get_or_try_init(py, make)?.bind(py))
    }
}

/// Laws that are kept for each function, beside the default.
const KEPT: usize = 64;

/// Laws and their entries, from the one used longest ago to the last.
type Recent = Vec<(String, Arc<Entry>)>;
static RECENT: LazyLock<[Mutex<Recent>; 10]> = LazyLock::new(Default::default);

/// Entries of the default law: a call with plain numbers has no time for a lock.
static DEFAULTS: [OnceLock<Entry>; 5] = [const { OnceLock::new() }; 5];

/// The law that the functions take by default.
pub const DEFAULT_LAW: &str = "cramer";

/// An entry for as long as a call takes.
pub enum Held {
    /// Of the default law.
    Default(&'static Entry),
    /// Of another one.
    Kept(Arc<Entry>),
}

impl Deref for Held {
    type Target = Entry;

    fn deref(&self) -> &Entry {
        match self {
            Self::Default(entry) => entry,
            Self::Kept(entry) => entry,
        }
    }
}

/// The entry of a function with its laws; made where it is not kept.
pub fn entry(py: Python<'_>, function: Function, laws: &str, at_frequency: bool) -> PyResult<Held> {
    let make = || {
        let kernel = function.kernel(laws, at_frequency)?;
        Ok::<_, PyErr>(Entry::new(encoded(function, laws, at_frequency), kernel))
    };
    if at_frequency || laws != DEFAULT_LAW {
        let place = &RECENT[2 * (function as usize) + usize::from(at_frequency)];
        return kept(py, place, laws, make).map(Held::Kept);
    }
    let place = &DEFAULTS[function as usize];
    if place.get().is_none() {
        let _ = place.set(make()?); // another thread may have set the same meanwhile
    }
    Ok(Held::Default(place.get().expect("it was set above")))
}

/// The entry of these laws, as the last one used.
///
/// No Python runs while the lock is held, which a thread that waits for it could block.
fn kept(
    py: Python<'_>,
    place: &Mutex<Recent>,
    laws: &str,
    make: impl FnOnce() -> PyResult<Entry>,
) -> PyResult<Arc<Entry>> {
    if let Some(entry) = used(&mut locked(place), laws) {
        return Ok(entry);
    }
    let made = Arc::new(make()?);
    let mut recent = locked(place);
    if let Some(entry) = used(&mut recent, laws) {
        return Ok(entry); // another thread was faster
    }
    recent.push((laws.to_owned(), Arc::clone(&made)));
    let oldest = recent.iter().position(|(_, entry)| !entry.is_held(py));
    let left = oldest
        .filter(|_| recent.len() > KEPT)
        .map(|at| recent.remove(at));
    drop(recent);
    drop(left);
    Ok(made)
}

fn locked(place: &Mutex<Recent>) -> MutexGuard<'_, Recent> {
    place.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The entry of these laws where it is kept; it becomes the last one used.
fn used(recent: &mut Recent, laws: &str) -> Option<Arc<Entry>> {
    let at = recent.iter().rposition(|(kept, _)| kept == laws)?;
    recent[at..].rotate_left(1);
    recent.last().map(|(_, entry)| Arc::clone(entry))
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
    let entry = entry(py, function, &laws.replace(',', "."), at_frequency);
    Some(entry.and_then(|entry| entry.ufunc(py).cloned()))
}
