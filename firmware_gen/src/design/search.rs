//! Candidates: every form in every format, refined, screened and proven.

use super::bend::Bend;
use super::candidate::Candidate;
use super::frame::{Frame, rows};
use super::request::{Listen, Progress, Request};
use crate::device::Device;
use crate::error::Error;
use crate::form::{
    BENT_FORMS, Fit, Form, Propose, TEMPERATURE_FORMS, TWO_CONDITION_FORMS, Tail, reads_two,
};
use crate::ir::{Builder, Program};
use crate::prove::{Claim, Proof, Straight, prove};
use crate::reference::{Line, check_bounded, check_type};
use crate::target::Cost;
use std::rc::Rc;

pub(super) struct Search<'a> {
    pub(super) request: Request<'a>,
    frames: &'a [Frame],
    /// Rows that stand for all until the proof.
    picked: Vec<usize>,
    lines: Vec<Line>,
    /// How the distances bend, where they do.
    pub(super) bend: Option<Bend>,
    /// The farthest that a sample of the truth lies from a whole unit \[unit\].
    farthest: f64,
}

/// Rows from which the cost of a candidate is estimated. Set by hand; the types follow from all rows before the proof.
const ENOUGH: usize = 400;
/// If there are many rows, every fifth is screened. No divisor of the columns, so that all columns are seen.
const STRIDE: usize = 5;
/// Error that rounding down adds \[unit\]. It approaches 1; some margin is left, so that no candidate is dropped too early.
const CUT_OFF: f64 = 0.9;
/// Share of the largest rounding error that coincides with the largest error of a form. Below 1 for a margin. Set by hand.
const TOGETHER: f64 = 0.98;
/// A refined candidate is screened if its error is at most this share of the bound. Set by hand.
const SLACK: f64 = 1.02;
/// Least share of the room that a form has beside a delay. Set by hand: it only keeps the room positive.
const LEAST_ROOM: f64 = 0.05;

impl<'a> Search<'a> {
    /// Sample the model. `make` gives what forms can follow, which outlives the search.
    pub(super) fn new(
        request: Request<'a>,
        make: impl FnOnce(&[usize], &[Line]) -> Result<&'a [Frame], Error>,
    ) -> Result<Self, Error> {
        let Request {
            reference,
            device,
            maximum_distance,
            ..
        } = request;
        let (picked, lines) = rows(&request)?;
        check_bounded(reference, device, &lines, maximum_distance)?;
        check_type(reference, device, &picked)?;
        let frames = make(&picked, &lines)?;
        let truths = lines.iter().flat_map(Line::samples);
        let farthest = truths.fold(0.0_f64, |most, (_, truth)| {
            most.max((truth - truth.round()).abs())
        });
        let bend = Bend::of(&request, &picked, &lines);
        Ok(Self {
            bend,
            request,
            frames,
            picked,
            lines,
            farthest,
        })
    }

