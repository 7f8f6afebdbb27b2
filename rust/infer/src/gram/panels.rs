//! A block of rows of many columns, as the sums of products read them.
#![allow(unsafe_code)]

use super::filter::FilterStep;
use super::tiles::{GROUP, Rows, added};
use echocal_core::batch::{BLOCK, Line};
use echocal_core::simd::{Eight, OnVectors, Vector, interleave, on_vectors};

/// Rows of a panel: those of a block, and the one before them.
const ROWS: usize = 1 + BLOCK;
/// Numbers of a panel.
const PANEL: usize = ROWS * GROUP;

/// Rows of columns, of which eight lie side by side: row 0 is the one before the block.
pub(crate) struct Panels {
    groups: Vec<Eight>,
    width: usize,
    /// Panels of which some row is not zero.
    active: Vec<usize>,
}

impl Panels {
    /// Zeros, `width` in whole groups.
    pub(crate) fn new(width: usize) -> Self {
        Self {
            groups: vec![Eight([0.0; GROUP]); width / GROUP * ROWS],
            width,
            active: Vec::new(),
        }
    }

    /// What a sum of products reads.
    pub(crate) fn rows(&self) -> Rows<'_> {
        // SAFETY: a group is its numbers, one after the other.
        let numbers = unsafe {
            core::slice::from_raw_parts(self.groups.as_ptr().cast(), self.groups.len() * GROUP)
        };
        Rows {
            numbers,
            row: GROUP,
            panel: PANEL,
            panels: &self.active,
        }
    }

    /// Finds out which panels are zero up to a row, to be left out of sums: where an effect has not
    /// begun, what it would add is nought.
    pub(crate) fn leave_out_zeros(&mut self, count: usize) {
        let panels = self.groups.chunks_exact(ROWS).enumerate();
        let others = panels.filter(|(_, panel)| !are_zero(&panel[1..=count]));
        self.active = others.map(|(place, _)| place).collect();
    }

    fn target(&mut self, column: usize) -> *mut f64 {
        let offset = column / GROUP * PANEL + column % GROUP;
        self.groups.as_mut_ptr().cast::<f64>().wrapping_add(offset)
    }

    /// Numbers of a row, in whole groups.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// The row before the block.
    pub(crate) fn keep(&mut self, before: &[f64]) {
        let panels = self.groups.chunks_exact_mut(ROWS);
        for (panel, numbers) in panels.zip(before.chunks_exact(GROUP)) {
            panel[0].0.copy_from_slice(numbers);
        }
    }

    /// Copies a row.
    pub(crate) fn last(&self, row: usize, into: &mut [f64]) {
        let panels = self.groups.chunks_exact(ROWS);
        for (panel, numbers) in panels.zip(into.chunks_exact_mut(GROUP)) {
            numbers.copy_from_slice(&panel[row].0);
        }
    }

    /// Rows 1 to `count` from a line for each column; columns that are missing are zero.
    pub(crate) fn fill(&mut self, lines: &[Line], count: usize) {
        static NONE: Line = Line::of(0.0);
        for (place, panel) in self.groups.chunks_exact_mut(ROWS).enumerate() {
            let column = |at: usize| &lines.get(place * GROUP + at).unwrap_or(&NONE).0[..];
            interleave(core::array::from_fn(column), &mut panel[1..=count]);
        }
    }

    /// Rows 1 to `count` less the row before each.
    #[inline(always)]
    pub(crate) fn differ<V: Vector<Element = f64>>(&mut self, plain: &Self, count: usize) {
        assert!(count <= BLOCK && plain.width == self.width);
        for column in (0..self.width).step_by(V::WIDTH) {
            let (target, source) = (self.target(column), plain.rows().column(column));
            for row in 1..=count {
                // SAFETY: both have a block of rows after the first.
                unsafe {
                    let before = V::load(source.add((row - 1) * GROUP));
                    let change = V::load(source.add(row * GROUP)) - before;
                    change.store(target.add(row * GROUP));
                }
            }
        }
    }

    /// Rows from 1 on, each with `coefficient` times the row before of these, but where a series begins.
    #[inline(always)]
    pub(crate) fn moving_average<V: Vector<Element = f64>>(
        &mut self,
        plain: &Self,
        coefficient: f64,
        begins: &[bool],
    ) {
        assert!(begins.len() <= BLOCK && plain.width == self.width);
        for column in (0..self.width).step_by(V::WIDTH) {
            let (target, source) = (self.target(column), plain.rows().column(column));
            // SAFETY: the columns lie within the width, the rows in a block.
            unsafe {
                let mut state = V::load(target);
                for (row, &begins) in (1..).zip(begins) {
                    let factor = V::constant(if begins { 0.0 } else { coefficient });
                    state = added(factor, state, V::load(source.add(row * GROUP)));
                    state.store(target.add(row * GROUP));
                }
            }
        }
    }

    /// Rows from 1 on as a filter whitens them, whose state is that of every column.
    pub(crate) fn whiten(&mut self, plain: &Self, steps: &[FilterStep], state: &mut [f64]) {
        assert!(steps.len() <= BLOCK && plain.width == self.width && state.len() == self.width);
        on_vectors(Whiten {
            panels: self,
            plain,
            steps,
            state,
        });
    }

    /// Columns of a panel at a time, for each waits for its own last row.
    #[inline(always)]
    unsafe fn whiten_all<V: Vector<Element = f64>>(
        &mut self,
        plain: &Self,
        steps: &[FilterStep],
        state: &mut [f64],
    ) {
        for column in (0..self.width).step_by(V::WIDTH) {
            let (target, source) = (self.target(column), plain.rows().column(column));
            // SAFETY: the columns lie within the width, the rows in a block.
            unsafe {
                let kept = state.as_mut_ptr().add(column);
                let mut state = V::load(kept);
                for (row, step) in (1..).zip(steps) {
                    let value = V::load(source.add(row * GROUP));
                    let white = (value - V::constant(step.from) * state) * V::constant(step.scale);
                    white.store(target.add(row * GROUP));
                    state = added(
                        V::constant(step.kept),
                        state,
                        V::constant(step.taken) * value,
                    );
                }
                state.store(kept);
            }
        }
    }
}

