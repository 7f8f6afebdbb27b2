//! The linear system of one hypothesis, under several noises at once.
#![allow(unsafe_code)]

use super::hypothesis::Layout;
use super::lanes::{LANES, Lane, backward, factor, forward, invert, less, on_widest};
use super::normal::between;
use super::stack::{Noises, Table};

/// Part of a sum of squares that arithmetic leaves behind.
const ROUNDING: f64 = 1e-12;
/// Part of a column's square that whitening may leave in doubt: slow noise takes most of it away.
const WHITENED: f64 = 1e-9;
/// Ratios of a pivot and its precision, each of at most one over [`WHITENED`], that fit in a number.
const FACTORS: usize = 30;
/// Prior standard deviations; bounds beyond are as good as none.
const FAR: f64 = 15.0;

/// Evidence for one combination of widths, up to what all have in common, and the variance.
pub(super) struct Part {
    pub score: Lane,
    pub variance: Lane,
}

/// The system of one hypothesis for some noises, and the memory for solving it.
///
/// The last coefficient comes first: where the precisions of the first ones change, what was done
/// for the others stands.
#[derive(Default)]
pub(super) struct System {
    order: usize,
    degrees: f64,
    finest: f64,
    square: Option<Lane>,
    among: Vec<Lane>,
    along: Vec<Lane>,
    lower: Vec<Lane>,
    precision: Vec<Lane>,
    half: Vec<Lane>,
    solved: Vec<Lane>,
    unit: Vec<Lane>,
}

impl System {
    on_widest! {
        /// Variance that the best coefficients leave, never less than rounding allows.
        least_squares least_avx2 least_avx512 least () -> Lane
    }
    on_widest! {
        /// Factors the system for one combination of widths, given as the variance that the best
        /// coefficients leave over the square of each width, of which the first `changed` may be
        /// others than at the call before.
        part part_avx2 part_avx512 weighed (precisions: &[Lane], changed: usize) -> Part
    }
    on_widest! {
        /// Finds the coefficients, and the variance of each in `bounded`, over that of the noise.
        coefficients coefficients_avx2 coefficients_avx512 solve (bounded: &[usize], variances: &mut Vec<Lane>) -> ()
    }
    on_widest! {
        /// Covariance of two coefficients after the data, over the variance of the noise, for every pair.
        inverse inverse_avx2 inverse_avx512 inverted (into: &mut Vec<Lane>) -> ()
    }

    on_widest! {
        /// Takes the products of some noises.
        take take_avx2 take_avx512 taken (table: &Table, layout: &Layout, noises: &Noises) -> ()
    }

    #[inline(always)]
    fn taken(&mut self, table: &Table, layout: &Layout, noises: &Noises) {
        let (order, last) = (layout.free.len(), table.width - 1);
        self.order = order;
        (self.degrees, self.finest) = (table.degrees, table.finest);
        self.along.resize(order, Lane::all(0.0));
        self.among.resize(order * order, Lane::all(0.0));
        for (i, &row) in layout.free.iter().rev().enumerate() {
            self.along[i] = rest(table, layout, noises, row);
            // only the lower triangle is read
            for (j, &column) in layout.free.iter().rev().take(i + 1).enumerate() {
                self.among[i * order + j] = table.some(row, column, noises);
            }
        }
        let mut square = rest(table, layout, noises, last);
        for &offset in &layout.offsets {
            square = square - rest(table, layout, noises, offset);
        }
        self.square = Some(square.max(Lane::all(table.degrees * table.finest)));
    }

    /// A coefficient that was found.
    #[inline(always)]
    pub fn coefficient(&self, i: usize) -> Lane {
        self.solved[self.order - 1 - i]
    }

    /// What the fixed columns leave of the square.
    #[inline(always)]
    fn square(&self) -> Lane {
        self.square.unwrap_or(Lane::all(0.0))
    }

    #[inline(always)]
    fn least(&mut self) -> Lane {
        let (order, square) = (self.order, self.square());
        let diagonal = (0..order).map(|i| self.among[i * order + i]);
        let trace = diagonal.fold(Lane::all(0.0), |sum, x| sum + x);
        let ridge = Lane::all(WHITENED) * trace + Lane::all(1e-300);
        self.precision.clear();
        self.precision.resize(order, ridge);
        self.halfway(0);
        let left = (square - self.explained()).max(Lane::all(ROUNDING) * square);
        left / Lane::all(self.degrees)
    }

    #[inline(always)]
    fn weighed(&mut self, precisions: &[Lane], changed: usize) -> Part {
        let (order, square) = (self.order, self.square());
        for (i, &precision) in (0..order).rev().zip(&precisions[..changed]) {
            // data without noise would make any prior too wide for the arithmetic
            let least = Lane::all(WHITENED) * self.among[i * order + i];
            self.precision[i] = precision.max(least);
        }
        self.halfway(order - changed);
        let degrees = Lane::all(self.degrees);
        let floor = (Lane::all(ROUNDING) * square).max(degrees * Lane::all(self.finest));
        let left = (square - self.explained()).max(floor);
        Part {
            score: Lane::all(-0.5) * (degrees * left.ln() + self.log_determinant_ratio()),
            variance: left / degrees,
        }
    }

