//! What is done to the rows of a block, one function for each effect and stage.

use super::tracks::{BLOCK, Line, LineRef, Reading, SharedLine, Track};
use crate::air::{Air, Law};
use crate::chain::{Chain, Stage};
use crate::dual::Dual;
use crate::echo;
use crate::effects::{Effect, Visitor};
use crate::model::{approach, enter as entered};
#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F64x4, F64x8};
use crate::simd::{InstructionSet, Vector, active};
use core::cell::Cell;

/// Something done to every row of a block, several at a time.
pub(super) trait Work {
    /// Does it to rows `row..row + V::WIDTH`.
    ///
    /// # Safety
    /// The block has these rows, and what the work writes to is as long.
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize);
}

/// Does a work to all rows, with the widest registers.
///
/// # Safety
/// As for [`Work::at`], for `rows` rounded up to whole vectors.
#[inline(always)]
pub(super) unsafe fn each<W: Work>(work: &W, rows: usize) {
    match active() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the instruction set is available; the rest the caller guarantees.
        InstructionSet::Avx512 => unsafe { each_avx512(work, rows) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { each_avx2(work, rows) },
        // SAFETY: the caller's.
        _ => unsafe { all::<f64, W>(work, rows) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
unsafe fn each_avx512<W: Work>(work: &W, rows: usize) {
    // SAFETY: the caller's.
    unsafe { all::<F64x8, W>(work, rows) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn each_avx2<W: Work>(work: &W, rows: usize) {
    // SAFETY: the caller's.
    unsafe { all::<F64x4, W>(work, rows) }
}

#[inline(always)]
unsafe fn all<V: Vector<Element = f64>, W: Work>(work: &W, rows: usize) {
    for row in (0..rows).step_by(V::WIDTH) {
        // SAFETY: the caller's.
        unsafe { work.at::<V>(row) };
    }
}

/// Writes the variables of a stage.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
///
/// # Panics
/// If `target` is not as many tracks as the stage has variables.
#[inline(always)]
unsafe fn keep<V: Vector<Element = f64>>(
    stage: Stage,
    chain: &Chain<Dual<1, V>>,
    target: &[Track],
    row: usize,
) {
    // SAFETY: the caller's.
    unsafe {
        match stage {
            Stage::Air => {
                put(chain.air.temperature, &target[0], row);
                put(chain.air.relative_humidity, &target[1], row);
                put(chain.air.pressure, &target[2], row);
                put(chain.air.co2_mole_fraction, &target[3], row);
            }
            Stage::Speed => put(chain.speed, &target[0], row),
            Stage::Path => put(chain.path, &target[0], row),
            Stage::Flight | Stage::Transducer | Stage::Timer => put(chain.time, &target[0], row),
            Stage::Firmware => put(chain.firmware_speed, &target[0], row),
            Stage::Indication => put(chain.indication, &target[0], row),
        }
    }
}

/// Writes values and derivatives of some rows.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn put<V: Vector<Element = f64>>(dual: Dual<1, V>, track: &Track, row: usize) {
    // SAFETY: the caller's.
    unsafe {
        store(dual.value, track.value.cell(), row);
        store(dual.derivatives[0], track.slope.cell(), row);
    }
}

/// Writes some rows of a line.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn store<V: Vector<Element = f64>>(rows: V, line: &Cell<[f64; BLOCK]>, row: usize) {
    // SAFETY: the caller's; a cell may be written to through a shared reference.
    unsafe { rows.store(line.as_ptr().cast::<f64>().add(row)) };
}

/// An effect with its parameters, the derivative to one of which is wanted.
pub(super) struct Apply<'a> {
    pub reading: &'a Reading<'a>,
    pub parameters: &'a [f64],
    pub seed: Option<usize>,
    /// As many tracks as the effect's stage has variables.
    pub target: &'a [Track],
    /// What the effect prepared for this block, see [`Prepare`].
    pub prepared: Option<&'a Line>,
}

impl Visitor for Apply<'_> {
    type Output = ();

    fn visit<E: Effect>(self) {
        let rows = self.reading.rows();
        let work = Applied::<E>(self, core::marker::PhantomData);
        // SAFETY: a reading has its rows, at most a block, and so have the tracks.
        unsafe { each(&work, rows) }
    }
}

struct Applied<'a, E>(Apply<'a>, core::marker::PhantomData<E>);

/// The most parameters that an effect has.
pub(super) const MOST: usize = 4;

