//! Choosing the constants: from the top, each by a minimax fit to what those above it leave.

use crate::form::contract::Fit;
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};

/// The sum so far: a number, or a value that may stand for its opposite so that it is never negative.
#[derive(Clone, Copy, Debug)]
pub(super) enum Inner {
    Number(i64),
    Signed { value: Value, negated: bool },
}

/// Two to the power of a number of binary places.
pub(super) fn exp2(places: u32) -> f64 {
    f64::from(places).exp2()
}

/// Points of a minimax fit: 256 for at most 7 extrema of the error. Set by hand.
const POINTS: usize = 256;

/// What is left to fit once the stages above `degree` are settled.
pub(super) struct Remaining<'a> {
    fit: &'a Fit<'a>,
    /// Settled part of the factor at each code.
    pub(super) settled: Vec<f64>,
    /// The argument of the polynomial is the code times this.
    unit: f64,
}
impl<'a> Remaining<'a> {
    /// `cut` holds the cut-off product that enters stage `stage`, at each code.
    pub(super) fn new(
        fit: &'a Fit<'a>,
        cut: &[i64],
        stage: usize,
        places: u32,
        spread: u32,
    ) -> Self {
        let unit = exp2(spread);
        let power = |(u, cut): (usize, &i64)| {
            (u as f64 * unit).powi(stage as i32) * *cut as f64 / exp2(places)
        };
        Self {
            fit,
            settled: cut.iter().enumerate().map(power).collect(),
            unit,
        }
    }

    /// Coefficients in powers of the code, and the error that they leave \[unit\].
    pub(super) fn solve(&self, degree: usize) -> (Vec<f64>, f64) {
        let codes = self.settled.len();
        let span = (codes - 1).max(1);
        let count = codes.min(POINTS);
        let picked: Vec<usize> = (0..count).map(|k| k * span / (count - 1).max(1)).collect();
        let x: Vec<f64> = picked.iter().map(|&u| u as f64 / span as f64).collect();
        let y: Vec<f64> = picked
            .iter()
            .map(|&u| self.fit.target[u] - self.settled[u])
            .collect();
        let weight: Vec<f64> = picked.iter().map(|&u| self.fit.weight[u]).collect();
        let (mut coefficients, error) = minimax(
            Points {
                x: &x,
                y: &y,
                weight: &weight,
            },
            degree,
        );
        let mut scale = 1.0;
        for coefficient in &mut coefficients {
            *coefficient /= scale;
            scale *= span as f64 * self.unit;
        }
        (coefficients, error)
    }
}

/// A search for the constants that together leave the least error.
pub(super) struct Search<'a, 'b> {
    pub(super) fit: &'a Fit<'a>,
    pub(super) builder: Builder<'b>,
    pub(super) best: (f64, Vec<i64>),
}

impl Search<'_, '_> {
    /// What enters a stage, with its sign, at each code; nothing enters the highest.
    pub(super) fn values(&self, entering: Option<(Inner, i64)>) -> Vec<i64> {
        let Some((Inner::Signed { value, negated }, lift)) = entering else {
            return vec![0; self.fit.target.len()];
        };
        let sign = if negated { -1 } else { 1 };
        let cuts = self.builder.per_row(value).iter();
        cuts.map(|cut| sign * (cut - lift)).collect()
    }

    /// Keep these coefficients if they leave less than the best so far.
    pub(super) fn consider(&mut self, cut: &[i64], coefficients: &[i64]) {
        let factors: Vec<i64> = cut.iter().map(|cut| cut + coefficients[0]).collect();
        let error = self.fit.error(&factors);
        if error < self.best.0 {
            self.best = (error, coefficients.to_vec());
        }
    }
}
