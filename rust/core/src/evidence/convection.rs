//! Noise of warm cells that drift through the path of the echo.
//!
//! The delays of cells that know nothing of each other add up, and so do their variances: that of the
//! travel time grows in proportion to the path, until caustics bend it upward (Andreeva & Durgin 2005,
//! <https://doi.org/10.1080/17455030500284170>). A cell stays for some rows: white noise beside a
//! first-order autoregression whose variance is proportional to the distance of the row. With another
//! distance in every row no lag-1 products whiten that; Kalman's filter (1960,
//! <https://doi.org/10.1115/1.3662552>) does, with the same gains for all columns.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::gram::GROUP;
use super::panels::Panels;
use super::products::{Layout, Products, narrow, triangles};
use super::source::{Reader, Source};
use super::spans::{Class, Kinds, Lists, beginning, forget, join};
use super::threaded::in_spans;
use crate::batch::staged::{BLOCK, Line};

/// White noise, and a remembered part that grows with the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convection {
    /// Autoregressive coefficient of the remembered part.
    pub rho: f64,
    /// Variance of the remembered part over that of the white one, per distance \[1/m\].
    pub growth: f64,
}

/// What one row asks of every column: `e = (x - from state) scale`, then `state = kept state + taken x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub from: f64,
    pub scale: f64,
    pub kept: f64,
    pub taken: f64,
    /// Log of the innovation's variance over that of the white noise.
    pub log_variance: f64,
}

/// Kalman's filter for a remembered part of variance 1 at a distance of one meter.
#[derive(Clone, Copy, Debug)]
struct Filter {
    of: Convection,
    /// Variance of the remembered part given the rows before.
    variance: f64,
}

impl Filter {
    const fn new(of: Convection) -> Self {
        Self {
            of,
            variance: of.growth,
        }
    }

    /// The step of the next row, at its distance \[m\].
    fn step(&mut self, begins: bool, distance: f64) -> Step {
        let Convection { rho, growth } = self.of;
        let root = distance.max(0.0).sqrt();
        if begins {
            self.variance = growth;
        }
        let whole = 1.0 + root * root * self.variance;
        let gain = self.variance * root / whole;
        self.variance =
            rho * rho * (1.0 - gain * root) * self.variance + (1.0 - rho * rho) * growth;
        let known = if begins { 0.0 } else { 1.0 };
        Step {
            from: known * root,
            scale: 1.0 / whole.sqrt(),
            kept: known * rho * (1.0 - gain * root),
            taken: rho * gain,
            log_variance: whole.ln(),
        }
    }
}

impl Convection {
    /// A series of values whitened, each row in units of the white noise, with the mean log variance
    /// of the rows before.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[must_use]
    pub fn whitened(self, values: &[f64], starts: &[bool], distance: &[f64]) -> (Vec<f64>, f64) {
        assert!(values.len() == starts.len() && values.len() == distance.len());
        let (mut filter, mut state, mut log) = (Filter::new(self), 0.0, 0.0);
        let rows = values.iter().zip(starts).zip(distance);
        let white = rows.map(|((&value, &begins), &distance)| {
            let step = filter.step(begins, distance);
            let white = (value - step.from * state) * step.scale;
            state = step.kept * state + step.taken * value;
            log += step.log_variance;
            white
        });
        (white.collect(), log)
    }

    /// Products of whitened columns for each of some convections, in one pass over the rows of a
    /// source, on at most so many threads. The sums do not depend on the number of threads.
    ///
    /// # Panics
    /// If the columns and the layout differ in length.
    #[must_use]
    pub fn gather(
        source: &dyn Source,
        layout: &Layout<'_>,
        convections: &[Self],
        threads: usize,
    ) -> Vec<Products> {
        let rows = layout.starts.len();
        assert!(source.rows() == rows && layout.distance.len() == rows);
        assert!(layout.blocks.len() == rows && layout.cells.len() == rows);
        let worker = || {
            let mut span = Span::new(source, layout, convections);
            move |first, end| span.run(first, end)
        };
        let mut whole = vec![Part::default(); convections.len()];
        for span in in_spans(rows, threads, worker) {
            for (whole, part) in whole.iter_mut().zip(span) {
                whole.join(part);
            }
        }
        let width = source.width().next_multiple_of(GROUP);
        let each = whole.into_iter();
        each.map(|part| part.products(layout, width, source.width()))
            .collect()
    }
}

/// The sums of a span, or of all, for one convection.
#[derive(Clone, Default)]
struct Part {
    blocks: Kinds,
    cells: Kinds,
    /// Sum of log variances per block.
    log_variance: Vec<f64>,
}

