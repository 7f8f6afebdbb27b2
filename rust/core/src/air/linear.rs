//! The linear law of textbooks and hobby libraries.

use super::domain::{Limits, MOIST_AIR, UNLIMITED};
use super::{Air, LawFacts, SpeedLaw};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// `c = intercept + slope * t`, t in degC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Speed at 0 degC \[m/s\].
    pub intercept: f64,
    /// Slope \[m/(s K)\].
    pub slope: f64,
}

impl Default for Linear {
    /// The coefficients of the study that echocal began from.
    fn default() -> Self {
        Self {
            intercept: 331.4,
            slope: 0.6,
        }
    }
}

impl SpeedLaw for Linear {
    const FACTS: LawFacts = LawFacts {
        id: "linear",
        sentence: "Linear in temperature, dry air, no pressure: what most firmware computes.",
        formula: "c = 331.4 + 0.6 t",
        source: "the study's equation (there ascribed to Cramer 1993, who has no such equation)",
        reads: &[Quantity::Temperature],
        domain: "dry air, -20..60 degC",
        limits: Limits {
            temperature: MOIST_AIR.temperature,
            ..UNLIMITED
        },
    };

    #[inline(always)]
    fn at_composition<S: Scalar>(&self, air: &Air<S>, _: S) -> S {
        if self.slope == 0.0 {
            return S::constant(self.intercept); // a fixed speed needs no thermometer
        }
        S::constant(self.slope).mul_add(air.temperature, S::constant(self.intercept))
    }
}

impl Linear {
    /// Reads `331.3+0.606*T`, `331.4 + 0.6 * T` or a fixed speed `343`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let Some(linear) = text.strip_suffix("*T") else {
            let intercept = finite(&text)?;
            return Some(Self {
                intercept,
                slope: 0.0,
            });
        };
        // the sign that separates the terms: not the first character, not an exponent's
        let split = linear
            .char_indices()
            .skip(1)
            .filter(|&(i, c)| {
                matches!(c, '+' | '-') && !matches!(linear.as_bytes()[i - 1], b'e' | b'E')
            })
            .last()?
            .0;
        Some(Self {
            intercept: finite(&linear[..split])?,
            slope: finite(&linear[split..])?,
        })
    }

    /// The expression that [`Linear::parse`] reads.
    pub(crate) fn text(&self) -> String {
        match self.slope {
            0.0 => format!("{}", self.intercept),
            slope => format!("{}{slope:+}*T", self.intercept),
        }
    }
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions() {
        let law = |intercept, slope| Some(Linear { intercept, slope });
        assert_eq!(Linear::parse("331.3 + 0.606 * T"), law(331.3, 0.606));
        assert_eq!(Linear::parse("3.4e+2-1e-1*T"), law(340.0, -0.1));
        assert_eq!(Linear::parse("343"), law(343.0, 0.0));
        assert_eq!(Linear::parse("T"), None);
        assert_eq!(Linear::parse("nan+0.6*T"), None);
    }
}
