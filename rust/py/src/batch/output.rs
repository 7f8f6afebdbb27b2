//! What may be given as `out`.

use numpy::PyUntypedArray;
use numpy::prelude::*;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors::raise;

/// Refuses an array of which elements share memory: which row such a place keeps, nobody knows.
///
/// Arrays that NumPy makes, slices them, turns them round or transposes them are nested: each axis
/// steps over all that the axes of shorter steps reach. A view of strides made by hand that is not
/// so is refused as well: finding out whether its elements meet would take a look at each.
///
/// Whatever else does not fit, NumPy refuses; see `explain`.
pub fn check(out: &Bound<'_, PyAny>) -> PyResult<()> {
    if let Ok(several) = out.cast_exact::<PyTuple>() {
        return several.iter().try_for_each(|one| check(&one));
    }
    let Ok(array) = out.cast::<PyUntypedArray>() else {
        return Ok(());
    };
    if is_nested(array.shape(), array.strides(), array.dtype().itemsize()) {
        return Ok(());
    }
    let message = format!(
        "out has shape {:?} and strides {:?}, so that its elements share memory, or may; give an array \
         with memory for each, such as numpy.empty(shape)",
        array.shape(),
        array.strides()
    );
    Err(raise("UsageError", message))
}

/// Whether each axis steps over all that the axes of shorter steps reach.
fn is_nested(shape: &[usize], strides: &[isize], size: usize) -> bool {
    if shape.contains(&0) {
        return true;
    }
    let axes = strides.iter().map(|stride| stride.unsigned_abs());
    let mut axes: Vec<_> = axes.zip(shape).filter(|&(_, &count)| count > 1).collect();
    axes.sort_unstable();
    let mut span = size; // bytes that the axes so far reach over
    axes.into_iter().all(|(step, &count)| {
        let over = step >= span;
        span = span.saturating_add(step.saturating_mul(count - 1));
        over
    })
}
