//! Candidates: every form in every format, refined, screened and proven.

use super::bend::Bend;
use super::request::{Design, Listen, Progress, Request};
use crate::error::Error;
use crate::form::{
    BENT_FORMS, Fit, Form, Propose, TEMPERATURE_FORMS, TWO_CONDITION_FORMS, Tail, reads_two,
};
use crate::ir::{Builder, Program};
use crate::prove::{Claim, Proof, Straight, prove};
use crate::reference::{Line, check_bounded, check_type, sample};
use crate::target::Cost;
use std::rc::Rc;

/// One form in one format.
pub(super) struct Candidate<'a> {
    /// What the form must follow.
    fit: Rc<Fit<'a>>,
    pub(super) form: Box<dyn Form>,
    tail: Tail,
    /// Error that the tail leaves whatever the form does \[unit\].
    rest: f64,
    /// Error that rounding to a whole unit adds in any case \[unit\].
    rounding: f64,
    /// Error found at a few echo times of every row \[unit\]; infinite until refined.
    pub(super) screened: f64,
    pub(super) cost: Cost,
}

impl Candidate<'_> {
    /// The error that it cannot undercut \[unit\].
    pub(super) fn floor(&self) -> f64 {
        self.form.floor().max(self.rest) + self.rounding
    }

    /// The error that it can hardly undercut, from what its parts reach as they are rounded \[unit\].
    pub(super) fn least(&self) -> f64 {
        SURE.mul_add(self.form.least(&self.fit).max(self.rest), self.rounding)
    }

    /// The error that it probably has \[unit\].
    pub(super) fn likely(&self) -> f64 {
        self.form.likely(&self.fit).max(self.rest) + self.rounding
    }

    pub(super) fn proven(self, program: Program, proof: Proof) -> Design {
        Design {
            form: self.form,
            tail: self.tail,
            program,
            proof,
        }
    }
}

pub(super) struct Search<'a> {
    pub(super) request: Request<'a>,
    /// Rows that stand for all until the proof.
    picked: Vec<usize>,
    lines: Vec<Line>,
    /// How the distances bend, where they do.
    pub(super) bend: Option<Bend>,
    /// The farthest that a sample of the truth lies from a whole unit \[unit\].
    farthest: f64,
}

/// Columns of the second condition that the search samples. Set by hand; the proof checks all.
const COLUMNS: usize = 17;
/// Rows from which the cost of a candidate is estimated. Set by hand; the types follow from all rows before the proof.
const ENOUGH: usize = 400;
/// If there are many rows, every fifth is screened. No divisor of [`COLUMNS`], so that all columns are seen.
const STRIDE: usize = 5;
/// Error that rounding down adds \[unit\]. It approaches 1; some margin is left, so that no candidate is dropped too early.
const CUT_OFF: f64 = 0.9;
/// Share of the largest rounding error that coincides with the largest error of a form. Below 1 for a margin. Set by hand.
const TOGETHER: f64 = 0.98;
/// A refined candidate is screened if its error is at most this share of the bound. Set by hand.
const SLACK: f64 = 1.02;
/// Share of a part's own error that remains in the whole form; joint rounding may save the rest. Set by hand.
const SURE: f64 = 0.9;

impl<'a> Search<'a> {
    pub(super) fn new(request: Request<'a>) -> Result<Self, Error> {
        let Request {
            reference,
            device,
            maximum_distance,
            ..
        } = request;
        let picked = device.thinned(COLUMNS);
        let lines = sample(reference, device, &picked, maximum_distance)?;
        check_bounded(reference, device, &lines, maximum_distance)?;
        check_type(reference, device, &picked)?;
        let truths = lines.iter().flat_map(Line::samples);
        let farthest = truths.fold(0.0_f64, |most, (_, truth)| {
            most.max((truth - truth.round()).abs())
        });
        let bend = Bend::of(&request, &picked, &lines);
        Ok(Self {
            bend,
            request,
            picked,
            lines,
            farthest,
        })
    }

