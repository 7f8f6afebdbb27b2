//! Where the variables of the chain lie while a block of rows passes it.

use crate::air::Air;
use crate::chain::{Chain, Stage};
use crate::conditions::{Conditions, Quantity};
use crate::dual::Dual;
use crate::effects::Facts;
use crate::simd::Vector;
use core::cell::Cell;
use core::marker::PhantomData;
use core::ops::Range;
use core::slice::from_raw_parts;

/// Rows at once: a multiple of every vector width; what is in use of a block stays near.
pub const BLOCK: usize = 240;

/// One number per row of a block.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Line(pub [f64; BLOCK]);

impl Line {
    /// The same number in every row.
    pub const fn of(value: f64) -> Self {
        Self([value; BLOCK])
    }
}

static ZEROS: Line = Line::of(0.0);
static ONES: Line = Line::of(1.0);

/// Memory for one number per row that is read and written by turns, through shared references.
#[repr(align(64))]
pub(super) struct SharedLine(Cell<[f64; BLOCK]>);

impl SharedLine {
    /// The same number in every row.
    pub(super) const fn of(value: f64) -> Self {
        Self(Cell::new([value; BLOCK]))
    }

    /// The memory.
    pub(super) fn cell(&self) -> &Cell<[f64; BLOCK]> {
        &self.0
    }

    /// The rows one by one.
    pub(super) fn cells(&self) -> &[Cell<f64>] {
        let all: &Cell<[f64]> = &self.0;
        all.as_slice_of_cells()
    }
}

/// A variable of the chain with its derivative.
pub(super) struct Track {
    pub(super) value: SharedLine,
    pub(super) slope: SharedLine,
}

impl Track {
    pub(super) const fn new() -> Self {
        Self {
            value: SharedLine::of(0.0),
            slope: SharedLine::of(0.0),
        }
    }
}

/// Where one number per row of a block is read.
///
/// The memory lives as long as `'a`, which the compiler checks. It is a constant line, rows of a column, or
/// a [`SharedLine`], which may be written between two readings.
#[derive(Clone, Copy)]
pub(super) struct LineRef<'a> {
    start: *const f64,
    memory: PhantomData<&'a Cell<[f64; BLOCK]>>,
}

impl<'a> LineRef<'a> {
    /// A line that nobody writes to.
    pub(super) fn fixed(line: &'a Line) -> Self {
        // SAFETY: a line has a block of rows and is borrowed for `'a`.
        unsafe { Self::new(line.0.as_ptr()) }
    }

    /// A line that may be written to between two readings.
    pub(super) fn shared(line: &'a SharedLine) -> Self {
        // SAFETY: as above.
        unsafe { Self::new(line.cell().as_ptr().cast()) }
    }

    /// Numbers side by side.
    ///
    /// # Safety
    /// The rows of every block that is read from here are valid for reading during `'a`.
    pub(super) unsafe fn new(start: *const f64) -> Self {
        Self {
            start,
            memory: PhantomData,
        }
    }

    /// Some rows.
    ///
    /// # Safety
    /// There are rows `row..row + V::WIDTH`.
    #[inline(always)]
    pub(super) unsafe fn load<V: Vector<Element = f64>>(self, row: usize) -> V {
        // SAFETY: the caller's.
        unsafe { V::load(self.start.add(row)) }
    }
}

/// The quantities that describe the air.
pub(super) const AIR: [Quantity; 4] = [
    Quantity::Temperature,
    Quantity::RelativeHumidity,
    Quantity::Pressure,
    Quantity::Co2MoleFraction,
];

/// How many variables there are; each stage that changes the time has its own.
pub(crate) const TRACKS: usize = 11;

/// The variables that a stage changes.
pub(crate) const fn tracks_of(stage: Stage) -> Range<usize> {
    match stage {
        Stage::Air => 0..4,
        Stage::Speed => 4..5,
        Stage::Path => 5..6,
        Stage::Flight => 6..7,
        Stage::Transducer => 7..8,
        Stage::Timer => 8..9,
        Stage::Firmware => 9..10,
        Stage::Indication => 10..11,
    }
}

