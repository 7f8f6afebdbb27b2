//! One pass over the rows for several moving-average coefficients, in spans on several threads.

use crate::gram::{
    Class, ClassLists, ClassSums, Panels, Reader, RowLayout, Source, beginning, forget, join,
};
use crate::parallel::in_spans;
use echocal_core::batch::{BLOCK, Line};
use core::ops::Range;
use echocal_core::simd::{OnVectors, Vector, on_vectors};
use std::collections::BTreeMap;

/// What is passed over.
pub(super) struct Plan<'a> {
    pub source: &'a dyn Source,
    pub layout: &'a RowLayout<'a>,
    /// First rows of blocks in the midst of a series, ascending.
    pub edges: &'a [usize],
    /// Moving-average coefficients, none of them 0.
    pub coefficients: &'a [f64],
    /// Columns, padded to whole groups.
    pub width: usize,
}

/// Kinds of products kept beside those of each coefficient: plain, and of differences.
pub(super) const KINDS: usize = 2;
/// The sums of a span, or of all.
#[derive(Default)]
pub(super) struct Parts {
    /// Products of each two columns over blocks.
    pub blocks: ClassSums,
    /// Products of the first column over cells.
    pub cells: ClassSums,
    /// Each edge and the row before it: plain, and as each coefficient filters them.
    pub edges: BTreeMap<usize, Vec<[Vec<f64>; 2]>>,
}

impl Parts {
    /// Adds the sums of the span that follows.
    fn join(&mut self, next: Self) {
        join(&mut self.blocks, next.blocks);
        join(&mut self.cells, next.cells);
        self.edges.extend(next.edges);
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

/// One thread's memory.
struct Span<'a> {
    plan: &'a Plan<'a>,
    reader: Box<dyn Reader + 'a>,
    lines: Vec<Line>,
    plain: Panels,
    made: Panels,
    /// The last row of the block before: plain, and as each coefficient filters it.
    last: Vec<Vec<f64>>,
    blocks: ClassLists,
    cells: ClassLists,
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
            last: vec![vec![0.0; plan.width]; 1 + plan.coefficients.len()],
            blocks: ClassLists::default(),
            cells: ClassLists::default(),
            parts: Parts::default(),
        }
    }

    fn run(&mut self, first: usize, end: usize) -> Parts {
        for last in &mut self.last {
            last.fill(0.0);
        }
        let longest = self.plan.coefficients.iter().copied().fold(0.0, f64::max);
        let from = beginning(self.plan.layout.starts, first, longest);
        for block in (from..end).step_by(BLOCK) {
            let count = BLOCK.min(end - block);
            self.reader.read(block, count, &mut self.lines);
            self.plain.keep(&self.last[0]);
            self.plain.fill(&self.lines, count);
            self.plain.last(count, &mut self.last[0]);
            let own = first.max(block)..block + count;
            self.sort(own.clone(), block);
            self.add(0, count);
            copy_edges(self.plan, &self.plain, own, block, &mut self.parts);
            on_vectors(AddOthers {
                span: self,
                first,
                block,
                count,
            });
        }
        core::mem::take(&mut self.parts)
    }

    /// Adds what the rows of a block have beside their plain products.
    #[inline(always)]
    fn add_others<V: Vector<Element = f64>>(&mut self, first: usize, block: usize, count: usize) {
        let starts = &self.plan.layout.starts[block..block + count];
        let (plain, filtered) = self.last.split_at_mut(1);
        if starts.iter().all(|&begins| begins) {
            return filtered
                .iter_mut()
                .for_each(|last| last.copy_from_slice(&plain[0]));
        }
        self.made.differ::<V>(&self.plain, count);
        self.add(1, count);
        for (k, &coefficient) in self.plan.coefficients.iter().enumerate() {
            self.made.keep(&self.last[1 + k]);
            self.made.moving_average::<V>(&self.plain, coefficient, starts);
            self.made.last(count, &mut self.last[1 + k]);
            forget(&mut self.last[1 + k]);
            self.add(KINDS + k, count);
            let own = first.max(block)..block + count;
            copy_edges(self.plan, &self.made, own, block, &mut self.parts);
        }
    }

    /// Adds the products of one kind: of the plain rows, or of those that were made last.
    fn add(&mut self, kind: usize, count: usize) {
        let (width, kinds) = (self.plan.width, KINDS + self.plan.coefficients.len());
        let panels = if kind == 0 {
            &mut self.plain
        } else {
            &mut self.made
        };
        panels.leave_out_zeros(count);
        let Parts { blocks, cells, .. } = &mut self.parts;
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

/// Copies the edges among some rows, and the row before each, from the panels of the block that begins at a row.
fn copy_edges(plan: &Plan<'_>, panels: &Panels, rows: Range<usize>, block: usize, parts: &mut Parts) {
    let from = plan.edges.partition_point(|&edge| edge < rows.start);
    for &edge in plan.edges[from..].iter().take_while(|&&edge| edge < rows.end) {
        let at = 1 + edge - block;
        let copied = [at, at - 1].map(|row| {
            let mut numbers = vec![0.0; plan.width];
            panels.last(row, &mut numbers);
            numbers
        });
        parts.edges.entry(edge).or_default().push(copied);
    }
}

/// The arguments of [`Span::add_others`].
struct AddOthers<'s, 'a> {
    span: &'s mut Span<'a>,
    first: usize,
    block: usize,
    count: usize,
}

impl OnVectors for AddOthers<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector<Element = f64>>(self) {
        self.span
            .add_others::<V>(self.first, self.block, self.count);
    }
}
