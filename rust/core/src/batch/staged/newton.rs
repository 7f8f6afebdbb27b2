//! Newton's method over a block of rows.

use super::kernels::{Work, each, store};
use super::tracks::{BLOCK, Line, LineRef, Reading, SharedLine};
use crate::chain::Stage;
use crate::dual::Dual;
use crate::echo;
use crate::model::approach;
use crate::simd::Vector;
use core::cell::Cell;

/// The state of Newton's method over a block.
pub(super) struct Newton<'a> {
    target: LineRef<'a>,
    distance: SharedLine,
    settled: SharedLine,
}

impl<'a> Newton<'a> {
    /// Starts at the values of a block, or, where these are times, at the distances that they are at
    /// this speed.
    pub(super) fn new(block: &Reading<'a>, speed: Option<LineRef<'a>>) -> Self {
        let [target, _] = block.distance;
        let newton = Self {
            target,
            distance: SharedLine::of(0.0),
            settled: SharedLine::of(-1.0),
        };
        let guess = Guess {
            target,
            speed,
            into: newton.distance.cell(),
        };
        // SAFETY: a reading has its rows, at most a block, and so has a line.
        unsafe { each(&guess, block.rows()) };
        newton
    }

    /// The present distances.
    pub(super) fn distance(&self) -> LineRef<'_> {
        LineRef::shared(&self.distance)
    }

    /// One step for every row, given what the present distances reach in a stage; whether all have
    /// settled.
    pub(super) fn settle(&self, reached: &Reading<'_>, stage: Stage) -> bool {
        let step = Step {
            newton: self,
            reached: reached.of(stage),
        };
        // SAFETY: a reading has its rows, at most a block, and so have the lines.
        unsafe { each(&step, reached.rows()) };
        let settled = &self.settled.cells()[..reached.rows()];
        settled.iter().all(|settled| settled.get() >= 0.0)
    }

    /// The distance of each row; NaN where it did not settle.
    pub(super) fn found(&self, into: &mut Line) {
        let rows = self.distance.cells().iter().zip(self.settled.cells());
        for (found, (distance, settled)) in into.0.iter_mut().zip(rows) {
            let settled = settled.get() >= 0.0;
            *found = if settled { distance.get() } else { f64::NAN };
        }
    }
}

struct Guess<'a> {
    target: LineRef<'a>,
    speed: Option<LineRef<'a>>,
    into: &'a Cell<[f64; BLOCK]>,
}

impl Work for Guess<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's.
        unsafe {
            let target: V = self.target.load(row);
            let guess = match self.speed {
                None => target,
                Some(speed) => echo::distance(target, speed.load(row)),
            };
            store(guess, self.into, row);
        }
    }
}

struct Step<'a> {
    newton: &'a Newton<'a>,
    reached: (LineRef<'a>, LineRef<'a>),
}

impl Work for Step<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let Newton {
            target,
            distance,
            settled,
        } = self.newton;
        // SAFETY: the caller's.
        unsafe {
            let reached = Dual {
                value: self.reached.0.load(row),
                derivatives: [self.reached.1.load(row)],
            };
            let present: V = LineRef::shared(distance).load(row);
            let before: V = LineRef::shared(settled).load(row);
            let (next, done) = approach(target.load(row), reached, present, before);
            store(next, distance.cell(), row);
            store(done, settled.cell(), row);
        }
    }
}
