//! What is done to the rows of a block, one function for each effect and stage.

use super::tracks::{Line, Reading, Track, tracks_of};
use crate::air::{Air, Law};
use crate::chain::{Chain, Stage};
use crate::dual::Dual;
use crate::echo;
use crate::effects::{Effect, Visitor};
use crate::model::{approach, enter as entered};
#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F64x4, F64x8};
use crate::simd::{InstructionSet, Vector, active};

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
/// `target` holds as many tracks as the stage has variables, `row..row + V::WIDTH` long.
#[inline(always)]
unsafe fn keep<V: Vector<Element = f64>>(
    stage: Stage,
    chain: &Chain<Dual<1, V>>,
    target: *mut Track,
    row: usize,
) {
    // SAFETY: the caller's.
    unsafe {
        match stage {
            Stage::Air => {
                put(chain.air.temperature, target, row);
                put(chain.air.relative_humidity, target.add(1), row);
                put(chain.air.pressure, target.add(2), row);
                put(chain.air.co2_mole_fraction, target.add(3), row);
            }
            Stage::Speed => put(chain.speed, target, row),
            Stage::Path => put(chain.path, target, row),
            Stage::Flight | Stage::Transducer | Stage::Timer => put(chain.time, target, row),
            Stage::Firmware => put(chain.firmware_speed, target, row),
            Stage::Indication => put(chain.indication, target, row),
        }
    }
}

/// Writes values and derivatives of some rows.
///
/// # Safety
/// The track has rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn put<V: Vector<Element = f64>>(dual: Dual<1, V>, track: *mut Track, row: usize) {
    // SAFETY: the caller's.
    unsafe {
        dual.value
            .store((&raw mut (*track).value).cast::<f64>().add(row));
        dual.derivatives[0].store((&raw mut (*track).slope).cast::<f64>().add(row));
    }
}

/// An effect with its parameters, the derivative to one of which is wanted.
pub(super) struct Apply<'a> {
    pub reading: &'a Reading,
    pub parameters: &'a [f64],
    pub seed: Option<usize>,
    pub target: *mut Track,
    /// What the effect prepared for this block, see [`Prepare`].
    pub prepared: Option<*const f64>,
}

impl Visitor for Apply<'_> {
    type Output = ();

    fn visit<E: Effect>(self) {
        let rows = self.reading.rows;
        let work = Applied::<E>(self, core::marker::PhantomData);
        // SAFETY: a reading has its rows, and a track a block of them.
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
                    let prepared = Dual::fixed(V::load(prepared.add(row)));
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
    pub reading: &'a Reading,
    pub target: *mut f64,
}

impl Visitor for Prepare<'_> {
    type Output = bool;

    fn visit<E: Effect>(self) -> bool {
        if E::PREPARES {
            let rows = self.reading.rows;
            let work = Prepared::<E>(self, core::marker::PhantomData);
            // SAFETY: a reading has its rows, and the target is a line.
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
            E::prepare(&chain).value.store(self.0.target.add(row));
        }
    }
}

/// What a stage does without any effect; stages that do nothing are not asked to.
pub(super) fn enter(law: Law, stage: Stage, reading: &mut Reading, target: *mut Track) {
    let rows = reading.rows;
    // SAFETY: a reading has its rows, and a track a block of them.
    unsafe {
        match stage {
            Stage::Speed => each(
                &Entered::<{ Stage::Speed as usize }> {
                    law,
                    reading,
                    target,
                },
                rows,
            ),
            Stage::Flight => each(
                &Entered::<{ Stage::Flight as usize }> {
                    law,
                    reading,
                    target,
                },
                rows,
            ),
            Stage::Firmware => each(
                &Entered::<{ Stage::Firmware as usize }> {
                    law,
                    reading,
                    target,
                },
                rows,
            ),
            Stage::Indication => each(
                &Entered::<{ Stage::Indication as usize }> {
                    law,
                    reading,
                    target,
                },
                rows,
            ),
            Stage::Air | Stage::Path | Stage::Transducer | Stage::Timer => return,
        }
    }
    reading.place(tracks_of(stage).start, target);
}

struct Entered<'a, const STAGE: usize> {
    law: Law,
    reading: &'a Reading,
    target: *mut Track,
}

impl<const STAGE: usize> Work for Entered<'_, STAGE> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let stage = const { Stage::ALL[STAGE] };
        // SAFETY: the caller's.
        unsafe {
            let mut chain = self.reading.chain::<V>(stage, row);
            entered(self.law, stage, &mut chain);
            keep(stage, &chain, self.target, row);
        }
    }
}

/// The state of Newton's method over a block.
pub(crate) struct Newton {
    target: *const f64,
    pub(crate) distance: Line,
    settled: Line,
}

impl Newton {
    /// Starts at the values of a block, or, where these are times, at the distances that a law
    /// gives them in the recorded air.
    pub(crate) fn new(block: &Reading, law: Option<Law>) -> Self {
        let [target, _] = block.distance;
        let mut newton = Self {
            target,
            distance: Line::of(0.0),
            settled: Line::of(-1.0),
        };
        let guess = Guess {
            block,
            law,
            into: (&raw mut newton.distance).cast(),
        };
        // SAFETY: a reading has its rows, and a line a block of them.
        unsafe { each(&guess, block.rows) };
        newton
    }

    /// The distance of each row; NaN where it did not settle.
    pub(crate) fn found(&self, into: &mut Line) {
        let rows = self.distance.0.iter().zip(&self.settled.0);
        for (found, (&distance, &settled)) in into.0.iter_mut().zip(rows) {
            *found = if settled >= 0.0 { distance } else { f64::NAN };
        }
    }
}

struct Guess<'a> {
    block: &'a Reading,
    law: Option<Law>,
    into: *mut f64,
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
            guess.value.store(self.into.add(row));
        }
    }
}

struct Step {
    newton: *mut Newton,
    target: *const f64,
    reached: (*const f64, *const f64),
}

impl Work for Step {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's; the lines are those of `settle`'s own borrow.
        unsafe {
            let reached = Dual {
                value: V::load(self.reached.0.add(row)),
                derivatives: [V::load(self.reached.1.add(row))],
            };
            let distance = (&raw mut (*self.newton).distance).cast::<f64>().add(row);
            let settled = (&raw mut (*self.newton).settled).cast::<f64>().add(row);
            let target = V::load(self.target.add(row));
            let (next, done) = approach(target, reached, V::load(distance), V::load(settled));
            next.store(distance);
            done.store(settled);
        }
    }
}

/// One step for every row, given what the present distances reach; whether all have settled.
pub(crate) fn settle(newton: &mut Newton, reached: (*const f64, *const f64), rows: usize) -> bool {
    let step = Step {
        target: newton.target,
        newton,
        reached,
    };
    // SAFETY: the lines have a block of rows, and so has what was reached.
    unsafe { each(&step, rows) };
    newton.settled.0[..rows]
        .iter()
        .all(|&settled| settled >= 0.0)
}
