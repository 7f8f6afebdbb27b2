//! What is done to the rows of a block, one function for each effect and stage.

use super::tracks::{AIR, BLOCK, Line, LineRef, Reading, Track, changed};
use crate::air::{Air, Law, LawOfRows, LawVisitor, SpeedLaw};
use crate::chain::{Chain, Stage};
use crate::dual::Dual;
use crate::effects::{Effect, Visitor};
use crate::model::enter as entered;
#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F64x4, F64x8};
use crate::simd::{InstructionSet, Lanes, Vector, active};
use core::cell::Cell;
use core::marker::PhantomData;

/// Something done to every row of a block, several at a time.
pub(super) trait Work {
    /// Whether it is long, so that several vectors in flight are faster than one.
    const LONG: bool = false;

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
    const IN_FLIGHT: usize = 3; // as in `block`
    let together = IN_FLIGHT * V::WIDTH;
    let mut long = 0;
    // a condition known to the compiler: what is not long is compiled for one vector alone
    if W::LONG {
        long = rows / together * together;
        for row in (0..long).step_by(together) {
            // SAFETY: the caller's.
            unsafe { work.at::<Lanes<V, IN_FLIGHT>>(row) };
        }
    }
    for row in (long..rows).step_by(V::WIDTH) {
        // SAFETY: the caller's.
        unsafe { work.at::<V>(row) };
    }
}

/// Writes the variables of a stage that are `changed`.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
///
/// # Panics
/// If `target` is not as many tracks as the stage has variables.
#[inline(always)]
unsafe fn keep<const N: usize, V: Vector<Element = f64>>(
    stage: Stage,
    changed: [bool; AIR.len()],
    chain: &Chain<Dual<N, V>>,
    target: &[Track],
    row: usize,
) {
    let air = &chain.air;
    let only = match stage {
        Stage::Air => {
            let variables = [
                air.temperature,
                air.relative_humidity,
                air.pressure,
                air.co2_mole_fraction,
            ];
            for (track, variable) in variables.into_iter().enumerate() {
                if changed[track] {
                    // SAFETY: the caller's.
                    unsafe { put(variable, &target[track], row) };
                }
            }
            return;
        }
        Stage::Speed => chain.speed,
        Stage::Path => chain.path,
        Stage::Flight | Stage::Transducer | Stage::Timer => chain.time,
        Stage::Firmware => chain.firmware_speed,
        Stage::Indication => chain.indication,
    };
    // SAFETY: the caller's.
    unsafe { put(only, &target[0], row) };
}

/// Writes values, and derivatives where there are any, of some rows.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn put<const N: usize, V: Vector<Element = f64>>(
    dual: Dual<N, V>,
    track: &Track,
    row: usize,
) {
    // SAFETY: the caller's.
    unsafe {
        store(dual.value, track.value.cell(), row);
        for derivative in dual.derivatives {
            store(derivative, track.slope.cell(), row);
        }
    }
}

/// Writes some rows of a line.
///
/// # Safety
/// A block has rows `row..row + V::WIDTH`.
#[inline(always)]
pub(super) unsafe fn store<V: Vector<Element = f64>>(
    rows: V,
    line: &Cell<[f64; BLOCK]>,
    row: usize,
) {
    // SAFETY: the caller's; a cell may be written to through a shared reference.
    unsafe { rows.store(line.as_ptr().cast::<f64>().add(row)) };
}

/// An effect with its parameters, the derivative to one of which is wanted.
pub(super) struct Apply<'a> {
    pub reading: &'a Reading<'a>,
    pub parameters: &'a [f64],
    pub seed: Option<usize>,
    /// Whether no derivative is wanted: all are zero.
    pub still: bool,
    /// As many tracks as the effect's stage has variables.
    pub target: &'a [Track],
    /// What the effect prepared for this block, see [`Prepare`].
    pub prepared: Option<&'a Line>,
}

impl Visitor for Apply<'_> {
    /// Which variables of the stage were changed.
    type Output = [bool; AIR.len()];

    fn visit<E: Effect>(self) -> Self::Output {
        let rows = self.reading.rows();
        let own = core::array::from_fn(|i| self.parameters.get(i).copied().unwrap_or(0.0));
        // SAFETY: a reading has its rows, at most a block, and so have the tracks.
        unsafe {
            if self.still {
                each(&Applied::<E, 0>(own, self, PhantomData), rows);
            } else {
                each(&Applied::<E, 1>(own, self, PhantomData), rows);
            }
        }
        const { changed(&E::FACTS) }
    }
}

/// With so many derivatives, and with the parameters in a memory that nothing else writes to: what depends on
/// them alone the compiler then computes once for all rows.
struct Applied<'a, E, const N: usize>([f64; MOST], Apply<'a>, PhantomData<E>);

/// The most parameters that an effect has.
pub(super) const MOST: usize = 4;

