//! What may be given as `out`.

use numpy::PyUntypedArray;
use numpy::prelude::*;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors::raise;

/// Refuses an array that holds one number in the place of several: which row it keeps, nobody knows.
///
/// Whatever else does not fit, NumPy refuses; see `explain`.
pub fn check(out: &Bound<'_, PyAny>) -> PyResult<()> {
    if let Ok(several) = out.cast_exact::<PyTuple>() {
        return several.iter().try_for_each(|one| check(&one));
    }
    let Ok(array) = out.cast::<PyUntypedArray>() else {
        return Ok(());
    };
    if !overlaps_itself(array.shape(), array.strides(), array.dtype().itemsize()) {
        return Ok(());
    }
    let message = format!(
        "out has shape {:?} and strides {:?}, so that several of its elements share memory; give an \
         array with memory for each, such as numpy.empty(shape)",
        array.shape(),
        array.strides()
    );
    Err(raise("UsageError", message))
}

/// Whether two elements of an array share a byte.
fn overlaps_itself(shape: &[usize], strides: &[isize], size: usize) -> bool {
    if shape.contains(&0) {
        return false;
    }
    let axes = strides.iter().map(|stride| stride.unsigned_abs());
    let mut axes: Vec<_> = axes.zip(shape).filter(|&(_, &count)| count > 1).collect();
    axes.sort_unstable();
    let mut span = size; // bytes that the axes so far reach over
    let mut nested = true;
    for &(step, &count) in &axes {
        nested &= step >= span;
        span = span.saturating_add(step.saturating_mul(count - 1));
    }
    if nested {
        return false;
    }
    let each = axes.iter().map(|&(_, &count)| count);
    let bytes = each.fold(size, usize::saturating_mul);
    bytes > span || starts_overlap(&axes, size)
}

/// Whether two elements start less than one element apart, each looked at: their bytes fit the span.
fn starts_overlap(axes: &[(usize, &usize)], size: usize) -> bool {
    let mut starts = vec![0];
    for &(step, &count) in axes {
        let more = starts
            .iter()
            .flat_map(|start| (0..count).map(move |k| start + k * step));
        starts = more.collect();
    }
    starts.sort_unstable();
    starts.windows(2).any(|pair| pair[1] - pair[0] < size)
}
