//! Which rows of a table belong together.

/// How rows belong together.
#[derive(Clone, Copy, Debug)]
pub struct RowLayout<'a> {
    /// Whether a row begins a new series: nothing is remembered across.
    pub starts: &'a [bool],
    /// The block of each row.
    pub blocks: &'a [u32],
    /// The cell of each row; a cell lies within one block.
    pub cells: &'a [u32],
    /// The distance of each row \[m\].
    pub distance: &'a [f64],
    /// Number of blocks.
    pub block_count: usize,
    /// Number of cells.
    pub cell_count: usize,
}