impl<E: Effect, const N: usize> Work for Applied<'_, E, N> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        const { assert!(E::FACTS.parameters.len() <= MOST) };
        let Self(parameters, call, _) = self;
        let &Apply {
            reading,
            seed,
            target,
            prepared,
            ..
        } = call;
        let mut own = [Dual::fixed(V::constant(0.0)); MOST];
        #[allow(clippy::needless_range_loop)] // the length is a constant
        for i in 0..E::FACTS.parameters.len() {
            let slope = if seed == Some(i) { 1.0 } else { 0.0 };
            own[i].value = V::constant(parameters[i]);
            own[i].derivatives = [V::constant(slope); N];
        }
        // SAFETY: the caller's.
        unsafe {
            let mut chain = reading.chain::<N, V>(E::FACTS.stage, row);
            let own = &own[..E::FACTS.parameters.len()];
            match prepared {
                Some(prepared) if E::PREPARES => {
                    let prepared = Dual::fixed(LineRef::fixed(prepared).load(row));
                    E::apply_prepared(&mut chain, own, prepared);
                }
                _ => E::apply(&mut chain, own),
            }
            let changed = const { changed(&E::FACTS) };
            keep(E::FACTS.stage, changed, &chain, target, row);
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
            let work = Prepared::<E>(self, PhantomData);
            // SAFETY: a reading has its rows, at most a block, and so has the target.
            unsafe { each(&work, rows) }
        }
        E::PREPARES
    }
}

struct Prepared<'a, E>(Prepare<'a>, PhantomData<E>);

impl<E: Effect> Work for Prepared<'_, E> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        // SAFETY: the caller's.
        unsafe {
            let chain = self.0.reading.chain::<0, V>(E::FACTS.stage, row);
            store(E::prepare(&chain).value, self.0.target, row);
        }
    }
}

/// What a stage does without any effect; `still`: no derivative is wanted.
pub(super) fn enter(law: Law, stage: Stage, reading: &Reading<'_>, target: &Track, still: bool) {
    const SPEED: usize = Stage::Speed as usize;
    const FLIGHT: usize = Stage::Flight as usize;
    const INDICATION: usize = Stage::Indication as usize;
    match (stage, still) {
        (Stage::Speed, true) => speed(law, reading.air(), reading, target.value.cell()),
        (Stage::Speed, false) => Entered::<SPEED, 1>::run(law, reading, target),
        (Stage::Flight, true) => Entered::<FLIGHT, 0>::run(law, reading, target),
        (Stage::Flight, false) => Entered::<FLIGHT, 1>::run(law, reading, target),
        (Stage::Indication, true) => Entered::<INDICATION, 0>::run(law, reading, target),
        (Stage::Indication, false) => Entered::<INDICATION, 1>::run(law, reading, target),
        _ => unreachable!("{} computes nothing of its own", stage.name()),
    }
}

struct Entered<'a, const STAGE: usize, const N: usize> {
    law: Law,
    reading: &'a Reading<'a>,
    target: &'a Track,
}

impl<'a, const STAGE: usize, const N: usize> Entered<'a, STAGE, N> {
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

impl<const STAGE: usize, const N: usize> Work for Entered<'_, STAGE, N> {
    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let stage = const { Stage::ALL[STAGE] };
        // SAFETY: the caller's.
        unsafe {
            let mut chain = self.reading.chain::<N, V>(stage, row);
            entered(self.law, stage, &mut chain);
            let target = core::slice::from_ref(self.target);
            keep(stage, [true; AIR.len()], &chain, target, row);
        }
    }
}

/// The speed of sound in some air, as the stages of the speed and of the firmware begin with it.
pub(super) fn speed(
    law: Law,
    air: [LineRef<'_>; 4],
    reading: &Reading<'_>,
    into: &Cell<[f64; BLOCK]>,
) {
    let rows = reading.rows();
    law.visit(SpeedIn { air, rows, into });
}

struct SpeedIn<'a> {
    air: [LineRef<'a>; 4],
    rows: usize,
    into: &'a Cell<[f64; BLOCK]>,
}

impl LawVisitor for SpeedIn<'_> {
    type Output = ();

    fn visit<L: SpeedLaw + 'static>(self, law: L) {
        let rows = self.rows;
        // SAFETY: the lines are those of a reading with these rows, at most a block.
        unsafe { each(&SpeedBy(law, self), rows) }
    }
}

struct SpeedBy<'a, L>(L, SpeedIn<'a>);

impl<L: LawOfRows> Work for SpeedBy<'_, L> {
    const LONG: bool = true;

    #[inline(always)]
    unsafe fn at<V: Vector<Element = f64>>(&self, row: usize) {
        let Self(law, SpeedIn { air, into, .. }) = self;
        // SAFETY: the caller's.
        unsafe {
            let air = Air {
                temperature: air[0].load::<V>(row),
                relative_humidity: air[1].load(row),
                pressure: air[2].load(row),
                co2_mole_fraction: air[3].load(row),
            };
            store(law.speed_of_rows(&air), into, row);
        }
    }
}
