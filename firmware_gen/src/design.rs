//! The search: which form, which format, at least cost within the error bound.

use crate::device::Device;
use crate::error::Error;
use crate::form::{FORMS, Fit, Form, Tail};
use crate::ir::{Builder, Program};
use crate::prove::{Claim, Proof, prove};
use crate::reference::{Line, Reference, sample};
use crate::target::{Cost, Prefer, Target};
use std::fmt;

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
#[derive(Clone, Debug, PartialEq)]
pub struct Reachable {
    /// The bound that was asked for \[m\].
    pub asked: f64,
    /// The error that the best candidate was proven to have \[m\].
    pub best: f64,
    /// Where distances are bounded \[m\].
    pub maximum_distance: f64,
    /// The best candidate, in words.
    pub form: String,
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
            self.maximum_distance, self.form
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

/// Find the cheapest program that meets the bound on every input.
///
/// # Errors
/// [`Error::Bound`] with the best reachable if none does; [`Error::Model`] if the model itself fails somewhere.
pub fn design(request: Request<'_>, listen: Listen<'_>) -> Result<Design, Error> {
    check(&request)?;
    let search = Search::new(request)?;
    let mut candidates = search.candidates();
    candidates.sort_by_key(|candidate| request.prefer.key(candidate.cost));
    let bound = request.maximum_error * 1e6;
    let mut failed = Vec::new();
    for mut candidate in candidates {
        if candidate.floor() <= bound
            && search.refine(&mut candidate)
            && candidate.screened <= bound
        {
            match search.prove(&candidate, listen) {
                Ok(proof) if proof.bounded.error <= bound => return Ok(candidate.proven(proof)),
                Ok(_) | Err(Error::Proof(_)) => {}
                Err(error) => return Err(error),
            }
        }
        failed.push(candidate);
    }
    search.unreachable(failed, listen)
}

fn check(request: &Request<'_>) -> Result<(), Error> {
    for (what, value, unit) in [
        ("error bound", request.maximum_error, "mm"),
        ("largest bounded distance", request.maximum_distance, "m"),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::Request(format!(
                "the {what} is {value} m: give a positive number [{unit}]"
            )));
        }
    }
    if let Some(form) = request.form
        && !FORMS.iter().any(|(name, _)| *name == form)
    {
        let known: Vec<_> = FORMS.iter().map(|(name, _)| *name).collect();
        return Err(Error::Request(format!(
            "unknown form '{form}'; this version has {}",
            known.join(", ")
        )));
    }
    if request.device.conditions.len() != 1 {
        let given = request.device.conditions.len();
        return Err(Error::Request(format!(
            "the device has {given} condition inputs; this version designs for one"
        )));
    }
    Ok(())
}

struct Candidate {
    form: Box<dyn Form>,
    tail: Tail,
    /// Error that the tail leaves whatever the form does \[um\].
    rest: f64,
    /// Error found at a few echo times of every row \[um\]; infinite until refined.
    screened: f64,
    program: Program,
    cost: Cost,
}

impl Candidate {
    /// The error that it cannot undercut \[um\].
    fn floor(&self) -> f64 {
        self.form.floor().max(self.rest)
    }

    fn proven(self, proof: Proof) -> Design {
        Design {
            form: self.form,
            tail: self.tail,
            program: self.program,
            proof,
        }
    }
}

struct Search<'a> {
    request: Request<'a>,
    lines: Vec<Line>,
}

impl<'a> Search<'a> {
    fn new(request: Request<'a>) -> Result<Self, Error> {
        let lines = sample(request.reference, request.device, request.maximum_distance)?;
        Ok(Self { request, lines })
    }

    fn candidates(&self) -> Vec<Candidate> {
        let tails = Tail::propose(&self.lines, self.request.device);
        let of_tail = |tail: &Tail| {
            let fit = self.fit(tail);
            let wanted = |name: &str| self.request.form.is_none_or(|form| form == name);
            let proposals = FORMS.iter().filter(|(name, _)| wanted(name));
            let forms: Vec<_> = proposals.flat_map(|(_, propose)| propose(&fit)).collect();
            forms
                .into_iter()
                .filter_map(|form| self.candidate(form, *tail))
                .collect::<Vec<_>>()
        };
        tails.iter().flat_map(of_tail).collect()
    }

