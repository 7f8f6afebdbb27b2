//! Sums of products for diagnosis, over arrays.

use echocal_core::evidence::{Layout, Products};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

type Sums<'py> = Vec<Bound<'py, PyArray1<f64>>>;

/// Lag-0 and lag-1 products of columns (rows of `columns`) per memory: block sums, then cell sums.
#[pyfunction]
pub fn products<'py>(
    py: Python<'py>,
    columns: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, bool>,
    blocks: PyReadonlyArray1<'py, u32>,
    cells: PyReadonlyArray1<'py, u32>,
    memories: Vec<f64>,
) -> PyResult<Vec<(Sums<'py>, Sums<'py>)>> {
    let lengths = [starts.len(), blocks.len(), cells.len()];
    let rows = columns.shape()[1];
    if lengths != [rows; 3] {
        return Err(PyValueError::new_err("columns and labels differ in length"));
    }
    let columns = columns.as_array();
    let columns: Option<Vec<&[f64]>> = columns.rows().into_iter().map(|c| c.to_slice()).collect();
    let columns = columns.ok_or_else(|| PyValueError::new_err("columns are not contiguous"))?;
    let (blocks, cells) = (blocks.as_slice()?, cells.as_slice()?);
    let count = |labels: &[u32]| labels.iter().max().map_or(0, |&last| last as usize + 1);
    let layout = Layout {
        starts: starts.as_slice()?,
        blocks,
        cells,
        block_count: count(blocks),
        cell_count: count(cells),
    };
    let gathered: Vec<Products> = py.detach(|| {
        let one = |&memory: &f64| Products::gather(&columns, &layout, memory);
        memories.iter().map(one).collect()
    });
    let arrays = |sums: [Vec<f64>; 4]| {
        let arrays = sums.into_iter().map(|sum| PyArray1::from_vec(py, sum));
        arrays.collect()
    };
    let results = gathered.into_iter();
    Ok(results
        .map(|p| (arrays(p.blocks), arrays(p.cells)))
        .collect())
}
