//! Noise of warm cells that drift through the path of the echo: docs/method/noises.md, Eq. 4.
//!
//! The delays of cells that know nothing of each other add up, and so do their variances: that of the
//! travel time grows in proportion to the path, until caustics bend it upward (Andreeva & Durgin 2005,
//! <https://doi.org/10.1080/17455030500284170>). A cell stays for some rows: white noise beside a
//! first-order autoregression whose variance is proportional to the distance of the row. Air that is warmer along
//! the whole path adds to the delay in proportion to the path, and its variance in proportion to the square. With another
//! distance in every row no lag-1 products whiten that; Kalman's filter (1960,
//! <https://doi.org/10.1115/1.3662552>) does, with the same gains for all columns.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::correlation::{Autoregression, Correlation};
use crate::gram::{
    Class, ClassLists, ClassSums, FilterStep, GROUP, LagProducts, Panels, Reader, RowLayout,
    Source, beginning, forget, join, narrow, triangles,
};
use crate::parallel::in_spans;
use echocal_core::batch::{BLOCK, Line};

/// How the variance of the autocorrelated part depends on the distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Many cells, independent of each other: in proportion to the distance.
    Cells,
    /// Air that is alike along the whole path: in proportion to the square of the distance.
    Whole,
}

/// White noise, and an autocorrelated part that grows with the distance.
///
/// Covariance of lag k in units of the white noise: growth sqrt(d_i d_j) rho^k, and 1 more at lag 0; where
/// the air is alike along the whole path: (growth d_i d_j rho^k + \[k = 0\]) / (1 + growth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convection {
    /// Autoregressive coefficient of the autocorrelated part.
    pub rho: f64,
    /// Variance of the autocorrelated part over that of the white one, at one meter.
    pub growth: f64,
    /// How it depends on the distance.
    pub path: Path,
}

impl Convection {
    /// Variance of the white part, in units of the noise: of the white part itself; with air that is alike along
    /// the whole path, of both parts at one meter, because the white one may be next to nothing.
    fn white(self) -> f64 {
        match self.path {
            Path::Cells => 1.0,
            Path::Whole => 1.0 / (1.0 + self.growth),
        }
    }

    /// Variance of the autocorrelated part at one meter, in the same units.
    fn shared(self) -> f64 {
        self.growth * self.white()
    }

    /// Standard deviation of the autocorrelated part at a distance \[m\] over that at one meter.
    fn at(self, distance: f64) -> f64 {
        match self.path {
            Path::Cells => distance.max(0.0).sqrt(),
            Path::Whole => distance.max(0.0),
        }
    }
}

/// Kalman's filter for an autocorrelated part of variance 1 at a distance of one meter.
#[derive(Clone, Copy, Debug)]
struct Filter {
    of: Convection,
    /// Variance of the autocorrelated part given the rows before.
    variance: f64,
}

impl Filter {
    fn new(of: Convection) -> Self {
        Self {
            of,
            variance: of.shared(),
        }
    }

    /// The step of the next row, at its distance \[m\]: it whitens docs/method/noises.md, Eq. 4.
    fn step(&mut self, begins: bool, distance: f64) -> FilterStep {
        let (rho, shared) = (self.of.rho, self.of.shared());
        let root = self.of.at(distance);
        if begins {
            self.variance = shared;
        }
        let whole = self.of.white() + root * root * self.variance;
        let gain = self.variance * root / whole;
        self.variance =
            rho * rho * (1.0 - gain * root) * self.variance + (1.0 - rho * rho) * shared;
        let known = if begins { 0.0 } else { 1.0 };
        FilterStep {
            from: known * root,
            scale: 1.0 / whole.sqrt(),
            kept: known * rho * (1.0 - gain * root),
            taken: rho * gain,
            log_variance: whole.ln(),
        }
    }
}

impl Correlation for Convection {
    /// One pass over the rows for all convections; the sums are those of white rows.
    fn gather(
        source: &dyn Source,
        layout: &RowLayout<'_>,
        models: &[Self],
        threads: usize,
    ) -> Vec<LagProducts> {
        let rows = layout.starts.len();
        assert!(source.rows() == rows && layout.distance.len() == rows);
        assert!(layout.blocks.len() == rows && layout.cells.len() == rows);
        let worker = || {
            let mut span = Span::new(source, layout, models);
            move |first, end| span.run(first, end)
        };
        let mut whole = vec![Part::default(); models.len()];
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

    /// Each row in units of the white noise.
    fn whitened(
        self,
        _autoregression: Autoregression,
        values: &[f64],
        starts: &[bool],
        distance: &[f64],
    ) -> (Vec<f64>, f64) {
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

    #[cfg(test)]
    fn examples() -> Vec<(Self, f64)> {
        [
            (0.8, 0.7, Path::Cells),
            (0.97, 3.0, Path::Cells),
            (0.8, 2.0, Path::Whole),
        ]
        .map(|(rho, growth, path)| (Self { rho, growth, path }, 0.0))
        .into()
    }

    #[cfg(test)]
    fn covariance(self, _rho: f64, lag: usize, [one, other]: [f64; 2]) -> f64 {
        let shared = self.shared() * self.at(one) * self.at(other) * self.rho.powi(lag as i32);
        shared + self.white() * f64::from(u8::from(lag == 0))
    }
}

/// The sums of a span, or of all, for one convection.
#[derive(Clone, Default)]
struct Part {
    blocks: ClassSums,
    cells: ClassSums,
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

    /// All of it as products of rows that begin a series: whitened rows are independent.
    fn products(self, layout: &RowLayout<'_>, width: usize, columns: usize) -> LagProducts {
        let placed = |kinds: &ClassSums, count: usize, length: usize| {
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
        LagProducts {
            log_variance: self.log_variance,
            cells: only(cells),
            blocks: only(blocks),
            edges: Vec::new(),
        }
    }
}

/// One thread's memory.
struct Span<'a> {
    layout: &'a RowLayout<'a>,
    convections: &'a [Convection],
    reader: Box<dyn Reader + 'a>,
    lines: Vec<Line>,
    plain: Panels,
    white: Panels,
    /// Each filter, and the state of every column.
    filters: Vec<(Filter, Vec<f64>)>,
    steps: Vec<FilterStep>,
    blocks: ClassLists,
    cells: ClassLists,
}

impl<'a> Span<'a> {
    fn new(source: &'a dyn Source, layout: &'a RowLayout<'a>, convections: &'a [Convection]) -> Self {
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
            blocks: ClassLists::default(),
            cells: ClassLists::default(),
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
