//! The linear system of one hypothesis, under several noises at once: docs/method.md, Eq. 11 to 14.
#![allow(unsafe_code)]

use super::bounds::Bounds;
use super::hypothesis::HypothesisColumns;
use super::stack::{NoiseTable, Noises, Place};
use crate::numeric::pack_cholesky::{backward, factor, forward, invert, less, squares};
use crate::numeric::{Pack, on_widest};

/// Part of a sum of squares that arithmetic leaves behind: a few thousand roundings of 1.1e-16.
const ROUNDING: f64 = 1e-12;
/// Part of a column's square that whitening may leave in doubt: slow noise takes all but a part in
/// 10^7 of it away, and the roundings of what it takes away remain.
const WHITENED: f64 = 1e-9;
/// Ratios of a pivot and its precision, each of at most one over [`WHITENED`], whose product fits in a
/// double: `10^(9 * 30) = 10^270`, below `10^308`.
const FACTORS: usize = 30;

/// Evidence for one combination of widths, up to what all have in common, and the variance.
pub(super) struct Part {
    pub score: Pack,
    pub variance: Pack,
}

/// The system of one hypothesis for some noises, and the memory for solving it.
///
/// The last coefficient comes first: if the precisions of the first ones change, the results for the
/// others remain valid.
#[derive(Default)]
pub(super) struct System {
    order: usize,
    /// Columns without a coefficient: the fixed ones, and what is to be explained.
    fixed: usize,
    degrees: f64,
    variance_floor: f64,
    square: Option<Pack>,
    /// Positions of the products of the columns: lower triangle; those of what is to be explained and
    /// of the fixed columns, with each free column and, last, with what is to be explained.
    among_at: Vec<Place>,
    along_at: Vec<Place>,
    among: Vec<Pack>,
    along: Vec<Pack>,
    /// `L D L'`, the pivots `D` on the diagonal, and one over each of these.
    lower: Vec<Pack>,
    inverse_pivot: Vec<Pack>,
    precision: Vec<Pack>,
    half: Vec<Pack>,
    solved: Vec<Pack>,
    unit: Vec<Pack>,
}

impl System {
    on_widest! {
        /// Variance `s^2` that the best coefficients leave, never less than rounding allows:
        /// docs/method.md, Eq. 11.
        least_squares least_avx2 least_avx512 least () -> Pack
    }
    on_widest! {
        /// Factors the system for one combination of widths (docs/method.md, Eq. 12 and 13), given as the variance that the best
        /// coefficients leave over the square of each width, of which the first `changed` may be
        /// others than at the call before.
        part part_avx2 part_avx512 evaluated (precisions: &[Pack], changed: usize) -> Part
    }
    on_widest! {
        /// Log of posterior over prior mass within the bounds (docs/method.md, Eq. 15), each coefficient with one of the
        /// widths, given the variance of the noise.
        within within_avx2 within_avx512 bounded (bounds: &Bounds, variance: &Pack, chosen: &[usize]) -> Pack
    }
    on_widest! {
        /// Finds the coefficients: docs/method.md, Eq. 12.
        coefficients coefficients_avx2 coefficients_avx512 solve () -> ()
    }
    on_widest! {
        /// Covariance of two coefficients after the data, over the variance of the noise, for every pair:
        /// docs/method.md, Eq. 14.
        inverse inverse_avx2 inverse_avx512 inverted (into: &mut Vec<Pack>) -> ()
    }

    on_widest! {
        /// Takes the products of some noises.
        take take_avx2 take_avx512 taken (table: &NoiseTable, noises: &Noises) -> ()
    }

    /// Takes up another hypothesis: finds the positions of its products.
    pub fn begin(&mut self, table: &NoiseTable, layout: &HypothesisColumns) {
        let last = table.width - 1;
        self.order = layout.free.len();
        self.fixed = 1 + layout.offsets.len();
        (self.degrees, self.variance_floor) = (table.degrees, table.variance_floor);
        self.among_at.clear();
        self.along_at.clear();
        for (i, &row) in layout.free.iter().rev().enumerate() {
            let before = layout.free.iter().rev().take(i + 1);
            self.among_at
                .extend(before.map(|&column| table.place(row, column)));
        }
        for &row in layout
            .free
            .iter()
            .rev()
            .chain(&[last])
            .chain(&layout.offsets)
        {
            let fixed = [last].into_iter().chain(layout.offsets.iter().copied());
            self.along_at
                .extend(fixed.map(|column| table.place(row, column)));
        }
    }

    #[inline(always)]
    fn taken(&mut self, table: &NoiseTable, noises: &Noises) {
        let order = self.order;
        self.along.resize(order, Pack::all(0.0));
        self.among.resize(order * order, Pack::all(0.0));
        let mut places = self.among_at.iter();
        for i in 0..order {
            // only the lower triangle is read
            let line = &mut self.among[i * order..][..=i];
            for (value, &place) in line.iter_mut().zip(places.by_ref()) {
                *value = table.at(place, noises);
            }
        }
        let (along, square) = self.along_at.split_at(order * self.fixed);
        for (value, places) in self.along.iter_mut().zip(along.chunks(self.fixed)) {
            *value = rest(table, places, noises);
        }
        let (first, others) = square.split_at(self.fixed);
        let mut square = rest(table, first, noises);
        for places in others.chunks(self.fixed) {
            square = square - rest(table, places, noises);
        }
        self.square = Some(square.max(Pack::all(self.degrees * self.variance_floor)));
    }