/// Which of its stage's variables an effect changes: the others are read on from where they are.
pub(super) const fn changed(facts: &Facts) -> [bool; AIR.len()] {
    let mut changed = [true; AIR.len()];
    let mut track = 0;
    while matches!(facts.stage, Stage::Air) && track < AIR.len() {
        changed[track] = false;
        let mut index = 0;
        while index < facts.air.len() {
            changed[track] |= facts.air[index] as usize == AIR[track] as usize;
            index += 1;
        }
        track += 1;
    }
    changed
}

/// Where each number of a block is read: recorded quantities, the distance, and the variables.
///
/// What it reads lives as long as `'a`. A reading that a [`Pass`](super::Pass) made holds the pass
/// borrowed, so that nothing writes to the variables while it is in use.
#[derive(Clone, Copy)]
pub(crate) struct Reading<'a> {
    recorded: [LineRef<'a>; Quantity::COUNT],
    /// The distance with its derivative.
    pub(super) distance: [LineRef<'a>; 2],
    value: [LineRef<'a>; TRACKS],
    slope: [LineRef<'a>; TRACKS],
    /// The speed of sound in the recorded air, where it was needed before.
    pub(super) recorded_speed: Option<LineRef<'a>>,
    /// Whether derivatives are those to the distance.
    varies: bool,
    /// Rows, rounded up to whole vectors, at most a block: what follows the last row may be read.
    rows: usize,
}

impl<'a> Reading<'a> {
    /// Rows with no derivative yet; every variable is what stands for the distance.
    pub(super) fn new(
        distance: LineRef<'a>,
        recorded: [LineRef<'a>; Quantity::COUNT],
        rows: usize,
    ) -> Self {
        Self {
            recorded,
            distance: [distance, LineRef::fixed(&ZEROS)],
            value: [distance; TRACKS],
            slope: [LineRef::fixed(&ZEROS); TRACKS],
            recorded_speed: None,
            varies: false,
            rows,
        }
    }

    /// Rows, rounded up to whole vectors.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// The same block with derivatives to the distance (`true`) or to something else.
    pub(crate) fn to_distance(mut self, yes: bool) -> Self {
        self.varies = yes;
        self.distance[1] = LineRef::fixed(if yes { &ONES } else { &ZEROS });
        self.slope = [LineRef::fixed(&ZEROS); TRACKS];
        self
    }

    /// The same block with derivatives to one variable.
    pub(super) fn seeded(mut self, track: usize) -> Self {
        self.slope[track] = LineRef::fixed(&ONES);
        self
    }

    /// The same block at other distances.
    pub(crate) fn at(self, distance: &'a Line) -> Self {
        self.at_line(LineRef::fixed(distance))
    }

    /// The same block at distances that may change between two readings.
    pub(super) fn at_line(mut self, distance: LineRef<'a>) -> Self {
        self.distance[0] = distance;
        self
    }

    /// Values and derivatives of the last stage up to and with this one that changed a variable.
    pub(super) fn of(&self, stage: Stage) -> (LineRef<'a>, LineRef<'a>) {
        let track = tracks_of(stage).start;
        (self.value[track], self.slope[track])
    }

    /// The rows of a line.
    pub(super) fn numbers(&self, line: LineRef<'a>) -> &'a [f64] {
        // SAFETY: the line has the rows of the block. While a reading, or what it lent, is in use outside of
        // this module, nothing writes to them; see above.
        unsafe { from_raw_parts(line.start, self.rows) }
    }

    /// Derivatives of a variable.
    pub(crate) fn slope(&self, track: usize) -> &'a [f64] {
        self.numbers(self.slope[track])
    }

    /// The values of a stage's variable.
    pub(crate) fn values(&self, stage: Stage) -> &'a [f64] {
        self.numbers(self.of(stage).0)
    }

    /// Copies the derivatives of a stage's variable.
    pub(crate) fn slopes(&self, stage: Stage, into: &mut Line) {
        into.0[..self.rows].copy_from_slice(self.numbers(self.of(stage).1));
    }

    /// Whether derivatives are those to the distance.
    pub(super) fn varies(&self) -> bool {
        self.varies
    }

    /// A variable is read from here on; `still`: its derivatives are zero, and were not written.
    pub(super) fn place(&mut self, track: usize, from: &'a Track, still: bool) {
        let value = LineRef::shared(&from.value);
        if still {
            self.place_still(track, value);
        } else {
            self.copy(track, (value, LineRef::shared(&from.slope)));
        }
    }

    /// A variable is read here from now on, and has no derivative.
    pub(super) fn place_still(&mut self, track: usize, value: LineRef<'a>) {
        self.copy(track, (value, LineRef::fixed(&ZEROS)));
    }

    /// The air on the path: temperature, relative humidity, pressure, CO2 mole fraction.
    pub(super) fn air(&self) -> [LineRef<'a>; 4] {
        [self.value[0], self.value[1], self.value[2], self.value[3]]
    }

    /// The air as recorded.
    pub(super) fn recorded_air(&self) -> [LineRef<'a>; 4] {
        AIR.map(|quantity| self.recorded[quantity as usize])
    }

    /// Variables are what was recorded, or what other variables are.
    pub(super) fn copy(&mut self, track: usize, (value, slope): (LineRef<'a>, LineRef<'a>)) {
        self.value[track] = value;
        self.slope[track] = slope;
    }

    /// A recorded quantity, which depends on nothing.
    pub(super) fn constant(&self, quantity: Quantity) -> (LineRef<'a>, LineRef<'a>) {
        (self.recorded[quantity as usize], LineRef::fixed(&ZEROS))
    }

    /// Some rows as an effect of a stage finds them.
    ///
    /// # Safety
    /// The block has rows `row..row + V::WIDTH`.
    #[inline(always)]
    pub(super) unsafe fn chain<const N: usize, V: Vector<Element = f64>>(
        &self,
        stage: Stage,
        row: usize,
    ) -> Chain<Dual<N, V>> {
        let mut values = [Dual::fixed(V::constant(0.0)); Quantity::COUNT];
        let time = match stage {
            Stage::Transducer => 7,
            Stage::Timer | Stage::Firmware | Stage::Indication => 8,
            _ => 6,
        };
        // SAFETY: the caller's, for every line.
        unsafe {
            for (value, recorded) in values.iter_mut().zip(self.recorded) {
                *value = Dual::fixed(recorded.load(row));
            }
            Chain {
                recorded: Conditions::new(values),
                distance: dual(self.distance[0], self.distance[1], row),
                air: Air {
                    temperature: dual(self.value[0], self.slope[0], row),
                    relative_humidity: dual(self.value[1], self.slope[1], row),
                    pressure: dual(self.value[2], self.slope[2], row),
                    co2_mole_fraction: dual(self.value[3], self.slope[3], row),
                },
                speed: dual(self.value[4], self.slope[4], row),
                path: dual(self.value[5], self.slope[5], row),
                time: dual(self.value[time], self.slope[time], row),
                firmware_speed: dual(self.value[9], self.slope[9], row),
                indication: dual(self.value[10], self.slope[10], row),
            }
        }
    }
}

/// Values, and derivatives where any are wanted, of some rows; no closure, which would not inherit the instruction set.
///
/// # Safety
/// Both lines have rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn dual<const N: usize, V: Vector<Element = f64>>(
    value: LineRef<'_>,
    slope: LineRef<'_>,
    row: usize,
) -> Dual<N, V> {
    // SAFETY: the caller's.
    unsafe {
        let mut dual = Dual::fixed(value.load(row));
        for derivative in &mut dual.derivatives {
            *derivative = slope.load(row);
        }
        dual
    }
}
