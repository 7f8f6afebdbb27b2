//! Choosing the forms' constants one after the other, each given the others as they are rounded: at every temperature
//! the bound leaves an interval for the value that is sought, and the form is fitted to its middle, weighted by its width.

use super::{Additive, Base, Growth, Settled, twin};
use crate::device::Device;
use crate::form::{Fit, Form, factors};
use crate::minimax::{Points, minimax};

/// Rounds in which each form is fitted once to what the others leave.
const ROUNDS: usize = 2;
/// Share of the bound that the rounding of the other forms may take from a form's first fit.
const SPARE: f64 = 0.9;
/// Narrowest interval, as a share of the bound: where the others leave none, this form cannot help.
const NARROWEST: f64 = 1e-3;

/// The targets of a [`Fit`], seen as a row of codes of the second condition for each temperature.
pub(in crate::form) struct Plane<'a> {
    fit: &'a Fit<'a>,
    /// The device with the temperature alone.
    device: Device,
    /// Codes of the second condition above its lowest, the same at each temperature.
    damp: Vec<f64>,
}

/// Coefficients in powers of the second condition's code, and the error left \[unit\], at each temperature.
pub type Lines = Vec<(Vec<f64>, f64)>;

impl<'a> Plane<'a> {
    pub(in crate::form) fn new(fit: &'a Fit<'a>) -> Self {
        let mut device = fit.device.clone();
        device.conditions.truncate(1);
        let axis = &fit.device.conditions[1];
        let wide = fit.target.len() / device.rows();
        let code = |row: &usize| (fit.device.codes(*row)[1] - axis.codes.minimum) as f64;
        let damp = fit.picked[..wide].iter().map(code).collect();
        Self { fit, device, damp }
    }

    /// Codes of both conditions above their lowest, of a target.
    pub(in crate::form) fn place(&self, index: usize) -> (usize, usize) {
        let wide = self.damp.len();
        (index / wide, self.damp[index % wide] as usize)
    }

    fn row(&self, index: usize) -> (&[f64], &[f64]) {
        let span = index * self.damp.len()..(index + 1) * self.damp.len();
        (&self.fit.target[span.clone()], &self.fit.weight[span])
    }

    /// The best polynomial in the second condition at each temperature.
    pub(in crate::form) fn lines(&self, degree: usize) -> &'a Lines {
        let fit: &'a Fit<'a> = self.fit;
        fit.lines[degree].get_or_init(|| self.fitted(degree))
    }

    fn fitted(&self, degree: usize) -> Lines {
        let line = |index: usize| {
            let (y, weight) = self.row(index);
            minimax(
                Points {
                    x: &self.damp,
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
        let far = self.damp[self.damp.len() - 1].powi(power as i32).max(1.0);
        let weight = |index: usize| self.row(index).1[0] * far / unit;
        self.sub(
            lines.iter().map(|(line, _)| line[power] * unit).collect(),
            (0..lines.len()).map(weight).collect(),
            self.fit.bound,
        )
    }

    fn sub(&self, target: Vec<f64>, weight: Vec<f64>, bound: f64) -> Fit<'_> {
        Fit {
            device: &self.device,
            picked: (0..self.device.rows()).collect(),
            target,
            weight,
            bound,
            maximum_table: self.fit.maximum_table,
            core: self.fit.core,
            lines: Default::default(),
        }
    }

    /// Targets and weights for a form whose value counts `lever(h)` times, beside `others(temperature, h)`.
    fn room(&self, lever: impl Fn(f64) -> f64, others: impl Fn(usize, usize) -> f64) -> Fit<'_> {
        let bound = self.fit.bound * SPARE;
        let (mut target, mut weight) = (Vec::new(), Vec::new());
        for index in 0..self.device.rows() {
            let (y, w) = self.row(index);
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            for (k, damp) in self.damp.iter().enumerate() {
                let lever = lever(*damp);
                if lever > 0.0 {
                    let rest = y[k] - others(index, k);
                    low = low.max((rest - bound / w[k]) / lever);
                    high = high.min((rest + bound / w[k]) / lever);
                }
            }
            let narrowest = NARROWEST * bound / w[0] / lever(self.damp[self.damp.len() - 1]);
            target.push(f64::midpoint(low, high));
            weight.push(bound / ((high - low) / 2.0).max(narrowest));
        }
        self.sub(target, weight, bound)
    }
}