    /// Factors the system with the precisions added, and solves half of it, from a row on.
    #[inline(always)]
    fn halfway(&mut self, from: usize) {
        let order = self.order;
        self.lower.resize(order * order, Lane::all(0.0));
        self.half.resize(order, Lane::all(0.0));
        for i in from..order {
            let line = i * order..i * order + i + 1;
            self.lower[line.clone()].copy_from_slice(&self.among[line]);
            self.lower[i * order + i] = self.lower[i * order + i] + self.precision[i];
        }
        factor(&mut self.lower, order, &self.precision, from);
        for i in from..order {
            let sum = less(
                self.along[i],
                &self.lower[i * order..][..i],
                &self.half[..i],
            );
            self.half[i] = sum / self.lower[i * order + i];
        }
    }

    #[inline(always)]
    fn explained(&self) -> Lane {
        self.half.iter().fold(Lane::all(0.0), |sum, &x| sum + x * x)
    }

    /// `ln(det(L L') / det(diagonal of precisions))`, with as few logarithms as fit.
    #[inline(always)]
    fn log_determinant_ratio(&self) -> Lane {
        let mut sum = Lane::all(0.0);
        for (chunk, precisions) in self.precision.chunks(FACTORS).enumerate() {
            let mut product = Lane::all(1.0);
            for (i, &precision) in (chunk * FACTORS..).zip(precisions) {
                let pivot = self.lower[i * self.order + i];
                product = product * (pivot * pivot / precision);
            }
            sum = sum + product.ln();
        }
        sum
    }

    #[inline(always)]
    fn solve(&mut self, bounded: &[usize], variances: &mut Vec<Lane>) {
        let order = self.order;
        self.solved.clone_from(&self.half);
        backward(&self.lower, order, &mut self.solved);
        variances.clear();
        for i in bounded.iter().map(|&i| order - 1 - i) {
            self.unit.clear();
            self.unit.resize(order, Lane::all(0.0));
            self.unit[i] = Lane::all(1.0);
            forward(&self.lower, order, &mut self.unit, i);
            let squares = self.unit[i..].iter();
            variances.push(squares.fold(Lane::all(0.0), |sum, &x| sum + x * x));
        }
    }

    #[inline(always)]
    fn inverted(&mut self, into: &mut Vec<Lane>) {
        into.clear();
        into.resize(self.order * self.order, Lane::all(0.0));
        self.unit.resize(self.order * self.order, Lane::all(0.0));
        invert(&self.lower, self.order, &mut self.unit, into);
        into.reverse(); // the last coefficient came first, in lines and columns
    }
}

/// Product of a column with what the fixed columns leave of the last one.
#[inline(always)]
fn rest(table: &Table, layout: &Layout, noises: &Noises, column: usize) -> Lane {
    let mut rest = table.some(column, table.width - 1, noises);
    for &offset in &layout.offsets {
        rest = rest - table.some(column, offset, noises);
    }
    rest
}

/// Bounds of coefficients that cut off part of a prior.
#[derive(Default)]
pub(super) struct Bounds {
    /// Coefficients that have such bounds.
    pub near: Vec<usize>,
    /// Bounds of each, and the log of the prior mass between them for each width.
    limits: Vec<((f64, f64), Vec<f64>)>,
}

impl Bounds {
    pub fn of(layout: &Layout, widths: &[f64]) -> Self {
        let is_near = |bounds: &(f64, f64)| bounds.0.abs().min(bounds.1.abs()) <= FAR;
        let near = layout.bounds.iter().enumerate().filter(|(_, b)| is_near(b));
        let mut found = Self::default();
        for (i, &bounds) in near {
            let before = |width: &f64| between(bounds.0 / width, bounds.1 / width).ln();
            found.near.push(i);
            found
                .limits
                .push((bounds, widths.iter().map(before).collect()));
        }
        found
    }

    /// Log of posterior over prior mass within the bounds, coefficient by coefficient, each with
    /// one of the widths.
    pub fn within(
        &self,
        system: &System,
        variances: &[Lane],
        variance: Lane,
        chosen: &[usize],
    ) -> Lane {
        let mut sum = Lane::all(0.0);
        for ((&i, (bounds, before)), &own) in self.near.iter().zip(&self.limits).zip(variances) {
            let mean = system.coefficient(i);
            for lane in 0..LANES {
                let deviation = (variance.0[lane] * own.0[lane])
                    .max(f64::MIN_POSITIVE)
                    .sqrt();
                let limit = |bound: f64| (bound - mean.0[lane]) / deviation;
                let inside = between(limit(bounds.0), limit(bounds.1));
                if inside < 1.0 {
                    sum.0[lane] += inside.max(f64::MIN_POSITIVE).ln();
                }
                sum.0[lane] -= before[chosen[i]];
            }
        }
        sum
    }
}
