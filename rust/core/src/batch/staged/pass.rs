//! A block of rows through the chain, with the effects of a model and one more.

use super::kernels::{Apply, Prepare, enter};
use super::tracks::{Line, Reading, TRACKS, Track, tracks_of};
use crate::air::Law;
use crate::chain::Stage;
use crate::conditions::Quantity;
use crate::effects::{self, ALL};
use crate::model::{Model, Term};

/// Memory for one block on its way.
pub(crate) struct Pass {
    tracks: Box<[Track; TRACKS]>,
}

/// One term at work: the derivative to one of its parameters may be wanted.
type Applied<'a> = (usize, &'a [f64], Option<usize>);

impl Pass {
    pub(crate) fn new() -> Self {
        Self {
            tracks: Box::new([Track::NEW; TRACKS]),
        }
    }

    /// Takes a block through the chain up to and with a stage; the result reads from this memory.
    pub(crate) fn run(&mut self, model: &Model, reading: Reading, last: Stage) -> Reading {
        self.seeded(model, reading, last, None)
    }

    /// The same with the derivative to one parameter of one term, by position.
    pub(crate) fn seeded(
        &mut self,
        model: &Model,
        reading: Reading,
        last: Stage,
        seed: Option<(usize, usize)>,
    ) -> Reading {
        self.through(model, reading, |stage| stage <= last, seed)
    }

    /// The same once more, with the derivative to the distance, after the distances changed.
    pub(crate) fn again(&mut self, model: &Model, reading: Reading, last: Stage) -> Reading {
        let moved = model.terms().iter().any(|term| term.facts().of_distance);
        let stays = |stage| !moved && matches!(stage, Stage::Air | Stage::Speed | Stage::Firmware);
        let wanted = |stage| stage <= last && !stays(stage);
        self.through(model, reading.to_distance(true), wanted, None)
    }

    fn through(
        &mut self,
        model: &Model,
        mut reading: Reading,
        wanted: impl Fn(Stage) -> bool,
        seed: Option<(usize, usize)>,
    ) -> Reading {
        for stage in Stage::ALL.into_iter().filter(|&stage| wanted(stage)) {
            self.enter(model.law(), stage, &mut reading);
            let terms = model.terms().iter().enumerate();
            for (position, term) in terms.filter(|(_, t)| t.facts().stage == stage) {
                let own = seed.filter(|&(of, _)| of == position);
                let seed = own.map(|(_, parameter)| parameter);
                self.apply((term.index, &term.parameters, seed), &mut reading);
            }
        }
        reading
    }

    /// Takes a block that a model brought to the end through what one more effect changes.
    ///
    /// `base` is what [`Pass::run`] made, to the last stage, in a memory of its own; with `seed` the
    /// derivative to that parameter of the effect comes along.
    pub(crate) fn beside(
        &mut self,
        model: &Model,
        base: &Reading,
        term: &Term,
        seed: Option<usize>,
    ) -> Reading {
        let mut reading = base.to_distance(false);
        let own = ALL[term.index].stage;
        for stage in Stage::ALL.into_iter().filter(|&stage| stage >= own) {
            let extra: Applied<'_> = (term.index, &term.parameters, seed);
            if stage == own && is_alone(model, stage) {
                self.apply(extra, &mut reading); // the variable is what the stage's entry made it
            } else if stage == own {
                self.stage(model, stage, Some(extra), &mut reading);
            } else {
                self.after(model, stage, &mut reading);
            }
        }
        reading
    }

    /// What one effect does to the variables of its stage, of which it is the only one, after a block
    /// that a model brought to the end; with the derivative to a parameter.
    pub(crate) fn alone(
        &mut self,
        base: &Reading,
        term: &Term,
        seed: usize,
        prepared: Option<&Line>,
    ) -> Reading {
        let mut reading = base.to_distance(false);
        let term: Applied<'_> = (term.index, &term.parameters, Some(seed));
        self.apply_with(term, prepared, &mut reading);
        reading
    }

