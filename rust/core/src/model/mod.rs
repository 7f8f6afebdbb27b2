//! A model: a law and the effects that extend it.

mod invert;
mod term;

pub(crate) use invert::{ENOUGH, SOME_SPEED, approach, arrive};
pub use term::Term;

use crate::air::{Air, Law, LawOfRows};
use crate::chain::{Chain, Stage};
use crate::conditions::{Conditions, Quantity};
use crate::dual::Dual;
use crate::echo;
use crate::effects;
use crate::error::Error;
use crate::scalar::{Rows, Scalar};

/// A law and the effects that extend it, in the order of the measurement chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    law: Law,
    terms: Vec<Term>,
}

impl Model {
    /// The base simulation: a law without effects.
    #[must_use]
    pub fn new(law: Law) -> Self {
        Self {
            law,
            terms: Vec::new(),
        }
    }

    /// The model extended by an effect; parameters that are not given stay neutral.
    ///
    /// # Errors
    /// [`Error`] where the effect or a parameter is unknown, out of bounds, repeated, counted
    /// twice, or contradicts another effect.
    pub fn with(mut self, id: &str, parameters: &[(&str, f64)]) -> Result<Self, Error> {
        let term = Term::new(id, parameters)?;
        self.admit(&term)?;
        self.terms.push(term);
        self.terms.sort_by_key(|t| (t.facts().stage, t.index));
        Ok(self)
    }

    /// Whether a term fits beside the law and the other terms.
    fn admit(&self, term: &Term) -> Result<(), Error> {
        let (facts, effect) = (term.facts(), term.facts().id);
        if self.terms.iter().any(|t| t.index == term.index) {
            return Err(Error::RepeatedEffect { effect });
        }
        if !facts.extends.is_empty() && !facts.extends.contains(&self.law.facts().id) {
            return Err(Error::NotForThisLaw {
                effect,
                law: self.law.text(),
                extends: facts.extends,
            });
        }
        if let Some(quantity) = facts.supplies
            && self.law.reads().contains(&quantity)
        {
            return Err(Error::CountedTwice {
                effect,
                law: self.law.text(),
                quantity: quantity.facts().name,
            });
        }
        for present in self.terms.iter().map(Term::facts) {
            if let Some(quantity) = facts.contradiction(present) {
                return Err(Error::Contradiction {
                    effect,
                    present: present.id,
                    quantity: quantity.facts().name,
                });
            }
        }
        Ok(())
    }

    /// The law of the base simulation, which the device also converts with.
    #[must_use]
    pub fn law(&self) -> Law {
        self.law
    }

    /// The effects, in the order of the chain.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// All parameters, in the order of the terms.
    #[must_use]
    pub fn parameters(&self) -> Vec<f64> {
        let each = self.terms.iter().map(|t| t.parameters.as_slice());
        each.collect::<Vec<_>>().concat()
    }

    /// Passes one measurement through the whole chain; `parameters` as from
    /// [`Model::parameters`].
    pub fn simulate<S: Rows>(
        &self,
        distance: S,
        recorded: &Conditions<S>,
        parameters: &[S],
    ) -> Chain<S> {
        self.simulate_to(Stage::Indication, distance, recorded, parameters)
    }

    /// Passes one measurement through the chain up to and with a stage.
    ///
    /// One measurement at a time; many pass stage by stage, see [`batch`](crate::batch).
    pub fn simulate_to<S: Rows>(
        &self,
        last: Stage,
        distance: S,
        recorded: &Conditions<S>,
        parameters: &[S],
    ) -> Chain<S> {
        let mut chain = Chain::start(distance, recorded);
        let mut terms = self.terms.iter().peekable();
        let mut rest = parameters;
        for stage in Stage::ALL.into_iter().take_while(|&stage| stage <= last) {
            enter(self.law, stage, &mut chain);
            while let Some(term) = terms.next_if(|t| t.facts().stage == stage) {
                let (own, others) = rest.split_at(term.parameters.len());
                effects::apply(term.index, &mut chain, own);
                rest = others;
            }
        }
        chain
    }

    /// One row up to and with a stage.
    fn row(&self, last: Stage, distance: f64, recorded: &Conditions<f64>) -> Chain<f64> {
        self.simulate_to(last, distance, recorded, &self.parameters())
    }

    /// What the device indicates \[m\] at a true distance \[m\].
    #[must_use]
    pub fn indicate(&self, distance: f64, recorded: &Conditions<f64>) -> f64 {
        self.row(Stage::Indication, distance, recorded).indication
    }

    /// The speed of sound on the path \[m/s\] at a true distance \[m\].
    #[must_use]
    pub fn speed_of_sound(&self, distance: f64, recorded: &Conditions<f64>) -> f64 {
        self.row(Stage::Speed, distance, recorded).speed
    }

    /// The echo time that the device records \[s\], out and back.
    #[must_use]
    pub fn time_of_flight(&self, distance: f64, recorded: &Conditions<f64>) -> f64 {
        self.row(Stage::Timer, distance, recorded).time
    }
}

/// What a stage does without any effect. The speed is that of the batch kernels without a model, bit for bit.
#[inline(always)]
pub(crate) fn enter<S: Rows>(law: Law, stage: Stage, chain: &mut Chain<S>) {
    match stage {
        Stage::Speed => chain.speed = law.speed_of_rows(&chain.air),
        Stage::Path => chain.path = chain.distance,
        Stage::Flight => chain.time = echo::time_of_flight(chain.path, chain.speed),
        Stage::Firmware => {
            chain.firmware_speed = law.speed_of_rows(&Air::recorded(&chain.recorded))
        }
        Stage::Indication => chain.indication = echo::distance(chain.time, chain.firmware_speed),
        Stage::Air | Stage::Transducer | Stage::Timer => {}
    }
}

/// Conditions without derivatives.
fn constants(recorded: &Conditions<f64>) -> Conditions<Dual<1>> {
    Conditions::new(Quantity::ALL.map(|facts| Dual::constant(recorded.get(facts.quantity))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_both_sides() {
        let model = Model::new(Law::parse("linear").unwrap());
        let text = |id, parameters| model.clone().with(id, parameters).unwrap_err().to_string();
        assert!(text("fixed_dely", &[]).contains("fixed_delay"));
        assert!(text("fixed_delay", &[("dealy", 0.0)]).contains("it has: delay"));
        assert!(text("fixed_delay", &[("delay", 1.0)]).contains("-0.0002 .. 0.0002"));
        assert!(text("fixed_delay", &[("delay", f64::NAN)]).contains("is NaN"));
    }

    #[test]
    fn what_cannot_stand_together() {
        let text = |law, first, second| {
            let model = Model::new(Law::parse(law).unwrap());
            let both = model.with(first, &[]).and_then(|m| m.with(second, &[]));
            both.unwrap_err().to_string()
        };
        assert!(text("linear", "clock_error", "clock_error").contains("twice"));
        assert!(text("cramer", "clock_error", "humidity").contains("choose a law"));
        let both = text("linear", "humidity", "unrecorded_humidity");
        assert!(
            both.contains("relative_humidity") && both.contains("keep one"),
            "{both}"
        );
    }
}
