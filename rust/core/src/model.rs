//! A model: a law and the effects that extend it.

use crate::air::{Air, Law};
use crate::chain::{Chain, Stage};
use crate::conditions::{Conditions, Quantity};
use crate::dual::Dual;
use crate::effects;
use crate::error::Error;
use crate::scalar::Scalar;

/// An effect with its parameters, as part of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Position in [`effects::ALL`].
    pub index: usize,
    /// Parameters in the order of the effect's facts.
    pub parameters: Vec<f64>,
}

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
    /// [`Error`] where the effect or a parameter is unknown, out of bounds or counted twice.
    pub fn with(mut self, id: &str, parameters: &[(&str, f64)]) -> Result<Self, Error> {
        let index = effects::index_of(id).ok_or_else(|| Error::UnknownEffect {
            given: id.to_owned(),
        })?;
        let facts = effects::ALL[index];
        if self.terms.iter().any(|term| term.index == index) {
            return Err(Error::RepeatedEffect { effect: facts.id });
        }
        if let Some(quantity) = facts.supplies
            && self.law.facts().reads.contains(&quantity)
        {
            return Err(Error::CountedTwice {
                effect: facts.id,
                law: self.law.text(),
                quantity: quantity.facts().name,
            });
        }
        let mut values: Vec<f64> = facts.parameters.iter().map(|p| p.neutral).collect();
        for &(name, value) in parameters {
            let position = facts
                .parameter(name)
                .ok_or_else(|| Error::UnknownParameter {
                    effect: facts.id,
                    given: name.to_owned(),
                })?;
            let parameter = facts.parameters[position];
            if !(parameter.bounds.0..=parameter.bounds.1).contains(&value) {
                return Err(Error::ParameterOutOfBounds {
                    effect: facts.id,
                    parameter: parameter.name,
                    given: value,
                    bounds: parameter.bounds,
                });
            }
            values[position] = value;
        }
        self.terms.push(Term {
            index,
            parameters: values,
        });
        self.terms
            .sort_by_key(|term| (effects::ALL[term.index].stage, term.index));
        Ok(self)
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
        self.terms
            .iter()
            .flat_map(|t| t.parameters.iter().copied())
            .collect()
    }

    /// Passes one measurement through the chain; `parameters` as from [`Model::parameters`].
    #[inline(always)]
    pub fn simulate<S: Scalar>(
        &self,
        distance: S,
        recorded: &Conditions<S>,
        parameters: &[S],
    ) -> Chain<S> {
        let mut chain = Chain::start(distance, recorded);
        let mut terms = self.terms.iter();
        let mut next = terms.next();
        let mut first = 0;
        for stage in Stage::ALL {
            self.enter(stage, &mut chain);
            while let Some(term) = next
                && effects::ALL[term.index].stage == stage
            {
                let last = first + term.parameters.len();
                effects::apply(term.index, &mut chain, &parameters[first..last]);
                first = last;
                next = terms.next();
            }
        }
        chain
    }

    /// What a stage does without any effect.
    #[inline(always)]
    fn enter<S: Scalar>(&self, stage: Stage, chain: &mut Chain<S>) {
        let half = S::constant(0.5);
        match stage {
            Stage::Speed => chain.speed = self.law.speed(&chain.air),
            Stage::Path => chain.path = chain.distance,
            Stage::Flight => chain.time = (chain.path + chain.path) / chain.speed,
            Stage::Firmware => {
                chain.firmware_speed = self.law.speed(&Air::recorded(&chain.recorded))
            }
            Stage::Indication => chain.indication = half * chain.firmware_speed * chain.time,
            Stage::Air | Stage::Transducer | Stage::Timer => {}
        }
    }

    /// What the device indicates \[m\] at a true distance \[m\].
    #[must_use]
    pub fn indicate(&self, distance: f64, recorded: &Conditions<f64>) -> f64 {
        self.simulate(distance, recorded, &self.parameters())
            .indication
    }

    /// The echo time that the device records \[s\], out and back.
    #[must_use]
    pub fn time_of_flight(&self, distance: f64, recorded: &Conditions<f64>) -> f64 {
        self.simulate(distance, recorded, &self.parameters()).time
    }

    /// The true distance \[m\] of an indication \[m\]: the inverse of [`Model::indicate`].
    #[must_use]
    pub fn correct(&self, indication: f64, recorded: &Conditions<f64>) -> f64 {
        self.invert(indication, indication, recorded, |chain| chain.indication)
    }

    /// The true distance \[m\] of a recorded echo time \[s\].
    #[must_use]
    pub fn distance(&self, time: f64, recorded: &Conditions<f64>) -> f64 {
        let guess = 0.5 * time * self.law.speed(&Air::recorded(recorded));
        self.invert(time, guess, recorded, |chain| chain.time)
    }

    /// Derivatives of the indication: first to the distance, then to each parameter.
    #[must_use]
    pub fn jacobian(&self, distance: f64, recorded: &Conditions<f64>) -> Vec<f64> {
        const AT_ONCE: usize = 8;
        let values = self.parameters();
        let recorded = constants(recorded);
        let mut row = Vec::with_capacity(1 + values.len());
        while row.len() <= values.len() {
            let first = row.len();
            let seed = |position: usize, value| match position.checked_sub(first) {
                Some(index) if index < AT_ONCE => Dual::<AT_ONCE>::variable(value, index),
                _ => Dual::constant(value),
            };
            let parameters: Vec<_> = values
                .iter()
                .enumerate()
                .map(|(i, &value)| seed(i + 1, value))
                .collect();
            let chain = self.simulate(seed(0, distance), &recorded, &parameters);
            let count = AT_ONCE.min(1 + values.len() - first);
            row.extend_from_slice(&chain.indication.derivatives[..count]);
        }
        row
    }

    /// Newton's method on the exact derivative to the distance; NaN where it does not settle.
    fn invert(
        &self,
        target: f64,
        guess: f64,
        recorded: &Conditions<f64>,
        output: impl Fn(&Chain<Dual<1>>) -> Dual<1>,
    ) -> f64 {
        const ENOUGH: usize = 20; // affine chains settle in two
        const SETTLED: f64 = 1e-15; // relative to the distance
        let parameters: Vec<_> = self.parameters().into_iter().map(Dual::constant).collect();
        let recorded = constants(recorded);
        let mut distance = guess;
        for _ in 0..ENOUGH {
            let chain = self.simulate(Dual::variable(distance, 0), &recorded, &parameters);
            let reached = output(&chain);
            let step = (target - reached.value) / reached.derivatives[0];
            distance += step;
            if step.abs() <= SETTLED * distance.abs() || !step.is_finite() {
                return distance;
            }
        }
        f64::NAN
    }
}