    /// How the end of a chain follows one variable of a stage, at a block that a model brought there:
    /// the derivative of the last stage.
    pub(crate) fn following(
        &mut self,
        model: &Model,
        base: &Reading,
        own: Stage,
        track: usize,
    ) -> Reading {
        let mut reading = base.to_distance(false).seeded(track);
        for stage in Stage::ALL.into_iter().filter(|&stage| stage > own) {
            self.after(model, stage, &mut reading);
        }
        reading
    }

    /// Takes a block through a stage after one that an effect changed.
    fn after(&mut self, model: &Model, stage: Stage, reading: &mut Reading) {
        // without an effect these two read nothing that an effect changes
        if !matches!(stage, Stage::Path | Stage::Firmware) || !is_alone(model, stage) {
            self.stage(model, stage, None, reading);
        }
    }

    /// Takes a block through the whole chain with one more effect.
    pub(crate) fn with(&mut self, model: &Model, mut reading: Reading, term: &Term) -> Reading {
        for stage in Stage::ALL {
            let own = (ALL[term.index].stage == stage).then_some((
                term.index,
                &term.parameters[..],
                None,
            ));
            self.stage(model, stage, own, &mut reading);
        }
        reading
    }

    fn stage(
        &mut self,
        model: &Model,
        stage: Stage,
        extra: Option<Applied<'_>>,
        reading: &mut Reading,
    ) {
        self.enter(model.law(), stage, reading);
        let own = model.terms().iter().filter(|t| t.facts().stage == stage);
        let mut terms: Vec<Applied<'_>> = own.map(|t| (t.index, &t.parameters[..], None)).collect();
        terms.extend(extra);
        terms.sort_by_key(|&(index, ..)| index);
        for term in terms {
            self.apply(term, reading);
        }
    }

    fn enter(&mut self, law: Law, stage: Stage, reading: &mut Reading) {
        match stage {
            Stage::Air => {
                let air = [
                    Quantity::Temperature,
                    Quantity::RelativeHumidity,
                    Quantity::Pressure,
                    Quantity::Co2MoleFraction,
                ];
                for (track, quantity) in tracks_of(stage).zip(air) {
                    reading.copy(track, reading.constant(quantity));
                }
            }
            Stage::Path => {
                let [value, slope] = reading.distance;
                reading.copy(tracks_of(stage).start, (value, slope));
            }
            Stage::Transducer => {
                reading.copy(tracks_of(stage).start, reading.of(Stage::Flight));
            }
            Stage::Timer => {
                reading.copy(tracks_of(stage).start, reading.of(Stage::Transducer));
            }
            _ => {
                let target = &raw mut self.tracks[tracks_of(stage).start];
                enter(law, stage, reading, target);
            }
        }
    }

    fn apply(&mut self, term: Applied<'_>, reading: &mut Reading) {
        self.apply_with(term, None, reading);
    }

    fn apply_with(
        &mut self,
        (index, parameters, seed): Applied<'_>,
        prepared: Option<&Line>,
        reading: &mut Reading,
    ) {
        let tracks = tracks_of(ALL[index].stage);
        let target = self.tracks[tracks.clone()].as_mut_ptr();
        let work = Apply {
            reading,
            parameters,
            seed,
            target,
            prepared: prepared.map(|line| line.0.as_ptr()),
        };
        effects::visit(index, work);
        for track in tracks {
            reading.place(track, &raw const self.tracks[track]);
        }
    }
}

/// Whether one more effect of a stage would be the only one.
pub(crate) fn is_alone(model: &Model, stage: Stage) -> bool {
    !model.terms().iter().any(|term| term.facts().stage == stage)
}

/// Finds what an effect can prepare for a block; whether that is anything.
pub(crate) fn prepare(base: &Reading, term: &Term, into: &mut Line) -> bool {
    let reading = &base.to_distance(false);
    let target = into.0.as_mut_ptr();
    effects::visit(term.index, Prepare { reading, target })
}
