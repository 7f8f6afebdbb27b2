//! Kernels of the core as real NumPy ufuncs.
//!
//! NumPy then does the broadcasting, the type resolution, `out=`, `where=` and the copies for
//! overlapping memory, and releases the GIL around the loop; pandas, xarray, dask and polars hand
//! their data in and take the result back as their own type.
#![allow(unsafe_code)]

use core::cell::Cell;
use core::ffi::{c_char, c_int, c_void};
use std::ffi::CString;
use std::sync::Arc;

use echocal_core::batch::{Column, Kernel, is_row_by_row};
use numpy::npyffi::{NPY_TYPES, PY_UFUNC_API, PyUFuncGenericFunction, PyUFuncObject, npy_intp};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

use super::precision::Precision;

/// More inputs than any kernel has.
pub const MOST_INPUTS: usize = 32;

thread_local! {
    /// Threads that a loop called by this thread may use. One, unless a function of this package
    /// asks for more: whoever calls a ufunc from elsewhere (dask, polars) brings its own threads.
    static THREADS: Cell<usize> = const { Cell::new(1) };
}

/// Calls `inner` with this many threads allowed to the loops that it runs.
pub fn with_threads<R>(threads: usize, inner: impl FnOnce() -> R) -> R {
    struct Restore(usize);
    impl Drop for Restore {
        fn drop(&mut self) {
            THREADS.set(self.0);
        }
    }
    let _restore = Restore(THREADS.replace(threads));
    inner()
}

/// What a ufunc refers to for as long as it lives.
struct Backing {
    kernel: Arc<dyn Kernel>,
    loops: [PyUFuncGenericFunction; 2],
    data: [*mut c_void; 2],
    types: Vec<c_char>,
    name: CString,
}

// SAFETY: the pointers lead to the backing's own kernel, which is `Send` and `Sync`.
unsafe impl Send for Backing {}

/// A ufunc of this name for a kernel, with a loop for single and one for double precision.
pub fn ufunc<'py>(
    py: Python<'py>,
    name: &str,
    kernel: Arc<dyn Kernel>,
) -> PyResult<Bound<'py, PyAny>> {
    let arity = kernel.arity();
    assert!(arity < MOST_INPUTS);
    let letters = [NPY_TYPES::NPY_FLOAT, NPY_TYPES::NPY_DOUBLE];
    let types = letters
        .map(|letter| vec![letter as c_char; arity + 1])
        .concat();
    let backing = Backing {
        kernel,
        loops: [Some(run::<f32>), Some(run::<f64>)],
        data: [core::ptr::null_mut(); 2],
        types,
        name: CString::new(name)?,
    };
    let capsule = PyCapsule::new_with_value(py, backing, c"echocal.kernel")?;
    let place = capsule
        .pointer_checked(Some(c"echocal.kernel"))?
        .cast::<Backing>();
    // SAFETY: the capsule holds a `Backing` at this address until the ufunc drops it; nobody else
    // knows the address yet. The arrays have the lengths that are given with them.
    unsafe {
        let backing = &mut *place.as_ptr();
        backing.data = [(&raw mut backing.kernel).cast(); 2];
        let made = PY_UFUNC_API.PyUFunc_FromFuncAndData(
            py,
            backing.loops.as_mut_ptr(),
            backing.data.as_mut_ptr(),
            backing.types.as_mut_ptr(),
            2,
            arity as c_int,
            1,
            NO_IDENTITY,
            backing.name.as_ptr(),
            c"A kernel of echocal; see the function of the same name.".as_ptr(),
            0,
        );
        let ufunc = Bound::from_owned_ptr_or_err(py, made)?;
        (*made.cast::<PyUFuncObject>()).fields.obj = capsule.into_ptr();
        Ok(ufunc)
    }
}

/// `PyUFunc_None` of NumPy's C API: there is nothing to reduce over.
const NO_IDENTITY: c_int = -1;

/// NumPy's strided loop: without the GIL, on aligned memory.
///
/// NumPy copies inputs that share memory with the output, but for those whose rows a loop in order
/// has read before it overwrites them. Threads begin in the middle, where the output of one meets the
/// input of the next, so such an input is left to one thread.
unsafe extern "C" fn run<T: Precision>(
    columns: *mut *mut c_char,
    rows: *mut npy_intp,
    strides: *mut npy_intp,
    kernel: *mut c_void,
) {
    let before = float_status();
    // SAFETY: `ufunc` registered the address of a shared kernel, and NumPy gives one address and one
    // stride for each of its inputs and for the output.
    unsafe {
        let kernel = &**kernel.cast::<Arc<dyn Kernel>>();
        let column = |index: usize| Column {
            start: (*columns.add(index)).cast(),
            stride: *strides.add(index),
        };
        let mut inputs = [column(0); MOST_INPUTS];
        for (index, input) in inputs.iter_mut().enumerate().take(kernel.arity()) {
            *input = column(index);
        }
        let inputs = &inputs[..kernel.arity()];
        let output = column(kernel.arity());
        let rows = usize::try_from(*rows).unwrap_or(0);
        let shared_out = inputs
            .iter()
            .all(|input| is_row_by_row::<T>(*input, output, rows));
        let threads = if shared_out { THREADS.get() } else { 1 };
        T::run(kernel, inputs, output, rows, threads);
    }
    // Comparisons with NaN raise "invalid" by definition; NaN in and NaN out is no news here.
    set_float_status(before);
}

#[cfg(target_arch = "x86_64")]
fn float_status() -> u64 {
    let mut status = 0_u32;
    // SAFETY: stores the SSE control and status register, which every x86-64 processor has.
    unsafe { core::arch::asm!("stmxcsr [{}]", in(reg) &raw mut status, options(nostack)) };
    status.into()
}

#[cfg(target_arch = "x86_64")]
fn set_float_status(status: u64) {
    let status = status as u32;
    // SAFETY: loads what `float_status` stored.
    unsafe { core::arch::asm!("ldmxcsr [{}]", in(reg) &raw const status, options(nostack)) };
}

#[cfg(target_arch = "aarch64")]
fn float_status() -> u64 {
    let status: u64;
    // SAFETY: reads the floating-point status register.
    unsafe { core::arch::asm!("mrs {}, fpsr", out(reg) status, options(nomem, nostack)) };
    status
}

#[cfg(target_arch = "aarch64")]
fn set_float_status(status: u64) {
    // SAFETY: writes back what `float_status` read.
    unsafe { core::arch::asm!("msr fpsr, {}", in(reg) status, options(nomem, nostack)) };
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn float_status() -> u64 {
    0
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn set_float_status(_: u64) {}