impl Part {
    fn join(&mut self, next: Self) {
        join(&mut self.blocks, next.blocks);
        join(&mut self.cells, next.cells);
        self.log_variance.resize(next.log_variance.len(), 0.0);
        for (sum, more) in self.log_variance.iter_mut().zip(next.log_variance) {
            *sum += more;
        }
    }

    /// All of it as products of rows that begin a series: whitened rows owe each other nothing.
    fn products(self, layout: &Layout<'_>, width: usize, columns: usize) -> Products {
        let placed = |kinds: &Kinds, count: usize, length: usize| {
            let mut sums = vec![0.0; count * length];
            for (class, own) in kinds {
                let at = class.own as usize * length;
                sums[at..at + length].copy_from_slice(&own[0]);
            }
            sums
        };
        let blocks = placed(&self.blocks, layout.block_count, width * width);
        let cells = placed(&self.cells, layout.cell_count, width);
        let (blocks, cells) = (
            triangles(&blocks, width, columns),
            narrow(&cells, width, columns),
        );
        let only = |sums: Vec<f64>| [Vec::new(), Vec::new(), Vec::new(), sums];
        Products {
            log_variance: self.log_variance,
            cells: only(cells),
            blocks: only(blocks),
        }
    }
}

/// One thread's memory.
struct Span<'a> {
    layout: &'a Layout<'a>,
    convections: &'a [Convection],
    reader: Box<dyn Reader + 'a>,
    lines: Vec<Line>,
    plain: Panels,
    white: Panels,
    /// Each filter, and the state of every column.
    filters: Vec<(Filter, Vec<f64>)>,
    steps: Vec<Step>,
    blocks: Lists,
    cells: Lists,
}

impl<'a> Span<'a> {
    fn new(source: &'a dyn Source, layout: &'a Layout<'a>, convections: &'a [Convection]) -> Self {
        let width = source.width().next_multiple_of(GROUP);
        Self {
            layout,
            convections,
            reader: source.reader(),
            lines: vec![Line::of(0.0); source.width()],
            plain: Panels::new(width),
            white: Panels::new(width),
            filters: Vec::new(),
            steps: Vec::new(),
            blocks: Lists::default(),
            cells: Lists::default(),
        }
    }

    fn run(&mut self, first: usize, end: usize) -> Vec<Part> {
        let none = || vec![0.0; self.plain.width()];
        let fresh = self.convections.iter().map(|&of| (Filter::new(of), none()));
        self.filters = fresh.collect();
        let log_variance = vec![0.0; self.layout.block_count];
        let empty = Part {
            log_variance,
            ..Part::default()
        };
        let mut parts = vec![empty; self.filters.len()];
        let longest = self.convections.iter().map(|c| c.rho).fold(0.0, f64::max);
        for block in (beginning(self.layout.starts, first, longest)..end).step_by(BLOCK) {
            let count = BLOCK.min(end - block);
            self.reader.read(block, count, &mut self.lines);
            self.plain.fill(&self.lines, count);
            self.sort(first.max(block)..block + count, block);
            for (at, part) in parts.iter_mut().enumerate() {
                self.add(at, block, count, first, part);
            }
        }
        parts
    }

    /// Adds the rows of a block, from a row of the table on, as one filter whitens them.
    fn add(&mut self, at: usize, block: usize, count: usize, first: usize, part: &mut Part) {
        let (filter, state) = &mut self.filters[at];
        self.steps.clear();
        for row in block..block + count {
            let step = filter.step(self.layout.starts[row], self.layout.distance[row]);
            if row >= first {
                part.log_variance[self.layout.blocks[row] as usize] += step.log_variance;
            }
            self.steps.push(step);
        }
        self.white.whiten(&self.plain, &self.steps, state);
        forget(state);
        self.white.leave_out_zeros(count);
        let width = self.white.width();
        let (blocks, cells) = (&mut part.blocks, &mut part.cells);
        self.blocks.add(&self.white, 0, 1, width * width, blocks);
        self.cells.add(&self.white, 0, 1, width, cells);
    }

    /// Sorts rows of the block that begins at a row.
    fn sort(&mut self, rows: core::ops::Range<usize>, block: usize) {
        let lists = [
            (&mut self.blocks, self.layout.blocks),
            (&mut self.cells, self.layout.cells),
        ];
        for (list, labels) in lists {
            list.clear();
            for row in rows.clone() {
                let class = Class {
                    begins: true,
                    own: labels[row],
                    next: None,
                };
                list.push(class, (1 + row - block) as u32);
            }
        }
    }
}
