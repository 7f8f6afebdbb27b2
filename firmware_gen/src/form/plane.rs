//! The targets of a fit as a table: a row for each temperature code, a column for each code of the second condition.

use super::contract::{Fit, Form, Lines, factors};
use crate::device::Device;
use crate::minimax::{Points, minimax};

/// Share of the bound that a form is fitted to; the rounding of the other forms takes the rest. Set by hand.
pub(super) const SPARE: f64 = 0.9;
/// Least width of an interval, as a share of the bound. It only keeps the weights finite where no value meets the bound.
const NARROWEST: f64 = 1e-3;

/// The targets of a [`Fit`], seen as a row of codes of the second condition for each temperature.
pub(super) struct Plane<'a> {
    pub(super) fit: &'a Fit<'a>,
    /// The device with the temperature alone.
    pub(super) device: Device,
    /// Codes of the second condition above its lowest, the same at each temperature.
    humidity: Vec<f64>,
}

impl<'a> Plane<'a> {
    pub(super) fn new(fit: &'a Fit<'a>) -> Self {
        let mut device = fit.device.clone();
        device.conditions.truncate(1);
        let axis = &fit.device.conditions[1];
        let wide = fit.target.len() / device.rows();
        let code = |row: &usize| axis.index(fit.device.codes(*row)[1]) as f64;
        let humidity = fit.picked[..wide].iter().map(code).collect();
        Self {
            fit,
            device,
            humidity,
        }
    }

    /// Codes of both conditions above their lowest, of a target.
    pub(super) fn place(&self, index: usize) -> (usize, usize) {
        let wide = self.humidity.len();
        (index / wide, self.humidity[index % wide] as usize)
    }

    pub(super) fn row(&self, index: usize) -> (&[f64], &[f64]) {
        let span = index * self.humidity.len()..(index + 1) * self.humidity.len();
        (&self.fit.target[span.clone()], &self.fit.weight[span])
    }

    /// The best polynomial in the second condition at each temperature.
    pub(super) fn lines(&self, degree: usize) -> &'a Lines {
        let fit: &'a Fit<'a> = self.fit;
        fit.lines[degree].get_or_init(|| self.fitted(degree))
    }

    fn fitted(&self, degree: usize) -> Lines {
        let line = |index: usize| {
            let (y, weight) = self.row(index);
            minimax(
                Points {
                    x: &self.humidity,
                    y,
                    weight,
                },
                degree,
            )
        };
        (0..self.device.rows()).map(line).collect()
    }

    pub(super) fn residual(&self, lines: &Lines) -> f64 {
        lines
            .iter()
            .fold(0.0, |worst, (_, error)| worst.max(*error))
    }

    /// What the form of the `power`-th power must follow, with `bits` binary places, alone.
    pub(super) fn ideal(&self, lines: &Lines, power: usize, bits: u32) -> Fit<'_> {
        let unit = f64::from(bits).exp2();
        let far = self.humidity[self.humidity.len() - 1]
            .powi(power as i32)
            .max(1.0);
        let weight = |index: usize| self.row(index).1[0] * far / unit;
        self.sub(
            lines.iter().map(|(line, _)| line[power] * unit).collect(),
            (0..lines.len()).map(weight).collect(),
            self.fit.bound,
        )
    }

    pub(super) fn sub(&self, target: Vec<f64>, weight: Vec<f64>, bound: f64) -> Fit<'_> {
        Fit {
            device: &self.device,
            picked: (0..self.device.rows()).collect(),
            target,
            weight,
            samples: Vec::new(),
            bound,
            maximum_table: self.fit.maximum_table,
            core: self.fit.core,
            lines: Default::default(),
        }
    }

    /// Targets and weights for a form whose value counts `lever(h)` times, beside `others(temperature, h)`.
    pub(super) fn room(
        &self,
        lever: impl Fn(f64) -> f64,
        others: impl Fn(usize, usize) -> f64,
    ) -> Fit<'_> {
        let bound = self.fit.bound * SPARE;
        let (mut target, mut weight) = (Vec::new(), Vec::new());
        for index in 0..self.device.rows() {
            let (y, w) = self.row(index);
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            for (k, humidity) in self.humidity.iter().enumerate() {
                let lever = lever(*humidity);
                if lever > 0.0 {
                    let rest = y[k] - others(index, k);
                    low = low.max((rest - bound / w[k]) / lever);
                    high = high.min((rest + bound / w[k]) / lever);
                }
            }
            let narrowest =
                NARROWEST * bound / w[0] / lever(self.humidity[self.humidity.len() - 1]);
            target.push(f64::midpoint(low, high));
            weight.push(bound / ((high - low) / 2.0).max(narrowest));
        }
        self.sub(target, weight, bound)
    }
}

