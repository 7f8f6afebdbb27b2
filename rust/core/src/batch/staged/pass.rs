//! A block of rows through the chain, with the effects of a model and one more.

use super::kernels::{Apply, Prepare, enter, speed};
use super::newton::{Newton, State};
use super::tracks::{AIR, Line, LineRef, Reading, SharedLine, TRACKS, Track, tracks_of};
use crate::air::Law;
use crate::chain::Stage;
use crate::effects::{self, ALL};
use crate::model::{ENOUGH, Model, Term};
use core::cell::Cell;

/// Memory for one block on its way.
pub(crate) struct Pass {
    memory: Box<Memory>,
}

struct Memory {
    tracks: [Track; TRACKS],
    recorded_speed: SharedLine,
    newton: State,
}

/// One term at work: the derivative to one of its parameters may be wanted.
type Applied<'a> = (usize, &'a [f64], Option<usize>);

impl Pass {
    pub(crate) fn new() -> Self {
        Self {
            memory: Box::new(Memory {
                tracks: [const { Track::new() }; TRACKS],
                recorded_speed: SharedLine::of(0.0),
                newton: State::new(),
            }),
        }
    }

    /// Takes a block through the chain up to and with a stage; the result reads from this memory.
    pub(crate) fn run<'a>(
        &'a mut self,
        model: &Model,
        reading: Reading<'a>,
        last: Stage,
    ) -> Reading<'a> {
        self.seeded(model, reading, last, None)
    }

    /// The same with the derivative to one parameter of one term, by position.
    pub(crate) fn seeded<'a>(
        &'a mut self,
        model: &Model,
        reading: Reading<'a>,
        last: Stage,
        seed: Option<(usize, usize)>,
    ) -> Reading<'a> {
        Steps(&self.memory).through(model, reading, |stage| stage <= last, seed)
    }

    /// The distances at which a block's values are reached in a stage, by Newton's method as in
    /// [`Model::invert`]; NaN where there is none. `times`: the values are times.
    pub(crate) fn invert<'a>(
        &'a mut self,
        model: &Model,
        mut block: Reading<'a>,
        last: Stage,
        times: bool,
    ) -> &'a [f64] {
        let steps = Steps(&self.memory);
        let newton = Newton::new(&block, &self.memory.newton);
        if times {
            let near = !model.is_straight();
            let speed = near.then(|| steps.recorded_speed(model.law(), &mut block));
            block = block.at_line(newton.guess(speed));
        }
        let mut here = steps.through(model, block.to_distance(true), |stage| stage <= last, None);
        if model.is_straight() {
            return newton.arrive(&here, last);
        }
        here = newton.approach(here, last, true);
        let again = |stage| stage <= last && !is_of_air(model, stage);
        for _ in 1..ENOUGH {
            if !newton.goes_on() {
                break;
            }
            here = steps.through(model, here.to_distance(true), again, None);
            here = newton.approach(here, last, false);
        }
        newton.found(&here)
    }

    /// Takes a block that a model brought to the end through what one more effect changes.
    ///
    /// `base` is what [`Pass::run`] made, to the last stage, in a memory of its own; with `seed` the
    /// derivative to that parameter of the effect comes along.
    pub(crate) fn beside<'a>(
        &'a mut self,
        model: &Model,
        base: &Reading<'a>,
        term: &Term,
        seed: Option<usize>,
    ) -> Reading<'a> {
        let (steps, mut reading) = (Steps(&self.memory), base.to_distance(false));
        let own = ALL[term.index].stage;
        for stage in Stage::ALL.into_iter().filter(|&stage| stage >= own) {
            let extra: Applied<'_> = (term.index, &term.parameters, seed);
            if stage == own && is_alone(model, stage) {
                steps.apply(extra, None, false, &mut reading); // the variable is what the stage's entry made it
            } else if stage == own {
                steps.stage(model, stage, Some(extra), &mut reading);
            } else {
                steps.after(model, stage, &mut reading);
            }
        }
        reading
    }

    /// What one effect does to the variables of its stage, of which it is the only one, after a block
    /// that a model brought to the end; with the derivative to a parameter.
    pub(crate) fn alone<'a>(
        &'a mut self,
        base: &Reading<'a>,
        term: &Term,
        seed: usize,
        prepared: Option<&Line>,
    ) -> Reading<'a> {
        let mut reading = base.to_distance(false);
        let term: Applied<'_> = (term.index, &term.parameters, Some(seed));
        Steps(&self.memory).apply(term, prepared, false, &mut reading);
        reading
    }

    /// How the end of a chain follows one variable of a stage, at a block that a model brought there:
    /// the derivative of the last stage.
    pub(crate) fn following<'a>(
        &'a mut self,
        model: &Model,
        base: &Reading<'a>,
        own: Stage,
        track: usize,
    ) -> Reading<'a> {
        let mut reading = base.to_distance(false).seeded(track);
        for stage in Stage::ALL.into_iter().filter(|&stage| stage > own) {
            Steps(&self.memory).after(model, stage, &mut reading);
        }
        reading
    }

    /// Takes a block through the whole chain with one more effect.
    pub(crate) fn with<'a>(
        &'a mut self,
        model: &Model,
        mut reading: Reading<'a>,
        term: &Term,
    ) -> Reading<'a> {
        for stage in Stage::ALL {
            let own = (ALL[term.index].stage == stage).then_some((
                term.index,
                &term.parameters[..],
                None,
            ));
            Steps(&self.memory).stage(model, stage, own, &mut reading);
        }
        reading
    }
}

