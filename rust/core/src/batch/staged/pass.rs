//! A block of rows through the chain, with the effects of a model and one more.

use super::kernels::{Apply, enter};
use super::tracks::{Reading, TRACKS, Track, tracks_of};
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
        mut reading: Reading,
        last: Stage,
        seed: Option<(usize, usize)>,
    ) -> Reading {
        for stage in Stage::ALL.into_iter().take_while(|&stage| stage <= last) {
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
            let alone = !model.terms().iter().any(|t| t.facts().stage == stage);
            let extra: Applied<'_> = (term.index, &term.parameters, seed);
            if stage == own && alone {
                self.apply(extra, &mut reading); // the variable is what the stage's entry made it
            } else if stage == own {
                self.stage(model, stage, Some(extra), &mut reading);
            } else if !(alone && matches!(stage, Stage::Path | Stage::Firmware)) {
                // these two read nothing that an effect changes
                self.stage(model, stage, None, &mut reading);
            }
        }
        reading
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

    fn apply(&mut self, (index, parameters, seed): Applied<'_>, reading: &mut Reading) {
        let tracks = tracks_of(ALL[index].stage);
        let target = self.tracks[tracks.clone()].as_mut_ptr();
        let work = Apply {
            reading,
            parameters,
            seed,
            target,
        };
        effects::visit(index, work);
        for track in tracks {
            reading.place(track, &raw const self.tracks[track]);
        }
    }
}