    /// A coefficient that was found.
    #[inline(always)]
    pub fn coefficient(&self, i: usize) -> Pack {
        self.solved[self.order - 1 - i]
    }

    /// What the fixed columns leave of the square.
    #[inline(always)]
    fn square(&self) -> Pack {
        self.square.unwrap_or(Pack::all(0.0))
    }

    #[inline(always)]
    fn least(&mut self) -> Pack {
        let (order, square) = (self.order, self.square());
        let mut trace = Pack::all(0.0);
        for i in 0..order {
            trace = trace + self.among[i * order + i];
        }
        let ridge = Pack::all(WHITENED) * trace + Pack::all(1e-300);
        self.precision.clear();
        self.precision.resize(order, ridge);
        self.halfway(0);
        let left = (square - self.explained()).max(Pack::all(ROUNDING) * square);
        left / Pack::all(self.degrees)
    }

    #[inline(always)]
    fn evaluated(&mut self, precisions: &[Pack], changed: usize) -> Part {
        let (order, square) = (self.order, self.square());
        let mut own = 0;
        while own < changed {
            // data without noise would make any prior too wide for the arithmetic
            let i = order - 1 - own;
            let least = Pack::all(WHITENED) * self.among[i * order + i];
            self.precision[i] = precisions[own].max(least);
            own += 1;
        }
        self.halfway(order - changed);
        let degrees = Pack::all(self.degrees);
        let floor = (Pack::all(ROUNDING) * square).max(degrees * Pack::all(self.variance_floor));
        let left = (square - self.explained()).max(floor);
        Part {
            score: Pack::all(-0.5) * (degrees * left.ln() + self.log_determinant_ratio()),
            variance: left / degrees,
        }
    }

    /// Factors the system with the precisions added, and solves half of it, from a row on.
    #[inline(always)]
    fn halfway(&mut self, from: usize) {
        let order = self.order;
        self.lower.resize(order * order, Pack::all(0.0));
        self.half.resize(order, Pack::all(0.0));
        self.inverse_pivot.resize(order, Pack::all(0.0));
        let (lower, inverse) = (&mut self.lower, &mut self.inverse_pivot);
        factor(&self.among, &self.precision, lower, inverse, from);
        for i in from..order {
            let line = &self.lower[i * order..][..i];
            self.half[i] = less(self.along[i], line, &self.half[..i]);
        }
    }

    #[inline(always)]
    fn explained(&self) -> Pack {
        squares(&self.half, &self.inverse_pivot)
    }

    /// `ln(det(D) / det(diagonal of precisions))`, with as few logarithms as fit.
    #[inline(always)]
    fn log_determinant_ratio(&self) -> Pack {
        let (mut sum, mut product, mut at) = (Pack::all(0.0), Pack::all(1.0), 0);
        while at < self.order {
            product = product * (self.inverse_pivot[at] * self.precision[at]);
            at += 1;
            if at % FACTORS == 0 || at == self.order {
                sum = sum - product.ln();
                product = Pack::all(1.0);
            }
        }
        sum
    }

    #[inline(always)]
    fn solve(&mut self) {
        self.solved.resize(self.order, Pack::all(0.0));
        let mut at = 0;
        while at < self.order {
            self.solved[at] = self.half[at] * self.inverse_pivot[at];
            at += 1;
        }
        backward(&self.lower, self.order, &mut self.solved);
    }

    #[inline(always)]
    fn bounded(&mut self, bounds: &Bounds, variance: &Pack, chosen: &[usize]) -> Pack {
        self.solve();
        self.unit.resize(self.order, Pack::all(0.0));
        let (order, lower, solved, unit) = (self.order, &self.lower, &self.solved, &mut self.unit);
        let inverse = &self.inverse_pivot;
        let moments = bounds.near.iter().map(|&near| {
            let i = order - 1 - near;
            unit[i..order].fill(Pack::all(0.0));
            unit[i] = Pack::all(1.0);
            forward(lower, order, unit, i);
            let own = squares(&unit[i..order], &inverse[i..]);
            (solved[i], own * *variance)
        });
        bounds.within(moments, |i| chosen[i])
    }

    #[inline(always)]
    fn inverted(&mut self, into: &mut Vec<Pack>) {
        into.clear();
        into.resize(self.order * self.order, Pack::all(0.0));
        self.unit.resize(self.order * self.order, Pack::all(0.0));
        let inverse = &self.inverse_pivot;
        invert(&self.lower, self.order, inverse, &mut self.unit, into);
        into.reverse(); // the last coefficient came first, in lines and columns
    }
}

/// The first of some products less the others.
#[inline(always)]
fn rest(table: &NoiseTable, places: &[Place], noises: &Noises) -> Pack {
    let mut rest = table.at(places[0], noises);
    for &place in &places[1..] {
        rest = rest - table.at(place, noises);
    }
    rest
}
