//! One pass over the rows, in spans on several threads.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call
#![allow(unsafe_code)]

use super::gram::{GROUP, add_products};
use super::products::{Layout, both_ways, triangles};
use super::source::{Reader, Source, side_by_side};
use super::threaded::in_spans;
use crate::batch::staged::{BLOCK, Line};
use crate::simd::{InstructionSet, active};
use std::collections::BTreeMap;

/// What is passed over.
pub(super) struct Plan<'a> {
    pub source: &'a dyn Source,
    pub layout: &'a Layout<'a>,
    /// Factors of memories, none of them 0.
    pub memories: &'a [f64],
    /// Columns, padded to whole groups.
    pub width: usize,
}

/// Products kept beside those of each memory: plain, and of differences.
pub(super) const KINDS: usize = 2;
/// Part of a row that a memory may have forgotten where a span begins.
const FORGOTTEN: f64 = 1e-17;
/// Rows of a class that wait to be summed.
const WAITING: usize = 64;

/// Rows that count in the same sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Class {
    /// Whether they begin series.
    pub begins: bool,
    pub block: usize,
    /// The block of the row that follows in the series.
    pub next: Option<usize>,
}

/// Rows of a class that wait, and sums of those that do not: of rows that begin a series the plain
/// products alone.
struct Kept {
    waiting: Vec<Vec<f64>>,
    sums: Vec<Vec<f64>>,
}

impl Kept {
    fn new(kinds: usize, width: usize) -> Self {
        Self {
            waiting: vec![Vec::with_capacity(WAITING * width); kinds],
            sums: vec![vec![0.0; width * width]; kinds],
        }
    }

    fn sum(&mut self, width: usize) {
        for (rows, sums) in self.waiting.iter_mut().zip(&mut self.sums) {
            add_products(rows, width, sums);
            rows.clear();
        }
    }
}

/// Products of the first column over one cell: of rows that begin a series; present, previous and
/// lagged plain products of others; present and previous ones of each memory.
#[derive(Default)]
struct Cell {
    first: Vec<f64>,
    others: Vec<f64>,
}

/// The sums of a span, or of all.
#[derive(Default)]
pub(super) struct Parts {
    classes: BTreeMap<Class, Kept>,
    cells: BTreeMap<u32, Cell>,
}

impl Parts {
    /// Sums by class and kind.
    pub(super) fn classes(&self) -> impl Iterator<Item = (&Class, &Vec<Vec<f64>>)> {
        self.classes.iter().map(|(class, kept)| (class, &kept.sums))
    }

    /// Cell sums for one memory: present, previous, lagged both ways, first.
    pub(super) fn cells(&self, plan: &Plan<'_>, kind: Option<usize>, memory: f64) -> [Vec<f64>; 4] {
        let (width, columns) = (plan.width, plan.source.width());
        let mut found = [(); 4].map(|()| vec![0.0; plan.layout.cell_count * columns]);
        for (&cell, sums) in &self.cells {
            let line = cell as usize * columns..(cell as usize + 1) * columns;
            if !sums.first.is_empty() {
                found[3][line.clone()].copy_from_slice(&sums.first[..columns]);
            }
            if sums.others.is_empty() {
                continue;
            }
            let part = |index: usize| &sums.others[index * width..index * width + columns];
            let own = kind.map_or(0, |k| 3 + 2 * k);
            found[0][line.clone()].copy_from_slice(part(own));
            found[1][line.clone()].copy_from_slice(part(own + 1));
            for (i, lagged) in found[2][line].iter_mut().enumerate() {
                *lagged = match kind {
                    None => part(2)[i],
                    Some(_) => both_ways(part(own)[i], part(own + 1)[i], part(0)[i], memory),
                };
            }
        }
        found
    }

    /// Adds the sums of the span that follows.
    fn join(&mut self, next: Self) {
        for (class, kept) in next.classes {
            match self.classes.get_mut(&class) {
                None => drop(self.classes.insert(class, kept)),
                Some(own) => {
                    for (sums, more) in own.sums.iter_mut().zip(&kept.sums) {
                        add(sums, more);
                    }
                }
            }
        }
        for (cell, sums) in next.cells {
            let own = self.cells.entry(cell).or_default();
            for (sum, more) in [(&mut own.first, sums.first), (&mut own.others, sums.others)] {
                if sum.is_empty() {
                    *sum = more;
                } else {
                    add(sum, &more);
                }
            }
        }
    }
}

/// Passes over all rows: the spans, and the order of their sums, are those of the table alone.
pub(super) fn gathered(plan: &Plan<'_>, threads: usize) -> Parts {
    let worker = || {
        let mut span = Span::new(plan);
        move |first, end| span.run(first, end)
    };
    let mut whole = Parts::default();
    for span in in_spans(plan.layout.starts.len(), threads, worker) {
        whole.join(span);
    }
    whole
}

/// Products of every pair of columns, summed over all rows; row-major.
#[must_use]
pub fn gram(source: &dyn Source, threads: usize) -> Vec<f64> {
    let columns = source.width();
    let width = columns.next_multiple_of(GROUP);
    let worker = || {
        let (mut reader, mut rows) = (source.reader(), Vec::new());
        let mut lines = vec![Line::of(0.0); columns];
        move |first: usize, end: usize| {
            let mut sums = vec![0.0; width * width];
            for block in (first..end).step_by(BLOCK) {
                let count = BLOCK.min(end - block);
                reader.read(block, count, &mut lines);
                side_by_side(&lines, count, width, &mut rows);
                add_products(&rows, width, &mut sums);
            }
            sums
        }
    };
    let mut whole = vec![0.0; width * width];
    for sums in in_spans(source.rows(), threads, worker) {
        add(&mut whole, &sums);
    }
    triangles(&whole, width, columns)
}