/// Conditions without derivatives.
fn constants<const N: usize>(recorded: &Conditions<f64>) -> Conditions<Dual<N>> {
    Conditions::new(core::array::from_fn(|index| {
        Dual::constant(recorded.get(Quantity::ALL[index].quantity))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrects_what_it_indicates() {
        let model = Model::new(Law::parse("cramer").unwrap())
            .with("fixed_delay", &[("delay", 31e-6)])
            .and_then(|m| m.with("zero_error", &[("offset", -4e-3)]))
            .unwrap();
        let at = Conditions::at(17.3);
        for distance in [0.02, 0.5, 2.0, 4.0] {
            let indication = model.indicate(distance, &at);
            assert!((model.correct(indication, &at) - distance).abs() < 1e-12);
            let time = model.time_of_flight(distance, &at);
            assert!((model.distance(time, &at) - distance).abs() < 1e-12);
        }
    }

    #[test]
    fn errors_name_both_sides() {
        let model = Model::new(Law::parse("linear").unwrap());
        let text = |id, parameters| model.clone().with(id, parameters).unwrap_err().to_string();
        assert!(text("fixed_dely", &[]).contains("fixed_delay"));
        assert!(text("fixed_delay", &[("dealy", 0.0)]).contains("it has: delay"));
        assert!(text("fixed_delay", &[("delay", 1.0)]).contains("-0.0002 .. 0.0002"));
    }
}
