//! Which rows of a table belong together, checked.

use echocal_infer::gram::RowLayout;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::HashMap;

use crate::border::{same_length, within};

/// Block and group of each cell.
type Places = Vec<(usize, usize)>;

/// Which rows of a table belong together, checked; `places` has block and group of each cell.
///
/// They come back with groups counted from 0, in the order in which they appear: of some rows of a
/// table, groups may keep the labels that they have in all of it.
pub fn layout<'a>(
    starts: &'a [bool],
    blocks: &'a [u32],
    cells: &'a [u32],
    distance: &'a [f64],
    rows: usize,
    places: &[(usize, usize)],
    block_count: usize,
) -> PyResult<(RowLayout<'a>, Places)> {
    same_length(&[
        ("the table", rows),
        ("starts", starts.len()),
        ("blocks", blocks.len()),
        ("cells", cells.len()),
        ("distance", distance.len()),
    ])?;
    let of = |label: &u32| *label as usize;
    within("block", blocks.iter().map(of), block_count)?;
    within("cell", cells.iter().map(of), places.len())?;
    within("block", places.iter().map(|place| place.0), block_count)?;
    let elsewhere = |row: &usize| places[cells[*row] as usize].0 != blocks[*row] as usize;
    if let Some(row) = (0..rows).find(elsewhere) {
        let (block, cell) = (blocks[row], cells[row]);
        let message =
            format!("row {row} is of block {block} and of cell {cell}, which lies in another");
        return Err(PyValueError::new_err(message));
    }
    let layout = RowLayout {
        starts,
        blocks,
        cells,
        distance,
        block_count,
        cell_count: places.len(),
    };
    let mut counted = HashMap::new();
    let counted = |&(block, group): &(usize, usize)| {
        let next = counted.len();
        (block, *counted.entry(group).or_insert(next))
    };
    Ok((layout, places.iter().map(counted).collect()))
}

/// Refuses numbers of series that are not those of the rows that begin one.
pub fn same_series(series: &[f64], of: &RowLayout<'_>) -> PyResult<()> {
    let mut counted = vec![0.0; series.len()];
    for (&block, _) in of
        .blocks
        .iter()
        .zip(of.starts)
        .filter(|(_, starts)| **starts)
    {
        counted[block as usize] += 1.0;
    }
    match series
        .iter()
        .zip(&counted)
        .position(|(given, counted)| given != counted)
    {
        None => Ok(()),
        Some(block) => {
            let (given, counted) = (series[block], counted[block]);
            let message =
                format!("block {block} has {given} series, but {counted} of its rows begin one");
            Err(PyValueError::new_err(message))
        }
    }
}
