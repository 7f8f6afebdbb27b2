//! The request of a search, and its result.

use crate::device::Device;
use crate::error::Error;
use crate::form::{Form, Gain, Shift, Tail};
use crate::ir::Program;
use crate::prove::Proof;
use crate::reference::Reference;
use crate::target::{Prefer, Target};
use std::fmt;

/// A request.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The model to follow.
    pub reference: &'a dyn Reference,
    /// The inputs.
    pub device: &'a Device,
    /// Largest error allowed \[m\].
    pub maximum_error: f64,
    /// Distances up to this are bounded \[m\].
    pub maximum_distance: f64,
    /// Largest tables allowed, together \[byte\].
    pub maximum_table: usize,
    /// Widest integer allowed on the way to the output \[bit\].
    pub widest: u32,
    /// The core that runs it.
    pub target: Target,
    /// The only form to try; `None`: all of them.
    pub form: Option<&'a str>,
    /// Whether to save bytes or cycles.
    pub prefer: Prefer,
    /// Threads for the proof.
    pub threads: usize,
}

impl Request<'_> {
    /// The error if there is no candidate at all.
    pub(super) fn no_candidate(&self) -> Error {
        let form = self
            .form
            .map_or("no form".into(), |form| format!("no form '{form}'"));
        Error::Request(format!(
            "{form} computes this model for {} in {}-bit integers and {} bytes of tables: allow larger tables, wider integers, a wider bound or every form",
            self.target.name, self.widest, self.maximum_table
        ))
    }
}

/// A function, with its proof.
#[derive(Debug)]
pub struct Design {
    /// How the speed factor is computed.
    pub form: Box<dyn Form>,
    /// What is taken off the echo code before, where one condition sets a delay.
    pub shift: Option<Shift>,
    /// What the speed factor is multiplied by after, where a further input beside the humidity sets it.
    pub gain: Option<Gain>,
    /// How the distance is computed from it.
    pub tail: Tail,
    /// The function.
    pub program: Program,
    /// What was proven on every input.
    pub proof: Proof,
}

impl Design {
    /// How the speed factor is computed, in words, and what sets a delay.
    #[must_use]
    pub fn describe(&self, device: &Device) -> String {
        let gain = self.gain.as_ref().map(|gain| gain.describe(device));
        let shift = self.shift.as_ref().map(|shift| shift.describe(device));
        let parts = [Some(self.form.describe()), gain, shift];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }

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
            .unwrap_or(device.output.out_of_range())
    }
}

/// The smallest error that is possible, if the bound cannot be met.
#[derive(Clone, Debug)]
pub struct Reachable {
    /// The requested bound \[m\].
    pub asked: f64,
    /// The error that the best candidate was proven to have \[m\].
    pub best: f64,
    /// Distances up to this are bounded \[m\].
    pub maximum_distance: f64,
    /// The best candidate, in words.
    pub form: String,
}

impl fmt::Display for Reachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let asked = (self.asked * 1e12).round() / 1e9;
        let best = self.best * 1e3;
        // Rounded up, so that the suggested bound can be met as it is printed.
        let enough = (best * 1e4).ceil() / 1e4;
        write!(
            f,
            "an error of {asked} mm up to {} m cannot be met: the best reachable is {best:.4} mm ({}); ask for {enough} mm or more",
            self.maximum_distance, self.form
        )
    }
}

/// Progress of a search.
pub enum Progress<'a> {
    /// The proof of a candidate begins.
    Candidate(&'a str),
    /// Number of its inputs checked so far.
    Checked(u64),
}

/// The reason why no design meets the request.
#[derive(Debug)]
pub struct Failure {
    /// The reason.
    pub error: Error,
    /// With [`Error::Bound`]: the design with the smallest error.
    pub best: Option<Box<Design>>,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self { error, best: None }
    }
}

/// Called with each progress; it returns `false` to stop the search.
pub type Listen<'a> = &'a mut dyn FnMut(Progress<'_>) -> bool;