impl<E: Effect> Work for Applied<'_, E> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        const { assert!(E::FACTS.parameters.len() <= MOST) };
        let Apply {
            reading,
            parameters,
            seed,
            target,
            prepared,
        } = self.0;
        let mut own = [Dual::fixed(V::constant(0.0)); MOST];
        #[allow(clippy::needless_range_loop)] // the length is a constant
        for i in 0..E::FACTS.parameters.len() {
            let slope = if seed == Some(i) { 1.0 } else { 0.0 };
            own[i].value = V::constant(parameters[i]);
            own[i].derivatives[0] = V::constant(slope);
        }
        // SAFETY: the caller's.
        unsafe {
            let mut chain = reading.chain::<V>(E::FACTS.stage, row);
            let own = &own[..E::FACTS.parameters.len()];
            match prepared {
                Some(prepared) if E::PREPARES => {
                    let prepared = Dual::fixed(LineRef::fixed(prepared).load(row));
                    E::apply_prepared(&mut chain, own, prepared);
                }
                _ => E::apply(&mut chain, own),
            }
            keep(E::FACTS.stage, &chain, target, row);
        }
    }
}

/// What an effect can prepare for a block whatever its parameters are; whether that is anything.
pub(super) struct Prepare<'a> {
    pub reading: &'a Reading<'a>,
    pub target: &'a Cell<[f64; BLOCK]>,
}

impl Visitor for Prepare<'_> {
    type Output = bool;

    fn visit<E: Effect>(self) -> bool {
        if E::PREPARES {
            let rows = self.reading.rows();
            let work = Prepared::<E>(self, core::marker::PhantomData);
            // SAFETY: a reading has its rows, at most a block, and so has the target.
            unsafe { each(&work, rows) }
        }
        E::PREPARES
    }
}

struct Prepared<'a, E>(Prepare<'a>, core::marker::PhantomData<E>);

impl<E: Effect> Work for Prepared<'_, E> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's.
        unsafe {
            let chain = self.0.reading.chain::<V>(E::FACTS.stage, row);
            store(E::prepare(&chain).value, self.0.target, row);
        }
    }
}

/// What a stage does without any effect, where it does anything; whether it does.
pub(super) fn enter(law: Law, stage: Stage, reading: &Reading<'_>, target: &Track) -> bool {
    const SPEED: usize = Stage::Speed as usize;
    const FLIGHT: usize = Stage::Flight as usize;
    const FIRMWARE: usize = Stage::Firmware as usize;
    const INDICATION: usize = Stage::Indication as usize;
    match stage {
        Stage::Speed => Entered::<SPEED>::run(law, reading, target),
        Stage::Flight => Entered::<FLIGHT>::run(law, reading, target),
        Stage::Firmware => Entered::<FIRMWARE>::run(law, reading, target),
        Stage::Indication => Entered::<INDICATION>::run(law, reading, target),
        Stage::Air | Stage::Path | Stage::Transducer | Stage::Timer => return false,
    }
    true
}

struct Entered<'a, const STAGE: usize> {
    law: Law,
    reading: &'a Reading<'a>,
    target: &'a Track,
}

impl<'a, const STAGE: usize> Entered<'a, STAGE> {
    fn run(law: Law, reading: &'a Reading<'a>, target: &'a Track) {
        let work = Self {
            law,
            reading,
            target,
        };
        // SAFETY: a reading has its rows, at most a block, and so has the track.
        unsafe { each(&work, reading.rows()) }
    }
}

impl<const STAGE: usize> Work for Entered<'_, STAGE> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let stage = const { Stage::ALL[STAGE] };
        // SAFETY: the caller's.
        unsafe {
            let mut chain = self.reading.chain::<V>(stage, row);
            entered(self.law, stage, &mut chain);
            keep(stage, &chain, core::slice::from_ref(self.target), row);
        }
    }
}

/// The state of Newton's method over a block.
pub(super) struct Newton<'a> {
    target: LineRef<'a>,
    distance: SharedLine,
    settled: SharedLine,
}

impl<'a> Newton<'a> {
    /// Starts at the values of a block, or, where these are times, at the distances that a law
    /// gives them in the recorded air.
    pub(super) fn new(block: &Reading<'a>, law: Option<Law>) -> Self {
        let [target, _] = block.distance;
        let newton = Self {
            target,
            distance: SharedLine::of(0.0),
            settled: SharedLine::of(-1.0),
        };
        let guess = Guess {
            block,
            law,
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
    block: &'a Reading<'a>,
    law: Option<Law>,
    into: &'a Cell<[f64; BLOCK]>,
}

impl Work for Guess<'_> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's.
        unsafe {
            let given = self.block.chain::<V>(Stage::Air, row);
            let guess = match self.law {
                None => given.distance,
                Some(law) => {
                    let speed = law.speed(&Air::recorded(&given.recorded));
                    echo::distance(given.distance, speed)
                }
            };
            store(guess.value, self.into, row);
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
