//! What a pass over the rows leaves of its columns: sums of products by block and by cell.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

/// Sums of products of `width` columns for one filter of the rows.
///
/// With `z_t` the filtered row, `present` sums `z_t z_t'` over rows that follow another row of their series, `previous` sums
/// `z_(t-1) z_(t-1)'`, `lagged` sums the symmetric part of `z_t z_(t-1)'` over the same rows,
/// `first` sums `z_t z_t'` over rows that begin a series. Block sums are `width * width` each and
/// symmetric; cell sums are the row of the first column, where `lagged` is doubled. Sums over rows of
/// which there are none are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct LagProducts {
    /// Products per block: present, previous, lagged, first.
    pub blocks: [Vec<f64>; 4],
    /// Products of the first column per cell: present, previous, lagged (both ways), first.
    pub cells: [Vec<f64>; 4],
    /// Sum of the log variances that rows were whitened with, per block.
    pub log_variance: Vec<f64>,
    /// First rows of blocks in the midst of a series.
    pub edges: Vec<Edge>,
}

/// The first row of a block, which follows a row of another block in its series.
///
/// Where that other block is not in use, the row begins a series: what it adds to the sums with the row
/// before it is taken off, and what it adds as a first row is put in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Its block.
    pub block: usize,
    /// The block of the row before it.
    pub before: usize,
    /// Its cell.
    pub cell: usize,
    /// The row as it is.
    pub plain: Vec<f64>,
    /// The filtered row.
    pub own: Vec<f64>,
    /// The filtered row before it.
    pub previous: Vec<f64>,
}

impl Edge {
    /// What the row adds less as one that follows, and more as one that begins, to sums of products of
    /// `width` columns: present, previous, lagged, first; of the columns from `rows` on both sides.
    pub(crate) fn begin(&self, sums: &mut [Vec<f64>; 4], at: usize, rows: usize, lagged: f64) {
        let width = self.plain.len();
        for row in 0..rows {
            let place = at + row * width;
            let (x, own, previous) = (self.plain[row], self.own[row], self.previous[row]);
            for column in 0..width {
                let to = place + column;
                sums[0][to] -= own * self.own[column];
                sums[1][to] -= previous * self.previous[column];
                sums[2][to] -= lagged * (own * self.previous[column] + previous * self.own[column]);
                sums[3][to] += x * self.plain[column];
            }
        }
    }
}
