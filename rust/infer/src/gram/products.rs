//! What a pass over the rows leaves of its columns: sums of products by block and by cell.

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
}
