//! An effect with its parameters, as part of a model.

use crate::effects::{self, Facts};
use crate::error::Error;

/// An effect with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Position in [`effects::ALL`].
    pub index: usize,
    /// Parameters in the order of the effect's facts.
    pub parameters: Vec<f64>,
}

impl Term {
    /// The effect of this id; parameters that are not given stay neutral.
    ///
    /// # Errors
    /// [`Error`] where the effect or a parameter is unknown or out of bounds.
    pub fn new(id: &str, parameters: &[(&str, f64)]) -> Result<Self, Error> {
        let index = effects::index_of(id).ok_or_else(|| Error::UnknownEffect {
            given: id.to_owned(),
            known: effects::ids(),
        })?;
        let mut term = Self {
            index,
            parameters: effects::ALL[index].neutral(),
        };
        for &(name, value) in parameters {
            term.set(name, value)?;
        }
        Ok(term)
    }

    /// What is known about the effect.
    #[inline(always)]
    #[must_use]
    pub fn facts(&self) -> &'static Facts {
        effects::ALL[self.index]
    }

    fn set(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let facts = self.facts();
        let position = facts
            .parameter(name)
            .ok_or_else(|| Error::UnknownParameter {
                effect: facts.id,
                given: name.to_owned(),
                known: facts.parameters.iter().map(|p| p.name).collect(),
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
        self.parameters[position] = value;
        Ok(())
    }
}