/// The arguments of [`Panels::whiten`], checked.
struct Whiten<'a> {
    panels: &'a mut Panels,
    plain: &'a Panels,
    steps: &'a [FilterStep],
    state: &'a mut [f64],
}

impl OnVectors for Whiten<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector<Element = f64>>(self) {
        // SAFETY: the lengths were checked.
        unsafe {
            self.panels
                .whiten_all::<V>(self.plain, self.steps, self.state)
        }
    }
}

/// Whether all numbers are zero, some rows at a time.
fn are_zero(rows: &[Eight]) -> bool {
    const SOME: usize = 16;
    let any = |bits: [u64; GROUP], row: &Eight| {
        core::array::from_fn(|i| bits[i] | row.0[i].to_bits() << 1) // but for the sign
    };
    let mut parts = rows.chunks(SOME);
    parts.all(|part| part.iter().fold([0; GROUP], any) == [0; GROUP])
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 48;

    fn number(column: usize, row: usize) -> f64 {
        ((column * 31 + row) as f64 * 0.754_877).fract() - 0.5
    }

    fn filled(columns: usize) -> Panels {
        let mut lines = vec![Line::of(0.0); columns];
        for (column, line) in lines.iter_mut().enumerate() {
            for (row, value) in line.0.iter_mut().enumerate() {
                *value = number(column, row);
            }
        }
        let mut panels = Panels::new(WIDTH);
        panels.fill(&lines, 7);
        panels
    }

    fn at(panels: &Panels, row: usize) -> Vec<f64> {
        let mut values = vec![0.0; WIDTH];
        panels.last(row, &mut values);
        values
    }

    #[test]
    fn every_row_has_its_columns_and_zeros() {
        let panels = filled(43);
        for row in 0..7 {
            let own = |column| {
                if column < 43 {
                    number(column, row)
                } else {
                    0.0
                }
            };
            assert_eq!(
                at(&panels, 1 + row),
                (0..WIDTH).map(own).collect::<Vec<_>>()
            );
        }
    }

    #[test]
    fn panels_of_zeros_are_left_out() {
        let mut lines = [Line::of(0.0); WIDTH];
        lines[3 * GROUP + 5].0[199] = 1e-300;
        lines[GROUP].0[7] = -0.0;
        lines[0].0[0] = f64::NAN;
        let mut panels = Panels::new(WIDTH);
        panels.fill(&lines, BLOCK);
        panels.leave_out_zeros(BLOCK);
        assert_eq!(panels.rows().panels, [0, 3]);
        panels.leave_out_zeros(199);
        assert_eq!(panels.rows().panels, [0]);
    }

    #[test]
    fn a_row_has_a_part_of_the_one_before() {
        let (plain, mut changes, mut kept) =
            (filled(WIDTH), Panels::new(WIDTH), Panels::new(WIDTH));
        changes.differ::<f64>(&plain, 3);
        kept.keep(&[2.0; WIDTH]);
        kept.moving_average::<f64>(&plain, 0.5, &[false, true, false]);
        for column in 0..WIDTH {
            let [a, b, c] = [0, 1, 2].map(|row| number(column, row));
            assert_eq!(at(&changes, 1)[column], a);
            assert_eq!(at(&changes, 3)[column], c - b);
            assert_eq!(at(&kept, 1)[column], 0.5 * 2.0 + a);
            assert_eq!(at(&kept, 3)[column], 0.5 * b + c);
        }
    }
}