    pub(super) fn candidates(&self) -> Vec<Candidate<'a>> {
        let framed = self.frames.iter().flat_map(|frame| self.framed(frame));
        framed.chain(self.bent()).collect()
    }

    /// The candidates of forms that follow a frame.
    fn framed(&self, frame: &'a Frame) -> Vec<Candidate<'a>> {
        let of_tail = |tail: &Tail| {
            let fit = Rc::new(self.fit(tail, frame, &frame.lines));
            let rest = tail.rest(&frame.lines);
            // A second condition of one code is checked, and adds nothing.
            let two = frame.device.varied() == 2 || self.request.form.is_some_and(reads_two);
            let forms = if two {
                TWO_CONDITION_FORMS
            } else {
                TEMPERATURE_FORMS
            };
            self.proposed(forms, (*tail, rest, frame), &fit)
        };
        let mut tails = self.tails(&frame.lines, &frame.device);
        // A factor without its first bit cannot be multiplied.
        tails.retain(|tail| !(tail.leading && frame.gain.is_some()));
        tails.iter().flat_map(of_tail).collect()
    }

    /// The candidates of forms that bend, where the distances do.
    fn bent(&self) -> Vec<Candidate<'a>> {
        let frame = self.frames.iter().find(|frame| frame.shift.is_none());
        let (Some(bend), Some(frame)) = (&self.bend, frame) else {
            return Vec::new();
        };
        let of_tail = |tail: &Tail| {
            let fit = Fit {
                samples: bend.samples(tail),
                ..self.fit(tail, frame, &bend.lines)
            };
            // The factor makes up for what delay and offset leave: nothing is known of the least.
            self.proposed(BENT_FORMS, (*tail, 0.0, frame), &Rc::new(fit))
        };
        let tails = self.tails(&bend.lines, &frame.device);
        tails.iter().flat_map(of_tail).collect()
    }

    /// The candidates of some forms in one format.
    fn proposed(
        &self,
        forms: &[(&str, Propose)],
        (tail, rest, frame): (Tail, f64, &'a Frame),
        fit: &Rc<Fit<'a>>,
    ) -> Vec<Candidate<'a>> {
        let cost = self.cost_of(&tail, frame);
        let wanted = |name: &str| self.request.form.is_none_or(|form| form == name);
        let proposals = forms.iter().filter(|(name, _)| wanted(name));
        let forms: Vec<_> = proposals.flat_map(|(_, propose)| propose(fit)).collect();
        let candidates = forms.into_iter();
        candidates
            .filter_map(|form| self.candidate(form, (tail, cost, rest), frame, fit))
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
    fn tails(&self, lines: &[Line], device: &Device) -> Vec<Tail> {
        let all = Tail::propose(lines, device, self.request.target);
        let able = |tail: &&Tail| self.rounding(tail) < self.bound();
        let kept: Vec<Tail> = all.iter().filter(able).copied().collect();
        if kept.is_empty() { all } else { kept }
    }

    fn fit(&self, tail: &Tail, frame: &'a Frame, lines: &[Line]) -> Fit<'a> {
        let unit = f64::from(tail.scale_bits).exp2();
        let room = self.room(tail);
        Fit {
            device: &frame.device,
            picked: frame.picked.clone(),
            bound: (room - frame.rest()).max(LEAST_ROOM * room),
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
        frame: &'a Frame,
        fit: &Rc<Fit<'a>>,
    ) -> Option<Candidate<'a>> {
        if let Some(cost) = form.estimate() {
            return Some(Candidate {
                cost: cost + cost_of_tail,
                fit: Rc::clone(fit),
                form,
                tail,
                frame,
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
        let program = self.program((form.as_ref(), &tail, frame), rows)?;
        let allowed = program.table_bytes() <= self.request.maximum_table;
        let cost = self.request.target.cost(&program);
        allowed.then(|| Candidate {
            fit: Rc::clone(fit),
            form,
            tail,
            frame,
            rest,
            rounding: self.rounding(&tail),
            screened: f64::INFINITY,
            cost,
        })
    }

    /// What the steps from a speed factor to the distance cost.
    fn cost_of(&self, tail: &Tail, frame: &Frame) -> Cost {
        let rows = vec![self.picked[0]];
        let mut builder = Builder::over(self.request.device, self.request.target.least_bits, rows);
        if let Some(shift) = &frame.shift {
            shift.build(&mut builder);
        }
        let mut factor = builder.constant(tail.target(&frame.lines[0]).round() as i64);
        if let Some(gain) = &frame.gain {
            factor = gain.build(&mut builder, factor);
        }
        let distance = tail.build(&mut builder, factor);
        let program = builder.finish(distance);
        program.map_or_else(Cost::default, |program| self.request.target.cost(&program))
    }

    /// The function, its types following from `rows`.
    fn program(
        &self,
        (form, tail, frame): (&dyn Form, &Tail, &Frame),
        rows: Vec<usize>,
    ) -> Option<Program> {
        let mut builder = Builder::over(self.request.device, self.request.target.least_bits, rows);
        if let Some(shift) = &frame.shift {
            shift.build(&mut builder);
        }
        let mut factor = form.build(&mut builder);
        if let Some(gain) = &frame.gain {
            factor = gain.build(&mut builder, factor);
        }
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
        let Some(program) = self.program(candidate.parts(), rows) else {
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
            .program(candidate.parts(), all)
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
