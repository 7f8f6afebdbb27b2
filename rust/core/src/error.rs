//! Typed errors of the core. Their texts name both sides of the comparison and the way out.

use core::fmt;

/// What can be wrong with a request to the core.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// No law of this name, and not a linear expression such as `331.3+0.606*T`.
    UnknownLaw {
        /// The name as given.
        given: String,
        /// The names that there are.
        known: Vec<&'static str>,
    },
    /// No effect of this id in the registry.
    UnknownEffect {
        /// The id as given.
        given: String,
        /// The ids that there are.
        known: Vec<&'static str>,
    },
    /// The effect has no parameter of this name.
    UnknownParameter {
        /// Id of the effect.
        effect: &'static str,
        /// The parameter's name as given.
        given: String,
        /// The names that there are.
        known: Vec<&'static str>,
    },
    /// A parameter lies outside its bounds.
    ParameterOutOfBounds {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// The value as given.
        given: f64,
        /// Lower and upper bound.
        bounds: (f64, f64),
    },
    /// The same effect stands twice in one model.
    RepeatedEffect {
        /// Id of the effect.
        effect: &'static str,
    },
    /// The law accounts already for what the effect would add.
    CountedTwice {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the law.
        law: String,
        /// The influence quantity in question.
        quantity: &'static str,
    },
    /// An effect extends some laws only, and the model has another.
    NotForThisLaw {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the law.
        law: String,
        /// Names of the laws that it extends.
        extends: &'static [&'static str],
    },
    /// One effect needs a quantity recorded that another needs not recorded.
    Contradiction {
        /// Id of the effect that was to be added.
        effect: &'static str,
        /// Id of the effect that stands in the model already.
        present: &'static str,
        /// The influence quantity in question.
        quantity: &'static str,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownLaw { given, known } => write!(
                f,
                "unknown law '{given}'; use one of {} or a linear expression such as '331.3+0.606*T'",
                known.join(", ")
            ),
            Self::UnknownEffect { given, known } => {
                write!(f, "unknown effect '{given}'; known: {}", known.join(", "))
            }
            Self::UnknownParameter {
                effect,
                given,
                known,
            } => write!(
                f,
                "effect '{effect}' has no parameter '{given}'; it has: {}",
                known.join(", ")
            ),
            Self::ParameterOutOfBounds {
                effect,
                parameter,
                given,
                bounds: (low, high),
            } => write!(
                f,
                "{effect}.{parameter} is {given}, outside its bounds {low} .. {high}"
            ),
            Self::RepeatedEffect { effect } => {
                write!(
                    f,
                    "effect '{effect}' stands twice in the model; give it once"
                )
            }
            Self::CountedTwice {
                effect,
                law,
                quantity,
            } => write!(
                f,
                "law '{law}' already reads {quantity}: effect '{effect}' would count it twice; \
                 drop the effect or choose a law that ignores {quantity} (linear)"
            ),
            Self::NotForThisLaw {
                effect,
                law,
                extends,
            } => write!(
                f,
                "effect '{effect}' has no meaning beside law '{law}'; it extends {}",
                extends.join(", ")
            ),
            Self::Contradiction {
                effect,
                present,
                quantity,
            } => write!(
                f,
                "effects '{present}' and '{effect}' exclude each other: one needs {quantity} \
                 recorded, the other not recorded; keep one of them"
            ),
        }
    }
}

impl core::error::Error for Error {}