impl Plane<'_> {
    /// The values of a form at each temperature.
    pub(super) fn values(&self, form: &dyn Form) -> Vec<f64> {
        values(
            form,
            &self.sub(vec![0.0; self.device.rows()], Vec::new(), 0.0),
        )
    }

    /// What the slope must follow beside a base.
    pub(super) fn beside(
        &self,
        base: &[f64],
        bits: u32,
        square: impl Fn(usize, usize) -> f64,
    ) -> Fit<'_> {
        let unit = f64::from(bits).exp2();
        self.room(
            |humidity| humidity / unit,
            // The product is cut off: half a unit on average.
            |index, k| base[index] - 0.5 + self.humidity[k] * square(index, k) / unit,
        )
    }

    /// What humidity adds at a temperature and a code of the second condition.
    pub(super) fn part(
        &self,
        slope: &[f64],
        bits: u32,
        square: impl Fn(usize, usize) -> f64,
    ) -> impl Fn(usize, usize) -> f64 {
        let unit = f64::from(bits).exp2();
        move |index, k| (self.humidity[k] * (slope[index] + square(index, k)) / unit).floor()
    }

    /// What the square adds to the slope at a temperature and a code of the second condition.
    pub(super) fn square(
        &self,
        bend: Option<&(Box<dyn Form>, u32)>,
    ) -> impl Fn(usize, usize) -> f64 + use<> {
        let humidity = self.humidity.clone();
        let bend = bend.map(|(form, more)| (self.values(form.as_ref()), f64::from(*more).exp2()));
        move |index, k| {
            bend.as_ref().map_or(0.0, |(values, unit)| {
                (humidity[k] * values[index] / unit).floor()
            })
        }
    }

    /// The largest error \[unit\] that is left beside the best base there could be.
    pub(super) fn spread(&self, part: impl Fn(usize, usize) -> f64) -> f64 {
        let spread = |index: usize| {
            let (y, weight) = self.row(index);
            let rests = y.iter().enumerate().map(|(k, y)| y - part(index, k));
            let (low, high) = rests
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), rest| {
                    (rest.min(low), rest.max(high))
                });
            (high - low) / 2.0 * weight.iter().copied().fold(f64::INFINITY, f64::min)
        };
        (0..self.device.rows()).map(spread).fold(0.0, f64::max)
    }
}

/// The values of a form at each row of a fit.
pub(super) fn values(form: &dyn Form, fit: &Fit<'_>) -> Vec<f64> {
    factors(form, fit)
        .iter()
        .map(|value| *value as f64)
        .collect()
}

impl Plane<'_> {
    /// The largest error \[unit\] of a base and what comes on top of it.
    pub(super) fn error(&self, base: &[f64], part: impl Fn(usize, usize) -> f64) -> f64 {
        let mut worst = 0.0_f64;
        for (index, base) in base.iter().enumerate() {
            let (y, weight) = self.row(index);
            for (k, y) in y.iter().enumerate() {
                worst = worst.max((base + part(index, k) - y).abs() * weight[k]);
            }
        }
        worst
    }
}