    fn fit(&self, tail: &Tail) -> Fit<'a> {
        let unit = f64::from(tail.scale_bits).exp2();
        Fit {
            device: self.request.device,
            target: self
                .lines
                .iter()
                .map(|line| tail.factor(line) * unit)
                .collect(),
            weight: self
                .lines
                .iter()
                .map(|line| tail.lever(line) / unit)
                .collect(),
            least_bits: self.request.target.least_bits,
        }
    }

    /// `None` where some value fits no type, or the tables are larger than allowed.
    fn candidate(&self, form: Box<dyn Form>, tail: Tail) -> Option<Candidate> {
        let program = self.program(form.as_ref(), &tail)?;
        let allowed = program.table_bytes() <= self.request.maximum_table;
        let cost = self.request.target.cost(&program);
        let rest = tail.rest(&self.lines);
        allowed.then_some(Candidate {
            form,
            tail,
            rest,
            screened: f64::INFINITY,
            program,
            cost,
        })
    }

    fn program(&self, form: &dyn Form, tail: &Tail) -> Option<Program> {
        let mut builder = Builder::new(self.request.device, self.request.target.least_bits);
        let factor = form.build(&mut builder);
        let distance = tail.build(&mut builder, factor);
        builder.finish(distance)
    }

    /// Round jointly and look at a few echo times of every row; `false` if the program is no longer possible.
    fn refine(&self, candidate: &mut Candidate) -> bool {
        candidate.form.refine(&self.fit(&candidate.tail));
        let Some(program) = self.program(candidate.form.as_ref(), &candidate.tail) else {
            return false;
        };
        candidate.program = program;
        candidate.screened = self.screen(&candidate.program);
        true
    }
    fn screen(&self, program: &Program) -> f64 {
        let errors = self.lines.iter().enumerate().flat_map(|(row, line)| {
            let codes = self.request.device.codes(row);
            line.samples().map(move |(echo, truth)| {
                let inputs: Vec<i64> = std::iter::once(echo).chain(codes.iter().copied()).collect();
                program
                    .evaluate(&inputs)
                    .map_or(f64::INFINITY, |output| (output as f64 - truth).abs())
            })
        });
        errors.fold(0.0, f64::max)
    }

    fn prove(&self, candidate: &Candidate, listen: Listen<'_>) -> Result<Proof, Error> {
        if !listen(Progress::Candidate(&candidate.form.describe())) {
            return Err(Error::Stopped);
        }
        let Request {
            device,
            reference,
            maximum_distance,
            threads,
            ..
        } = self.request;
        let claim = Claim {
            device,
            reference,
            maximum_distance,
            threads,
        };
        prove(&candidate.program, claim, &mut |inputs| {
            listen(Progress::Checked(inputs))
        })
    }

    /// Prove the best of what failed, and say what it reaches.
    fn unreachable(&self, mut failed: Vec<Candidate>, listen: Listen<'_>) -> Result<Design, Error> {
        failed.sort_by(|a, b| a.floor().total_cmp(&b.floor()));
        let mut best = f64::INFINITY;
        for candidate in failed
            .iter_mut()
            .filter(|candidate| candidate.screened == f64::INFINITY)
        {
            if candidate.floor() < best && self.refine(candidate) {
                best = best.min(candidate.screened);
            }
        }
        failed.sort_by(|a, b| a.screened.total_cmp(&b.screened));
        let proven = failed
            .iter()
            .find_map(|candidate| match self.prove(candidate, listen) {
                Ok(proof) => Some(Ok((proof.bounded.error, candidate.form.describe()))),
                Err(Error::Proof(_)) => None,
                Err(error) => Some(Err(error)),
            });
        let Some((best, form)) = proven.transpose()? else {
            return Err(Error::Request(
                "no form computes this model within 64-bit integers".into(),
            ));
        };
        let Request {
            maximum_error: asked,
            maximum_distance,
            ..
        } = self.request;
        Err(Error::Bound(Box::new(Reachable {
            asked,
            best: best * 1e-6,
            maximum_distance,
            form,
        })))
    }
}