impl Base {
    /// The error that it leaves at the least humidity, where nothing comes on top of it \[unit\].
    pub(super) fn least(&self, plane: &Plane<'_>) -> f64 {
        *self.least.get_or_init(|| {
            let rows = 0..plane.device.rows();
            let (target, weight) = rows
                .map(|index| plane.row(index))
                .map(|(y, w)| (y[0], w[0]))
                .unzip();
            let fit = plane.sub(target, weight, plane.fit.bound * SPARE);
            let mut form = self.form.duplicate();
            form.refine(&fit);
            fit.error(&factors(form.as_ref(), &fit))
        })
    }
}

impl Growth {
    /// Its forms, fitted beside an ideal base.
    pub(super) fn settled(&self, plane: &Plane<'_>) -> &Settled {
        self.settled.get_or_init(|| {
            let lines = plane.lines(if self.bend.is_some() { 2 } else { 1 });
            let mut found = Settled {
                slope: self.slope.duplicate(),
                bend: twin(self.bend.as_ref()),
                least: 0.0,
            };
            if let Some((form, more)) = &mut found.bend {
                form.refine(&plane.ideal(lines, 2, self.bits + *more));
            }
            let square = plane.square(found.bend.as_ref());
            let base: Vec<f64> = lines.iter().map(|(line, _)| line[0]).collect();
            let fit = plane.beside(&base, self.bits, &square);
            found.slope.refine(&fit);
            let slope = values(found.slope.as_ref(), &fit);
            found.least = plane.spread(plane.part(&slope, self.bits, &square));
            found
        })
    }
}

impl Additive {
    /// Fit each form to what the others leave, as they are rounded.
    pub(super) fn settle(&mut self, plane: &Plane<'_>) {
        let first = self.growth_part.settled(plane);
        self.slope = first.slope.duplicate();
        self.bend = twin(first.bend.as_ref());
        let square = plane.square(self.bend.as_ref());
        let mut best: Option<(f64, Self)> = None;
        for round in 0..ROUNDS {
            if round > 0 {
                let base = plane.values(self.base.as_ref());
                self.slope.refine(&plane.beside(&base, self.bits, &square));
            }
            let slope = plane.values(self.slope.as_ref());
            let part = plane.part(&slope, self.bits, &square);
            self.base.refine(&plane.room(|_| 1.0, &part));
            let base = plane.values(self.base.as_ref());
            let error = plane.error(&base, &part);
            if best.as_ref().is_none_or(|best| error < best.0) {
                best = Some((error, self.copy()));
            }
        }
        if let Some((error, found)) = best {
            *self = found;
            self.reached = Some(error);
        }
    }
}

impl Plane<'_> {
    /// The values of a form at each temperature.
    fn values(&self, form: &dyn Form) -> Vec<f64> {
        values(
            form,
            &self.sub(vec![0.0; self.device.rows()], Vec::new(), 0.0),
        )
    }

    /// What the slope must follow beside a base.
    fn beside(&self, base: &[f64], bits: u32, square: impl Fn(usize, usize) -> f64) -> Fit<'_> {
        let unit = f64::from(bits).exp2();
        self.room(
            |damp| damp / unit,
            // The product is cut off: half a unit on average.
            |index, k| base[index] - 0.5 + self.damp[k] * square(index, k) / unit,
        )
    }

    /// What humidity adds at a temperature and a code of the second condition.
    fn part(
        &self,
        slope: &[f64],
        bits: u32,
        square: impl Fn(usize, usize) -> f64,
    ) -> impl Fn(usize, usize) -> f64 {
        let unit = f64::from(bits).exp2();
        move |index, k| (self.damp[k] * (slope[index] + square(index, k)) / unit).floor()
    }

    /// What the square adds to the slope at a temperature and a code of the second condition.
    fn square(&self, bend: Option<&(Box<dyn Form>, u32)>) -> impl Fn(usize, usize) -> f64 + use<> {
        let damp = self.damp.clone();
        let bend = bend.map(|(form, more)| (self.values(form.as_ref()), f64::from(*more).exp2()));
        move |index, k| {
            bend.as_ref().map_or(0.0, |(values, unit)| {
                (damp[k] * values[index] / unit).floor()
            })
        }
    }

    /// The largest error \[unit\] that is left beside the best base there could be.
    fn spread(&self, part: impl Fn(usize, usize) -> f64) -> f64 {
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

fn values(form: &dyn Form, fit: &Fit<'_>) -> Vec<f64> {
    factors(form, fit)
        .iter()
        .map(|value| *value as f64)
        .collect()
}

impl Plane<'_> {
    /// The largest error \[unit\] of a base and what comes on top of it.
    fn error(&self, base: &[f64], part: impl Fn(usize, usize) -> f64) -> f64 {
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
