//! One pass over the rows, in spans on several threads.

#![allow(unsafe_code)]

use super::gram::{GROUP, add_chosen};
use super::panels::Panels;
use super::products::{Layout, triangles};
use super::source::{Reader, Source};
use super::threaded::in_spans;
use crate::batch::staged::{BLOCK, Line};
#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F64x4, F64x8};
use crate::simd::{InstructionSet, Vector, active};
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
/// What is left of a memory below this is nought \[m\]: nothing that a sum of squares would notice.
const FAINT: f64 = 1e-30;

/// Rows that count in the same sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Class {
    /// Whether they begin series.
    pub begins: bool,
    /// Their block, or their cell.
    pub own: u32,
    /// That of the row that follows in the series.
    pub next: Option<u32>,
}

/// Sums by class and kind: plain, of differences, of each memory; of rows that begin a series the
/// plain products alone.
pub(super) type Kinds = BTreeMap<Class, Vec<Vec<f64>>>;

/// The sums of a span, or of all.
#[derive(Default)]
pub(super) struct Parts {
    /// Products of each two columns over blocks.
    pub blocks: Kinds,
    /// Products of the first column over cells.
    pub cells: Kinds,
}

impl Parts {
    /// Adds the sums of the span that follows.
    fn join(&mut self, next: Self) {
        join(&mut self.blocks, next.blocks);
        join(&mut self.cells, next.cells);
    }
}