/// One thread's memory.
struct Span<'a> {
    plan: &'a Plan<'a>,
    reader: Box<dyn Reader + 'a>,
    lines: Vec<Line>,
    rows: Vec<f64>,
    /// The row before, and how each memory has it; then the same of this row.
    before: Vec<Vec<f64>>,
    now: Vec<Vec<f64>>,
    parts: Parts,
}

impl<'a> Span<'a> {
    fn new(plan: &'a Plan<'a>) -> Self {
        let states = vec![vec![0.0; plan.width]; 1 + plan.memories.len()];
        Self {
            plan,
            reader: plan.source.reader(),
            lines: vec![Line::of(0.0); plan.source.width()],
            rows: Vec::new(),
            before: states.clone(),
            now: states,
            parts: Parts::default(),
        }
    }

    fn run(&mut self, first: usize, end: usize) -> Parts {
        match active() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the instruction set is available, or a wider one.
            InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { self.run_avx2(first, end) },
            _ => self.pass(first, end),
        }
        let width = self.plan.width;
        for kept in self.parts.classes.values_mut() {
            kept.sum(width);
        }
        core::mem::take(&mut self.parts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn run_avx2(&mut self, first: usize, end: usize) {
        self.pass(first, end);
    }

    #[inline(always)]
    fn pass(&mut self, first: usize, end: usize) {
        let (starts, width) = (self.plan.layout.starts, self.plan.width);
        let from = self.beginning(first);
        for block in (from..end).step_by(BLOCK) {
            let count = BLOCK.min(end - block);
            self.reader.read(block, count, &mut self.lines);
            side_by_side(&self.lines, count, width, &mut self.rows);
            for offset in 0..count {
                let row = block + offset;
                let x = offset * width..(offset + 1) * width;
                let begins = starts[row] || row == from;
                core::mem::swap(&mut self.before, &mut self.now);
                self.now[0].copy_from_slice(&self.rows[x]);
                for (k, &memory) in self.plan.memories.iter().enumerate() {
                    let (plain, kept) = self.now.split_at_mut(1 + k);
                    remember(&mut kept[0], &plain[0], &self.before[1 + k], memory, begins);
                }
                if row >= first {
                    self.count(row);
                }
            }
        }
    }

    /// Where memories must begin so that they are right from a row on.
    fn beginning(&self, first: usize) -> usize {
        let longest = self.plan.memories.iter().copied().fold(0.0, f64::max);
        let rows = if longest > 0.0 {
            FORGOTTEN.ln() / longest.ln()
        } else {
            1.0
        };
        let earliest = first.saturating_sub(rows.ceil() as usize);
        let starts = &self.plan.layout.starts[earliest..=first];
        starts
            .iter()
            .rposition(|&starts| starts)
            .map_or(earliest, |at| earliest + at)
    }

    #[inline(always)]
    fn count(&mut self, row: usize) {
        let (layout, width) = (self.plan.layout, self.plan.width);
        let goes_on = layout.starts.get(row + 1) == Some(&false);
        let class = Class {
            begins: layout.starts[row],
            block: layout.blocks[row] as usize,
            next: goes_on.then(|| layout.blocks[row + 1] as usize),
        };
        let kinds = if class.begins {
            1
        } else {
            KINDS + self.plan.memories.len()
        };
        let kept = self
            .parts
            .classes
            .entry(class)
            .or_insert_with(|| Kept::new(kinds, width));
        let cell = self.parts.cells.entry(layout.cells[row]).or_default();
        kept.waiting[0].extend_from_slice(&self.now[0]);
        if class.begins {
            cell.first.resize(width, 0.0);
            add_scaled(&mut cell.first, self.now[0][0], &self.now[0]);
        } else {
            let change = self.now[0].iter().zip(&self.before[0]).map(|(a, b)| a - b);
            kept.waiting[1].extend(change);
            cell.others.resize((1 + 2 * self.now.len()) * width, 0.0);
            let (plain, remembered) = cell.others.split_at_mut(3 * width);
            let (now, before) = (&self.now[0], &self.before[0]);
            add_scaled(&mut plain[..width], now[0], now);
            add_scaled(&mut plain[width..2 * width], before[0], before);
            add_scaled(&mut plain[2 * width..], now[0], before);
            add_scaled(&mut plain[2 * width..], before[0], now);
            let states = self.now[1..].iter().zip(&self.before[1..]);
            for (k, (now, before)) in states.enumerate() {
                kept.waiting[KINDS + k].extend_from_slice(now);
                let sums = &mut remembered[2 * k * width..];
                add_scaled(&mut sums[..width], now[0], now);
                add_scaled(&mut sums[width..2 * width], before[0], before);
            }
        }
        if kept.waiting[0].len() >= WAITING * width {
            kept.sum(width);
        }
    }
}

/// `now = plain + memory before`, or `plain` where a series begins.
#[inline(always)]
fn remember(now: &mut [f64], plain: &[f64], before: &[f64], memory: f64, begins: bool) {
    if begins {
        return now.copy_from_slice(plain);
    }
    for ((z, &x), &old) in now.iter_mut().zip(plain).zip(before) {
        *z = memory * old + x;
    }
}

/// `line += factor * values`.
#[inline(always)]
fn add_scaled(line: &mut [f64], factor: f64, values: &[f64]) {
    for (sum, &value) in line.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

/// `sums += more`.
fn add(sums: &mut [f64], more: &[f64]) {
    for (sum, &value) in sums.iter_mut().zip(more) {
        *sum += value;
    }
}
