//! What columns are made of: docs/method.md, Eq. 2, and docs/method/rows-and-candidates.md, Eq. 2a.

use echocal_core::model::Term;

/// What a column is.
#[derive(Clone, Debug, PartialEq)]
pub enum Recipe {
    /// Derivative of the base's reading to the distance.
    Slope,
    /// A column that is there, by position.
    Stored(usize),
    /// Change of the base's reading if an effect were there \[m\]: `f` of docs/method.md, Eq. 2.
    Shift(Term, Level),
    /// Derivative of the reading to a parameter of an effect, times a scale, `X` of Eq. 2; without what an
    /// unknown level takes up.
    Tangent(Term, Level, usize, f64),
    /// What a tangent at the base has beyond the one of the same effect, set in later: nothing but
    /// in rows between the two.
    Between(Term, Term, usize, f64),
    /// A basis function of a column that is there, by position, times a scale.
    Of(usize, BasisFunction, f64),
}

/// A basis function of a recorded quantity, for what no effect of the catalogue explains.
#[derive(Clone, Debug, PartialEq)]
pub enum BasisFunction {
    /// Legendre polynomial of the column scaled to -1..1 between two values and cut off at one and a
    /// half.
    Legendre {
        /// Degree of the polynomial.
        degree: usize,
        /// Values that are scaled to -1 and 1.
        between: (f64, f64),
        /// The straight line that is taken off the polynomial: its value at 0, and its slope.
        line: (f64, f64),
    },
    /// Sine or cosine of a multiple of the column's phase.
    Wave {
        /// Period of the column.
        period: f64,
        /// Multiple of the phase.
        multiple: usize,
        /// Whether it is the cosine.
        cosine: bool,
        /// What is taken off.
        mean: f64,
    },
}

/// Distance at which an effect is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// That of the base: the effect does nothing where it is evaluated.
    OfBase,
    /// The base's distance, with an effect at work.
    Known,
    /// The distance of each group if the effect were there \[m\].
    OfGroups(Vec<f64>),
}