/// Adds the sums of the span that follows.
pub(super) fn join(all: &mut Kinds, more: Kinds) {
    for (class, kinds) in more {
        let Some(own) = all.get_mut(&class) else {
            all.insert(class, kinds);
            continue;
        };
        for (sums, more) in own.iter_mut().zip(&kinds) {
            add(sums, more);
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
    let chosen: Vec<u32> = (1..).take(BLOCK).collect();
    let worker = || {
        let (mut reader, mut panels) = (source.reader(), Panels::new(width));
        let mut lines = vec![Line::of(0.0); columns];
        let chosen = &chosen;
        move |first: usize, end: usize| {
            let mut sums = vec![0.0; width * width];
            for block in (first..end).step_by(BLOCK) {
                let count = BLOCK.min(end - block);
                reader.read(block, count, &mut lines);
                panels.fill(&lines, count);
                panels.leave_out_zeros(count);
                add_chosen(panels.rows(), &chosen[..count], width, &mut sums);
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

/// Rows of a block by class.
#[derive(Default)]
pub(super) struct Lists(Vec<(Class, Vec<u32>)>);

impl Lists {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn push(&mut self, class: Class, row: u32) {
        match self.0.iter_mut().rev().find(|(other, _)| *other == class) {
            Some((_, rows)) => rows.push(row),
            None => self.0.push((class, vec![row])),
        }
    }

    /// Adds the products of one kind to the sums, of which there are so many a class.
    pub(super) fn add(
        &self,
        panels: &Panels,
        kind: usize,
        kinds: usize,
        length: usize,
        sums: &mut Kinds,
    ) {
        let rows = panels.rows();
        let with = |(class, _): &&(Class, Vec<u32>)| kind == 0 || !class.begins;
        for (class, chosen) in self.0.iter().filter(with) {
            let kinds = if class.begins { 1 } else { kinds };
            let own = sums
                .entry(*class)
                .or_insert_with(|| vec![vec![0.0; length]; kinds]);
            add_chosen(rows, chosen, panels.width(), &mut own[kind]);
        }
    }
}

/// One thread's memory.
struct Span<'a> {
    plan: &'a Plan<'a>,
    reader: Box<dyn Reader + 'a>,
    lines: Vec<Line>,
    plain: Panels,
    made: Panels,
    /// The last row of the block before: plain, and how each memory has it.
    last: Vec<Vec<f64>>,
    blocks: Lists,
    cells: Lists,
    parts: Parts,
}

impl<'a> Span<'a> {
    fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            plan,
            reader: plan.source.reader(),
            lines: vec![Line::of(0.0); plan.source.width()],
            plain: Panels::new(plan.width),
            made: Panels::new(plan.width),
            last: vec![vec![0.0; plan.width]; 1 + plan.memories.len()],
            blocks: Lists::default(),
            cells: Lists::default(),
            parts: Parts::default(),
        }
    }

    fn run(&mut self, first: usize, end: usize) -> Parts {
        for last in &mut self.last {
            last.fill(0.0);
        }
        let longest = self.plan.memories.iter().copied().fold(0.0, f64::max);
        let from = beginning(self.plan.layout.starts, first, longest);
        for block in (from..end).step_by(BLOCK) {
            let count = BLOCK.min(end - block);
            self.reader.read(block, count, &mut self.lines);
            self.plain.keep(&self.last[0]);
            self.plain.fill(&self.lines, count);
            self.plain.last(count, &mut self.last[0]);
            self.sort(first.max(block)..block + count, block);
            self.add(0, count);
            match active() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the instruction set is available.
                InstructionSet::Avx512 => unsafe { self.add_avx512(block, count) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                InstructionSet::Avx2 => unsafe { self.add_avx2(block, count) },
                _ => self.add_others::<f64>(block, count),
            }
        }
        core::mem::take(&mut self.parts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
    unsafe fn add_avx512(&mut self, block: usize, count: usize) {
        self.add_others::<F64x8>(block, count);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn add_avx2(&mut self, block: usize, count: usize) {
        self.add_others::<F64x4>(block, count);
    }

    /// Adds what the rows of a block have beside their plain products.
    #[inline(always)]
    fn add_others<V: Vector<Element = f64>>(&mut self, block: usize, count: usize) {
        let starts = &self.plan.layout.starts[block..block + count];
        let (plain, remembered) = self.last.split_at_mut(1);
        if starts.iter().all(|&begins| begins) {
            return remembered
                .iter_mut()
                .for_each(|last| last.copy_from_slice(&plain[0]));
        }
        self.made.differ::<V>(&self.plain, count);
        self.add(1, count);
        for (k, &memory) in self.plan.memories.iter().enumerate() {
            self.made.keep(&self.last[1 + k]);
            self.made.remember::<V>(&self.plain, memory, starts);
            self.made.last(count, &mut self.last[1 + k]);
            forget(&mut self.last[1 + k]);
            self.add(KINDS + k, count);
        }
    }

    /// Adds the products of one kind: of the plain rows, or of those that were made last.
    fn add(&mut self, kind: usize, count: usize) {
        let (width, kinds) = (self.plan.width, KINDS + self.plan.memories.len());
        let panels = if kind == 0 {
            &mut self.plain
        } else {
            &mut self.made
        };
        panels.leave_out_zeros(count);
        let Parts { blocks, cells } = &mut self.parts;
        self.blocks.add(panels, kind, kinds, width * width, blocks);
        self.cells.add(panels, kind, kinds, width, cells);
    }

    /// Sorts rows of the block that begins at a row.
    fn sort(&mut self, rows: core::ops::Range<usize>, block: usize) {
        self.blocks.clear();
        self.cells.clear();
        let layout = self.plan.layout;
        for row in rows {
            let goes_on = layout.starts.get(row + 1) == Some(&false);
            let class = |labels: &[u32]| Class {
                begins: layout.starts[row],
                own: labels[row],
                next: goes_on.then(|| labels[row + 1]),
            };
            let at = (1 + row - block) as u32;
            self.blocks.push(class(layout.blocks), at);
            self.cells.push(class(layout.cells), at);
        }
    }
}

/// Where what is remembered by a factor must begin so that it is right from a row on.
pub(super) fn beginning(starts: &[bool], first: usize, factor: f64) -> usize {
    let rows = if factor > 0.0 {
        FORGOTTEN.log(factor)
    } else {
        1.0
    };
    let earliest = first.saturating_sub(rows.ceil() as usize);
    starts[earliest..=first]
        .iter()
        .rposition(|&starts| starts)
        .map_or(earliest, |at| earliest + at)
}

/// Lets a memory end: of columns that are nought again, whole panels are then left out.
pub(super) fn forget(memory: &mut [f64]) {
    for number in memory.iter_mut().filter(|number| number.abs() < FAINT) {
        *number = 0.0;
    }
}

/// `sums += more`.
fn add(sums: &mut [f64], more: &[f64]) {
    for (sum, &value) in sums.iter_mut().zip(more) {
        *sum += value;
    }
}
