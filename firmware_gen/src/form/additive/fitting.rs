//! The constants of the forms are chosen one form after the other, each with the others already rounded. At every
//! temperature the bound leaves an interval for the value of the form. The form is fitted to the middle of this interval,
//! weighted by its width.

use super::{Additive, Base, Growth, Settled, duplicate_bend};
use crate::form::contract::factors;
use crate::form::plane::{Plane, SPARE, values};

/// Rounds in which each form is fitted once to what the others leave.
const ROUNDS: usize = 2;
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
                bend: duplicate_bend(self.bend.as_ref()),
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
        self.bend = duplicate_bend(first.bend.as_ref());
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