    pub(super) fn candidates(&self) -> Vec<Candidate<'a>> {
        let of_tail = |tail: &Tail| {
            let fit = Rc::new(self.fit(tail, &self.lines));
            let rest = tail.rest(&self.lines);
            // A second condition of one code is checked, and adds nothing.
            let two = self.request.device.varied() == 2 || self.request.form.is_some_and(reads_two);
            let forms = if two {
                TWO_CONDITION_FORMS
            } else {
                TEMPERATURE_FORMS
            };
            self.proposed(forms, (*tail, rest), &fit)
        };
        let tails = self.tails(&self.lines);
        tails.iter().flat_map(of_tail).chain(self.bent()).collect()
    }

    /// The candidates of forms that bend, where the distances do.
    fn bent(&self) -> Vec<Candidate<'a>> {
        let Some(bend) = &self.bend else {
            return Vec::new();
        };
        let of_tail = |tail: &Tail| {
            let fit = Fit {
                samples: bend.samples(tail),
                ..self.fit(tail, &bend.lines)
            };
            // The factor makes up for what delay and offset leave: nothing is known of the least.
            self.proposed(BENT_FORMS, (*tail, 0.0), &Rc::new(fit))
        };
        self.tails(&bend.lines).iter().flat_map(of_tail).collect()
    }

    /// The candidates of some forms in one format.
    fn proposed(
        &self,
        forms: &[(&str, Propose)],
        (tail, rest): (Tail, f64),
        fit: &Rc<Fit<'a>>,
    ) -> Vec<Candidate<'a>> {
        let cost = self.cost_of(&tail);
        let wanted = |name: &str| self.request.form.is_none_or(|form| form == name);
        let proposals = forms.iter().filter(|(name, _)| wanted(name));
        let forms: Vec<_> = proposals.flat_map(|(_, propose)| propose(fit)).collect();
        let candidates = forms.into_iter();
        candidates
            .filter_map(|form| self.candidate(form, (tail, cost, rest), fit))
            .collect()
    }

    /// What rounding leaves of the bound \[unit\].
    fn room(&self, tail: &Tail) -> f64 {
        let rounding = self.rounding(tail);
        (self.bound() - rounding).max(rounding / 50.0)
    }

    /// What the way in which a tail rounds adds in any case \[unit\].
    fn rounding(&self, tail: &Tail) -> f64 {
        let output = &self.request.device.output;
        match (output.is_coarse(), tail.rounded) {
            (false, _) => 0.0,
            (true, true) => TOGETHER * self.farthest,
            (true, false) => CUT_OFF,
        }
    }

    /// The bound \[unit\].
    pub(super) fn bound(&self) -> f64 {
        self.request.maximum_error * self.request.device.output.per_meter
    }

    /// The formats that could meet the bound; if none can, all of them, so that the best can be reported.
    fn tails(&self, lines: &[Line]) -> Vec<Tail> {
        let all = Tail::propose(lines, self.request.device, self.request.target);
        let able = |tail: &&Tail| self.rounding(tail) < self.bound();
        let kept: Vec<Tail> = all.iter().filter(able).copied().collect();
        if kept.is_empty() { all } else { kept }
    }

    fn fit(&self, tail: &Tail, lines: &[Line]) -> Fit<'a> {
        let unit = f64::from(tail.scale_bits).exp2();
        Fit {
            device: self.request.device,
            picked: self.picked.clone(),
            bound: self.room(tail),
            maximum_table: self.request.maximum_table,
            samples: Vec::new(),
            target: lines.iter().map(|line| tail.target(line)).collect(),
            weight: lines.iter().map(|line| tail.lever(line) / unit).collect(),
            core: self.request.target,
            lines: Default::default(),
        }
    }

    /// `None` where some value fits no type, or the tables are larger than allowed.
    fn candidate(
        &self,
        form: Box<dyn Form>,
        (tail, cost_of_tail, rest): (Tail, Cost, f64),
        fit: &Rc<Fit<'a>>,
    ) -> Option<Candidate<'a>> {
        if let Some(cost) = form.estimate() {
            return Some(Candidate {
                cost: cost + cost_of_tail,
                fit: Rc::clone(fit),
                form,
                tail,
                rest,
                rounding: self.rounding(&tail),
                screened: f64::INFINITY,
            });
        }
        let step = (self.picked.len() / ENOUGH).max(1);
        let few = self.picked.iter().copied().step_by(step);
        let few = few.chain(self.picked.last().copied());
        let rows = if self.picked.len() < 10 * ENOUGH {
            self.picked.clone()
        } else {
            few.collect()
        };
        let program = self.program(form.as_ref(), &tail, rows)?;
        let allowed = program.table_bytes() <= self.request.maximum_table;
        let cost = self.request.target.cost(&program);
        allowed.then(|| Candidate {
            fit: Rc::clone(fit),
            form,
            tail,
            rest,
            rounding: self.rounding(&tail),
            screened: f64::INFINITY,
            cost,
        })
    }

    /// What the steps from a speed factor to the distance cost.
    fn cost_of(&self, tail: &Tail) -> Cost {
        let rows = vec![self.picked[0]];
        let mut builder = Builder::over(self.request.device, self.request.target.least_bits, rows);
        let factor = builder.constant(tail.target(&self.lines[0]).round() as i64);
        let distance = tail.build(&mut builder, factor);
        let program = builder.finish(distance);
        program.map_or_else(Cost::default, |program| self.request.target.cost(&program))
    }

    /// The function, its types following from `rows`.
    fn program(&self, form: &dyn Form, tail: &Tail, rows: Vec<usize>) -> Option<Program> {
        let mut builder = Builder::over(self.request.device, self.request.target.least_bits, rows);
        let factor = form.build(&mut builder);
        let distance = tail.build(&mut builder, factor);
        let mut program = builder.finish(distance)?;
        if program.widest() > self.request.widest {
            return None;
        }
        program.middle_bytes = self.request.target.byte_shifts;
        for table in &mut program.tables {
            table.program_memory = self.request.target.program_memory;
        }
        Some(program)
    }

    /// Round jointly and look at a few echo times of every row; `false` if the program is no longer possible.
    pub(super) fn refine(&self, candidate: &mut Candidate<'_>) -> bool {
        candidate.form.refine(&candidate.fit);
        if let Some(reached) = candidate.form.reached() {
            let likely = reached + candidate.rounding;
            if likely > SLACK * self.bound() {
                candidate.screened = likely;
                return true;
            }
        }
        self.look_at(candidate)
    }

    /// Build the program and look at a few echo times of every row; `false` if there is no program.
    pub(super) fn look_at(&self, candidate: &mut Candidate<'_>) -> bool {
        let rows = self.picked.clone();
        let Some(program) = self.program(candidate.form.as_ref(), &candidate.tail, rows) else {
            return false;
        };
        if program.table_bytes() > self.request.maximum_table {
            return false;
        }
        candidate.cost = self.request.target.cost(&program);
        candidate.screened = self.screen(&program);
        true
    }
    fn screen(&self, program: &Program) -> f64 {
        let stride = if self.lines.len() < 10 * ENOUGH {
            1
        } else {
            STRIDE
        };
        let rows = self
            .picked
            .iter()
            .zip(&self.lines)
            .enumerate()
            .step_by(stride);
        let ends = self.request.device.echo.codes;
        let errors = rows.map(|(index, (row, line))| {
            let codes = self.request.device.codes(*row);
            let straight = match Straight::of(program, &codes, (ends.minimum, ends.maximum)) {
                Err(_) => return f64::INFINITY,
                Ok(straight) => straight,
            };
            let output = |echo: i64| match straight {
                Some(straight) => Some(i64::from(straight.output(echo))),
                None => program.evaluate(&[&[echo], &codes[..]].concat()).ok(),
            };
            let bent = self.bend.iter().flat_map(|bend| bend.row(index));
            let errors = line.samples().chain(bent).map(|(echo, truth)| {
                output(echo).map_or(f64::INFINITY, |output| (output as f64 - truth).abs())
            });
            errors.fold(0.0, f64::max)
        });
        errors.fold(0.0, f64::max)
    }

    /// Check the candidate, its types now following from every row, on every input.
    pub(super) fn prove(
        &self,
        candidate: &Candidate<'_>,
        most: f64,
        listen: Listen<'_>,
    ) -> Result<(Program, Proof), Error> {
        let all = (0..self.request.device.rows()).collect();
        let program = self
            .program(candidate.form.as_ref(), &candidate.tail, all)
            .ok_or_else(|| Error::Proof("a value fits no type".into()))?;
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
            most,
            threads,
        };
        let proof = prove(&program, claim, &mut |inputs| {
            listen(Progress::Checked(inputs))
        })?;
        Ok((program, proof))
    }
}
