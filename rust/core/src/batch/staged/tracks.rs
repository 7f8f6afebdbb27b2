//! Where the variables of the chain lie while a block of rows passes it.

use crate::air::Air;
use crate::batch::Column;
use crate::chain::{Chain, Stage};
use crate::conditions::{Conditions, Quantity};
use crate::dual::Dual;
use crate::simd::Vector;
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

/// A variable of the chain with its derivative.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Track {
    pub value: Line,
    pub slope: Line,
}

impl Track {
    pub const NEW: Self = Self {
        value: Line::of(0.0),
        slope: Line::of(0.0),
    };
}

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

/// Where each number of a block is read: recorded quantities, the distance, and the variables.
#[derive(Clone, Copy)]
pub(crate) struct Reading {
    pub(super) recorded: [*const f64; Quantity::COUNT],
    pub(super) distance: [*const f64; 2],
    pub(super) value: [*const f64; TRACKS],
    pub(super) slope: [*const f64; TRACKS],
    /// Rows, rounded up to whole vectors: what follows the last row may be read.
    pub(crate) rows: usize,
}

impl Reading {
    /// The same block with derivatives to the distance (`true`) or to something else.
    pub(crate) fn to_distance(mut self, yes: bool) -> Self {
        self.distance[1] = if yes {
            ONES.0.as_ptr()
        } else {
            ZEROS.0.as_ptr()
        };
        self.slope = [ZEROS.0.as_ptr(); TRACKS];
        self
    }

    /// The same block with derivatives to one variable.
    pub(super) fn seeded(mut self, track: usize) -> Self {
        self.slope[track] = ONES.0.as_ptr();
        self
    }

    /// Derivatives of a variable.
    pub(crate) fn slope(&self, track: usize) -> &[f64] {
        // SAFETY: a reading has its rows, at most a block of them.
        unsafe { from_raw_parts(self.slope[track], self.rows) }
    }

    /// The same block at other distances.
    pub(crate) fn at(mut self, distance: &Line) -> Self {
        self.distance[0] = distance.0.as_ptr();
        self
    }

    /// Values and derivatives of the last stage up to and with this one that changed a variable.
    pub(crate) fn of(&self, stage: Stage) -> (*const f64, *const f64) {
        let track = tracks_of(stage).start;
        (self.value[track], self.slope[track])
    }

    /// Copies the values of a stage's variable.
    pub(crate) fn values(&self, stage: Stage, into: &mut Line) {
        let (values, _) = self.of(stage);
        // SAFETY: a reading has its rows, at most a block of them.
        into.0[..self.rows].copy_from_slice(unsafe { from_raw_parts(values, self.rows) });
    }

    /// Copies the derivatives of a stage's variable.
    pub(crate) fn slopes(&self, stage: Stage, into: &mut Line) {
        let (_, slopes) = self.of(stage);
        // SAFETY: as above.
        into.0[..self.rows].copy_from_slice(unsafe { from_raw_parts(slopes, self.rows) });
    }

    /// A variable is read from here on.
    pub(super) fn place(&mut self, track: usize, from: *const Track) {
        self.value[track] = from.cast();
        self.slope[track] = self.value[track].wrapping_add(BLOCK);
    }

    /// Variables are what was recorded, or what other variables are.
    pub(super) fn copy(&mut self, track: usize, (value, slope): (*const f64, *const f64)) {
        self.value[track] = value;
        self.slope[track] = slope;
    }

    /// A recorded quantity, which depends on nothing.
    pub(super) fn constant(&self, quantity: Quantity) -> (*const f64, *const f64) {
        (self.recorded[quantity as usize], ZEROS.0.as_ptr())
    }

    /// Some rows as an effect of a stage finds them.
    ///
    /// # Safety
    /// The block has rows `row..row + V::WIDTH`.
    #[inline(always)]
    pub(super) unsafe fn chain<V: Vector<Element = f64>>(
        &self,
        stage: Stage,
        row: usize,
    ) -> Chain<Dual<1, V>> {
        let mut values = [Dual::fixed(V::constant(0.0)); Quantity::COUNT];
        let time = match stage {
            Stage::Transducer => 7,
            Stage::Timer | Stage::Firmware | Stage::Indication => 8,
            _ => 6,
        };
        // SAFETY: the caller's, for every line.
        unsafe {
            for (value, recorded) in values.iter_mut().zip(self.recorded) {
                *value = Dual::fixed(V::load(recorded.add(row)));
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

/// Values and derivatives of some rows; no closure, which would not inherit the instruction set.
///
/// # Safety
/// Both lines have rows `row..row + V::WIDTH`.
#[inline(always)]
unsafe fn dual<V: Vector<Element = f64>>(
    value: *const f64,
    slope: *const f64,
    row: usize,
) -> Dual<1, V> {
    // SAFETY: the caller's.
    unsafe {
        Dual {
            value: V::load(value.add(row)),
            derivatives: [V::load(slope.add(row))],
        }
    }
}

/// Columns of a batch, of which blocks are read where they lie if they can be.
pub(crate) struct Given {
    first: Column,
    recorded: [Column; Quantity::COUNT],
    buffers: Box<[Line; 1 + Quantity::COUNT]>,
    filled: [bool; 1 + Quantity::COUNT],
}

impl Given {
    /// Columns of double precision: the quantity that a model is applied to, then every recorded
    /// one.
    pub(crate) fn new(first: Column, recorded: [Column; Quantity::COUNT]) -> Self {
        Self {
            first,
            recorded,
            buffers: Box::new([Line::of(0.0); 1 + Quantity::COUNT]),
            filled: [false; 1 + Quantity::COUNT],
        }
    }

    /// Some rows, with no derivative yet; the first column stands for the distance.
    ///
    /// # Safety
    /// The columns have `first + count` rows of double precision, `count` at most [`BLOCK`].
    pub(crate) unsafe fn block(&mut self, first: usize, count: usize) -> Reading {
        const WIDEST: usize = 16;
        let padded = count.next_multiple_of(WIDEST);
        let mut places = [ZEROS.0.as_ptr(); 1 + Quantity::COUNT];
        for (k, place) in places.iter_mut().enumerate() {
            let column = if k == 0 {
                self.first
            } else {
                self.recorded[k - 1]
            };
            let rows = column.skip(first);
            if rows.stride == size_of::<f64>().cast_signed() && padded == count {
                *place = rows.start.cast();
                continue;
            }
            let line = &mut self.buffers[k].0;
            if column.stride == 0 {
                if !self.filled[k] {
                    // SAFETY: the caller guarantees a number.
                    line.fill(unsafe { *rows.start.cast() });
                    self.filled[k] = true;
                }
            } else {
                for (row, number) in line[..count].iter_mut().enumerate() {
                    // SAFETY: the caller guarantees the rows.
                    *number = unsafe { *rows.skip(row).start.cast() };
                }
                let last = line[count - 1];
                line[count..padded].fill(last);
            }
            *place = line.as_ptr();
        }
        let recorded = core::array::from_fn(|q| places[1 + q]);
        Reading {
            recorded,
            distance: [places[0], ZEROS.0.as_ptr()],
            value: [places[0]; TRACKS],
            slope: [ZEROS.0.as_ptr(); TRACKS],
            rows: padded,
        }
    }
}