/// The memory of a pass while a block takes its way.
///
/// Every write goes through a cell: a stage may read a variable where it writes it.
#[derive(Clone, Copy)]
struct Steps<'a>(&'a Memory);

impl<'a> Steps<'a> {
    fn through(
        self,
        model: &Model,
        mut reading: Reading<'a>,
        wanted: impl Fn(Stage) -> bool,
        seed: Option<(usize, usize)>,
    ) -> Reading<'a> {
        let mut terms = model.terms().iter().enumerate().peekable();
        for stage in Stage::ALL {
            let wanted = wanted(stage);
            let still = seed.is_none() && (!reading.varies() || is_of_air(model, stage));
            if wanted {
                self.enter(model, stage, still, &mut reading);
            }
            while let Some((position, term)) = terms.next_if(|(_, t)| t.facts().stage == stage) {
                let own = seed.filter(|&(of, _)| of == position);
                let seed = own.map(|(_, parameter)| parameter);
                if wanted {
                    let term = (term.index, &term.parameters[..], seed);
                    self.apply(term, None, still, &mut reading);
                }
            }
        }
        reading
    }

    /// Takes a block through a stage after one that an effect changed.
    fn after(self, model: &Model, stage: Stage, reading: &mut Reading<'a>) {
        // without an effect these two read nothing that an effect changes
        if !matches!(stage, Stage::Path | Stage::Firmware) || !is_alone(model, stage) {
            self.stage(model, stage, None, reading);
        }
    }

    fn stage(
        self,
        model: &Model,
        stage: Stage,
        extra: Option<Applied<'_>>,
        reading: &mut Reading<'a>,
    ) {
        self.enter(model, stage, false, reading);
        let own = model.terms().iter().filter(|t| t.facts().stage == stage);
        let mut terms: Vec<Applied<'_>> = own.map(|t| (t.index, &t.parameters[..], None)).collect();
        terms.extend(extra);
        terms.sort_by_key(|&(index, ..)| index);
        for term in terms {
            self.apply(term, None, false, reading);
        }
    }

    /// The speed of sound in the recorded air, which both the speed and the firmware begin with.
    fn recorded_speed(self, law: Law, reading: &mut Reading<'a>) -> LineRef<'a> {
        if let Some(known) = reading.recorded_speed {
            return known;
        }
        let memory = &self.0.recorded_speed;
        speed(law, reading.recorded_air(), reading, memory.cell());
        *reading.recorded_speed.insert(LineRef::shared(memory))
    }

    /// `still`: no derivative is wanted.
    fn enter(self, model: &Model, stage: Stage, still: bool, reading: &mut Reading<'a>) {
        let (law, first) = (model.law(), tracks_of(stage).start);
        match stage {
            Stage::Air => {
                for (track, quantity) in tracks_of(stage).zip(AIR) {
                    reading.copy(track, reading.constant(quantity));
                }
            }
            Stage::Path => {
                let [value, slope] = reading.distance;
                reading.copy(first, (value, slope));
            }
            Stage::Transducer => reading.copy(first, reading.of(Stage::Flight)),
            Stage::Timer => reading.copy(first, reading.of(Stage::Transducer)),
            Stage::Speed if still && is_alone(model, Stage::Air) => {
                let speed = self.recorded_speed(law, reading);
                reading.place_still(first, speed);
            }
            Stage::Firmware => {
                let speed = self.recorded_speed(law, reading);
                reading.place_still(first, speed);
            }
            Stage::Speed | Stage::Flight | Stage::Indication => {
                let target = &self.0.tracks[first];
                enter(law, stage, reading, target, still);
                reading.place(first, target, still);
            }
        }
    }

    fn apply(
        self,
        (index, parameters, seed): Applied<'_>,
        prepared: Option<&Line>,
        still: bool,
        reading: &mut Reading<'a>,
    ) {
        let tracks = tracks_of(ALL[index].stage);
        let work = Apply {
            reading,
            parameters,
            seed,
            still,
            target: &self.0.tracks[tracks.clone()],
            prepared,
        };
        let changed = effects::visit(index, work);
        for (track, _) in tracks.zip(changed).filter(|&(_, changed)| changed) {
            reading.place(track, &self.0.tracks[track], still);
        }
    }
}

/// Whether what a stage leaves is the same at every distance.
fn is_of_air(model: &Model, stage: Stage) -> bool {
    let moved = || model.terms().iter().any(|term| term.facts().of_distance);
    matches!(stage, Stage::Air | Stage::Speed | Stage::Firmware) && !moved()
}

/// Whether one more effect of a stage would be the only one.
pub(crate) fn is_alone(model: &Model, stage: Stage) -> bool {
    !model.terms().iter().any(|term| term.facts().stage == stage)
}

/// Finds what an effect can prepare for a block; whether that is anything.
pub(crate) fn prepare(base: &Reading<'_>, term: &Term, into: &mut Line) -> bool {
    let reading = &base.to_distance(false);
    let target = Cell::from_mut(&mut into.0);
    effects::visit(term.index, Prepare { reading, target })
}
