//! The search: which form, which format, at least cost within the error bound.

mod search;
#[cfg(test)]
mod tests;

use crate::device::Device;
use crate::error::Error;
use crate::form::{FORMS, Form, OF_TWO, Tail};
use crate::ir::Program;
use crate::prove::Proof;
use crate::reference::Reference;
use crate::target::{Prefer, Target};
use search::Search;
use std::fmt;
use std::sync::Arc;

/// What is asked for.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The truth.
    pub reference: &'a dyn Reference,
    /// The inputs.
    pub device: &'a Device,
    /// Largest error allowed \[m\].
    pub maximum_error: f64,
    /// Distances up to this are bounded \[m\].
    pub maximum_distance: f64,
    /// Largest tables allowed, together \[byte\].
    pub maximum_table: usize,
    /// Where it is to run.
    pub target: Target,
    /// The only form to try; `None`: all of them.
    pub form: Option<&'a str>,
    /// What to save.
    pub prefer: Prefer,
    /// Threads for the proof.
    pub threads: usize,
}

/// What was found, with its proof.
#[derive(Debug)]
pub struct Design {
    /// How the speed factor comes about.
    pub form: Box<dyn Form>,
    /// How the distance follows from it.
    pub tail: Tail,
    /// The function.
    pub program: Program,
    /// What holds for it on every input.
    pub proof: Proof,
}

/// Output for codes that the function does not accept: `INT32_MIN`.
pub const OUT_OF_RANGE: i32 = i32::MIN;

impl Design {
    /// What the generated function returns for `inputs`, also for codes out of range.
    #[must_use]
    pub fn output(&self, device: &Device, inputs: &[i64]) -> i32 {
        let mut codes = device.axes().zip(inputs);
        let accepted = codes.all(|(axis, code)| axis.codes.contains(*code));
        // The proof leaves no accepted input without an output that fits.
        let output = accepted
            .then(|| self.program.evaluate(inputs).ok())
            .flatten();
        output
            .and_then(|output| i32::try_from(output).ok())
            .unwrap_or(OUT_OF_RANGE)
    }
}

/// The best that can be had when the bound cannot.
#[derive(Clone, Debug)]
pub struct Reachable {
    /// The bound that was asked for \[m\].
    pub asked: f64,
    /// The error that the best candidate was proven to have \[m\].
    pub best: f64,
    /// Where distances are bounded \[m\].
    pub maximum_distance: f64,
    /// The best candidate.
    pub design: Arc<Design>,
}

impl fmt::Display for Reachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let asked = (self.asked * 1e12).round() / 1e9;
        let best = self.best * 1e3;
        // The way out must hold when it is typed: rounded up, not to nearest.
        let enough = (best * 1e4).ceil() / 1e4;
        write!(
            f,
            "an error of {asked} mm up to {} m cannot be met: the best reachable is {best:.4} mm ({}); ask for {enough} mm or more",
            self.maximum_distance,
            self.design.form.describe()
        )
    }
}

/// What the caller hears of.
pub enum Progress<'a> {
    /// A candidate goes into the proof.
    Candidate(&'a str),
    /// So many inputs of it are checked.
    Checked(u64),
}

/// How the caller listens; `false` stops.
pub type Listen<'a> = &'a mut dyn FnMut(Progress<'_>) -> bool;

/// Candidates that may turn out not to meet the bound before only those are tried that probably do.
const PATIENCE: usize = 200;

/// Find the cheapest program that meets the bound on every input.
///
/// # Errors
/// [`Error::Bound`] with the best reachable if none does; [`Error::Model`] if the model itself fails somewhere.
pub fn design(request: Request<'_>, listen: Listen<'_>) -> Result<Design, Error> {
    check(&request)?;
    let search = Search::new(request)?;
    // The cheapest last; rounding can make a candidate dearer, which then waits for its turn again.
    let key =
        |candidate: &search::Candidate<'_>| std::cmp::Reverse(request.prefer.key(candidate.cost));
    let mut candidates = search.candidates();
    candidates.reverse(); // of equals, the one proposed first comes first
    candidates.sort_by_key(key);
    let bound = request.maximum_error * request.device.output.per_meter;
    let mut failed = Vec::new();
    let mut tried = 0;
    while let Some(mut candidate) = candidates.pop() {
        if candidate.screened == f64::INFINITY
            && candidate.floor() <= bound
            && candidate.least() <= bound
            && (tried < PATIENCE || candidate.likely() <= bound)
            && search.refine(&mut candidate)
        {
            tried += 1;
            let place = candidates.partition_point(|other| key(other) <= key(&candidate));
            candidates.insert(place, candidate);
            continue;
        }
        if candidate.screened <= bound {
            match search.prove(&candidate, bound, listen) {
                Ok((program, proof)) => return Ok(candidate.proven(program, proof)),
                Err(Error::Beyond(error)) => candidate.screened = error,
                Err(Error::Proof(_)) => {}
                Err(error) => return Err(error),
            }
        }
        failed.push(candidate);
    }
    search.unreachable(failed, listen)
}

/// Bound [m] above which somebody has most likely written millimeters.
const LOOSEST: f64 = 0.1;

fn check(request: &Request<'_>) -> Result<(), Error> {
    for (what, value, unit) in [
        ("error bound", request.maximum_error * 1e3, "mm"),
        ("largest bounded distance", request.maximum_distance, "m"),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::Request(format!(
                "the {what} is {value} {unit}: give a positive number [{unit}]"
            )));
        }
    }
    if request.maximum_error > LOOSEST {
        return Err(Error::Request(format!(
            "the error bound is {} mm, and no distance sensor needs one above {} mm: 0.5 mm is \
             max_error=0.5e-3 [m] in Python, --max-error-mm 0.5 on the command line",
            request.maximum_error * 1e3,
            LOOSEST * 1e3
        )));
    }
    check_form(request)?;
    if !(1..=2).contains(&request.device.conditions.len()) {
        let given = request.device.conditions.len();
        return Err(Error::Request(format!(
            "the device has {given} condition inputs; this version designs for one or two"
        )));
    }
    Ok(())
}

/// Whether the form asked for exists, and takes what the device measures.
fn check_form(request: &Request<'_>) -> Result<(), Error> {
    let Some(form) = request.form else {
        return Ok(());
    };
    if !FORMS.iter().any(|(name, _)| *name == form) {
        let known: Vec<_> = FORMS.iter().map(|(name, _)| *name).collect();
        return Err(Error::Request(format!(
            "unknown form '{form}'; this version has {}",
            known.join(", ")
        )));
    }
    match (OF_TWO.contains(&form), request.device.conditions.len()) {
        (true, 1) => Err(Error::Request(format!(
            "form '{form}' is of temperature and humidity, and the device measures no humidity: give its codes, or another form"
        ))),
        (false, 2) if request.device.varied() == 2 => Err(Error::Request(format!(
            "form '{form}' is of the temperature alone, and the device measures humidity too: 'additive' joins such forms"
        ))),
        _ => Ok(()),
    }
}
