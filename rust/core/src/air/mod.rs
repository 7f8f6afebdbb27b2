//! Moist air: composition and the laws for its speed of sound.

pub mod absorption;
pub mod composition;
pub mod cramer;
pub mod dispersion;
pub mod domain;
pub mod ideal_gas;
pub mod linear;
mod relaxation;
mod saturation;
mod state;
mod vapor_pressure;
pub mod virial;
mod virial_coefficients;

pub use absorption::absorption;
use composition::{water_vapor_mole_fraction, water_vapor_mole_fraction_of_rows};
pub use cramer::Cramer;
pub use dispersion::dispersed;
pub use domain::{Departure, Finding, Limits};
pub use ideal_gas::IdealGas;
pub use linear::Linear;
pub use state::Air;
pub use virial::Virial;

use crate::conditions::Quantity;
use crate::error::Error;
use crate::scalar::{Rows, Scalar};

/// What is known about a law, for documentation, checks and messages.
#[derive(Clone, Copy, Debug)]
pub struct LawFacts {
    /// Name in Python, on the command line and in model files.
    pub id: &'static str,
    /// One sentence.
    pub sentence: &'static str,
    /// The formula, in symbols.
    pub formula: &'static str,
    /// Source with DOI.
    pub source: &'static str,
    /// The influence quantities it reacts to.
    pub reads: &'static [Quantity],
    /// Where it holds, and how well, in words.
    pub domain: &'static str,
    /// Where it holds, in numbers.
    pub limits: Limits,
}

/// A law for the zero-frequency speed of sound \[m/s\].
pub trait SpeedLaw: Copy + Send + Sync {
    /// What is known about the law.
    const FACTS: LawFacts;

    /// Speed of sound \[m/s\] at a known mole fraction of water vapor; the air's own relative
    /// humidity is not read.
    fn at_composition<S: Scalar>(&self, air: &Air<S>, water: S) -> S;

    /// Speed of sound \[m/s\].
    #[inline(always)]
    fn speed<S: Scalar>(&self, air: &Air<S>) -> S {
        self.at_composition(air, water_vapor_mole_fraction(air))
    }
}

/// A law as the batch kernels see it: one law, or [`Law`], which of them is found out for each vector of
/// rows.
pub(crate) trait LawOfRows: Copy + Send + Sync + 'static {
    /// Speed of sound \[m/s\] of many rows, from the tabulated saturation pressure.
    fn speed_of_rows<S: Rows>(&self, air: &Air<S>) -> S;

    /// The influence quantities that the law reacts to.
    const READS: &'static [Quantity];
}

impl<L: SpeedLaw + 'static> LawOfRows for L {
    const READS: &'static [Quantity] = L::FACTS.reads;

    /// The compiler leaves the water out where the law does not read it.
    #[inline(always)]
    fn speed_of_rows<S: Rows>(&self, air: &Air<S>) -> S {
        self.at_composition(air, water_vapor_mole_fraction_of_rows(air))
    }
}

impl LawOfRows for Law {
    const READS: &'static [Quantity] = &[
        Quantity::Temperature,
        Quantity::RelativeHumidity,
        Quantity::Pressure,
        Quantity::Co2MoleFraction,
    ];

    #[inline(always)]
    fn speed_of_rows<S: Rows>(&self, air: &Air<S>) -> S {
        self.speed_of_each(air)
    }
}

/// What is to be done with a law whose type is known when it is compiled.
pub(crate) trait LawVisitor {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<L: SpeedLaw + 'static>(self, law: L) -> Self::Output;
}

macro_rules! laws {
    ($($law:ident),+ $(,)?) => {
        /// One of the laws for the speed of sound.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Law {
            $(#[doc = concat!("See [`", stringify!($law), "`].")] $law($law)),+
        }

        impl Law {
            /// What is known about each law.
            pub const ALL: &'static [LawFacts] = &[$($law::FACTS),+];

            /// What is known about this law.
            #[must_use]
            pub fn facts(&self) -> LawFacts {
                match self { $(Self::$law(_) => $law::FACTS),+ }
            }

            /// Speed of sound \[m/s\].
            #[inline(always)]
            pub fn speed<S: Scalar>(&self, air: &Air<S>) -> S {
                match self { $(Self::$law(law) => law.speed(air)),+ }
            }

            #[inline(always)]
            fn speed_of_each<S: Rows>(&self, air: &Air<S>) -> S {
                match self { $(Self::$law(law) => law.speed_of_rows(air)),+ }
            }

            /// Does something with this law, each in a function of its own.
            pub(crate) fn visit<V: LawVisitor>(self, visitor: V) -> V::Output {
                match self { $(Self::$law(law) => visitor.visit(law)),+ }
            }


            /// Speed of sound at a frequency \[m/s\]; the law itself at frequency zero.
            #[inline(always)]
            pub fn speed_at_frequency<S: Scalar>(&self, air: &Air<S>, frequency: S) -> S {
                dispersed(self.speed(air), air, frequency)
            }

            fn named(id: &str) -> Option<Self> {
                $(if id == $law::FACTS.id { return Some(Self::$law($law::default())); })+
                None
            }
        }
    };
}

laws!(Linear, IdealGas, Cramer, Virial);

impl Law {
    /// The names that [`Law::parse`] knows.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        Self::ALL.iter().map(|facts| facts.id).collect()
    }

    /// A law by its name, or a linear law by its expression (`331.3+0.606*T`, `343`).
    ///
    /// # Errors
    /// [`Error::UnknownLaw`] where it is neither.
    pub fn parse(text: &str) -> Result<Self, Error> {
        Self::named(text)
            .or_else(|| Linear::parse(text).map(Self::Linear))
            .ok_or_else(|| Error::UnknownLaw {
                given: text.to_owned(),
                known: Self::names(),
            })
    }

    /// The influence quantities that this law reacts to: none for a fixed speed.
    #[must_use]
    pub fn reads(&self) -> &'static [Quantity] {
        match self {
            Self::Linear(law) if law.slope == 0.0 => &[],
            law => law.facts().reads,
        }
    }

    /// The text that [`Law::parse`] turns back into this law.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Linear(law) if *law != Linear::default() => law.text(),
            other => other.facts().id.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_parse_are_inverse() {
        for text in [
            "linear",
            "cramer",
            "ideal_gas",
            "331.3+0.606*T",
            "343",
            "320-0.5*T",
        ] {
            assert_eq!(Law::parse(text).unwrap().text(), text);
        }
        assert_eq!(Law::parse("331.4 + 0.6*T").unwrap().text(), "linear");
        assert!(
            Law::parse("cramr")
                .unwrap_err()
                .to_string()
                .contains("cramer")
        );
    }
}
