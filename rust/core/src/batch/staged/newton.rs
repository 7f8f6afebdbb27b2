//! Newton's method over a block of rows.

use super::kernels::{Work, each, store};
use super::tracks::{LineRef, Reading, SharedLine};
use crate::chain::Stage;
use crate::dual::Dual;
use crate::echo;
use crate::model::{SOME_SPEED, approach, arrive};
use crate::simd::Vector;

/// Memory for Newton's method over a block.
pub(super) struct State {
    distance: SharedLine,
    settled: SharedLine,
}

impl State {
    pub(super) const fn new() -> Self {
        Self {
            distance: SharedLine::of(0.0),
            settled: SharedLine::of(0.0),
        }
    }
}

/// Newton's method over a block.
#[derive(Clone, Copy)]
pub(super) struct Newton<'a> {
    target: LineRef<'a>,
    state: &'a State,
    rows: usize,
}

impl<'a> Newton<'a> {
    /// Towards the values of a block.
    pub(super) fn new(block: &Reading<'a>, state: &'a State) -> Self {
        Self {
            target: block.distance[0],
            state,
            rows: block.rows(),
        }
    }

    /// The distances that these times are at a speed, or at a usual one: where to start.
    pub(super) fn guess(self, speed: Option<LineRef<'a>>) -> LineRef<'a> {
        let newton = self;
        // SAFETY: a reading has its rows, at most a block, and so have the lines.
        unsafe { each(&Guess { newton, speed }, self.rows) };
        LineRef::shared(&self.state.distance)
    }

    /// The distances from which one step arrives, given what a block of a straight line reaches in a stage.
    pub(super) fn arrive(self, reached: &Reading<'a>, stage: Stage) -> &'a [f64] {
        let step = Arrive(self.step(reached, stage));
        // SAFETY: as above.
        unsafe { each(&step, self.rows) };
        reached.numbers(LineRef::shared(&self.state.distance))
    }

    /// The block one step nearer, given what it reaches in a stage.
    pub(super) fn approach(self, reached: Reading<'a>, stage: Stage, first: bool) -> Reading<'a> {
        let step = self.step(&reached, stage);
        // SAFETY: as above.
        unsafe { each(&Approach { step, first }, self.rows) };
        reached.at_line(LineRef::shared(&self.state.distance))
    }

    fn step(self, reached: &Reading<'a>, stage: Stage) -> Step<'a> {
        Step {
            newton: self,
            present: reached.distance[0],
            reached: reached.of(stage),
        }
    }

    /// Whether a row may still settle.
    pub(super) fn goes_on(self) -> bool {
        let State { distance, settled } = self.state;
        let mut rows = distance.cells().iter().zip(settled.cells()).take(self.rows);
        // no step leads away from what is not a number
        rows.any(|(distance, settled)| !(settled.get() >= 0.0 || distance.get().is_nan()))
    }

    /// The distance of each row; NaN where it did not settle.
    pub(super) fn found(self, reached: &Reading<'a>) -> &'a [f64] {
        let State { distance, settled } = self.state;
        for (distance, settled) in distance.cells().iter().zip(settled.cells()) {
            let settled = settled.get() >= 0.0;
            distance.set(if settled { distance.get() } else { f64::NAN });
        }
        reached.numbers(LineRef::shared(distance))
    }
}

struct Guess<'a> {
    newton: Newton<'a>,
    speed: Option<LineRef<'a>>,
}

impl Work for Guess<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let Newton { target, state, .. } = self.newton;
        // SAFETY: the caller's.
        unsafe {
            let speed: V = match self.speed {
                None => V::constant(SOME_SPEED),
                Some(speed) => speed.load(row),
            };
            let guess = echo::distance(target.load(row), speed);
            store(guess, state.distance.cell(), row);
        }
    }
}

#[derive(Clone, Copy)]
struct Step<'a> {
    newton: Newton<'a>,
    present: LineRef<'a>,
    reached: (LineRef<'a>, LineRef<'a>),
}

impl Step<'_> {
    /// What is to be reached, what is reached, and where.
    ///
    /// # Safety
    /// The block has rows `row..row + V::WIDTH`.
    #[inline(always)]
    unsafe fn load<V: Vector<Element = f64>>(&self, row: usize) -> (V, Dual<1, V>, V) {
        // SAFETY: the caller's.
        unsafe {
            let reached = Dual {
                value: self.reached.0.load(row),
                derivatives: [self.reached.1.load(row)],
            };
            (
                self.newton.target.load(row),
                reached,
                self.present.load(row),
            )
        }
    }
}

struct Arrive<'a>(Step<'a>);

impl Work for Arrive<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's.
        unsafe {
            let (target, reached, present) = self.0.load::<V>(row);
            let found = arrive(target, reached, present);
            store(found, self.0.newton.state.distance.cell(), row);
        }
    }
}

struct Approach<'a> {
    step: Step<'a>,
    first: bool,
}

impl Work for Approach<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let State { distance, settled } = self.step.newton.state;
        // SAFETY: the caller's.
        unsafe {
            let (target, reached, present) = self.step.load::<V>(row);
            let before = if self.first {
                V::constant(-1.0)
            } else {
                LineRef::shared(settled).load(row)
            };
            let (next, done) = approach(target, reached, present, before);
            store(next, distance.cell(), row);
            store(done, settled.cell(), row);
        }
    }
}
