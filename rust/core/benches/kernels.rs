//! Kernels against the memory roof, per row: `cargo bench -p echocal-core`.
#![allow(unsafe_code, missing_docs)]

use divan::Bencher;
use divan::counter::ItemsCount;
use echocal_core::Law;
use echocal_core::batch::{Column, Kernel, Output, echo};
use echocal_core::simd::{InstructionSet, force};
use std::fmt;

/// In the first cache, in the second, in the third, in memory.
const ROWS: [usize; 4] = [1_000, 10_000, 100_000, 4_000_000];
const RANGES: [(f64, f64); 4] = [(1e-3, 3e-2), (-20.0, 60.0), (0.0, 1.0), (6e4, 1.1e5)];
const LAWS: [&str; 4] = ["cramer", "virial", "ideal_gas", "linear"];

fn main() {
    divan::main();
}

struct Case {
    set: InstructionSet,
    law: &'static str,
    rows: usize,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.law, self.set.name(), self.rows)
    }
}

fn cases() -> impl Iterator<Item = Case> {
    let sets = || {
        InstructionSet::ALL
            .into_iter()
            .filter(|set| set.is_available() && *set != InstructionSet::Baseline)
    };
    let of = move |law| {
        ROWS.into_iter()
            .flat_map(move |rows| sets().map(move |set| Case { set, law, rows }))
    };
    LAWS.into_iter().flat_map(of)
}

fn inputs<T>(rows: usize, rounded: fn(f64) -> T) -> Vec<Vec<T>> {
    let spread = |low: f64, high: f64| {
        let at =
            move |row: usize| rounded((high - low).mul_add((row as f64 * 0.618_034).fract(), low));
        (0..rows).map(at).collect()
    };
    RANGES.map(|(low, high)| spread(low, high)).into()
}

/// The least arithmetic on four inputs and one output.
#[divan::bench(args = ROWS)]
fn memory_of_five(bencher: Bencher<'_, '_>, rows: usize) {
    let data = inputs(rows, |x| x);
    let mut output = vec![0.0; rows];
    bencher.counter(ItemsCount::new(rows)).bench_local(|| {
        let rows = output
            .iter_mut()
            .zip(&data[0])
            .zip(&data[1])
            .zip(&data[2])
            .zip(&data[3]);
        for ((((out, a), b), c), d) in rows {
            *out = a + b + c + d;
        }
    });
}

/// The same on two inputs.
#[divan::bench(args = ROWS)]
fn memory_of_three(bencher: Bencher<'_, '_>, rows: usize) {
    let data = inputs(rows, |x| x);
    let mut output = vec![0.0; rows];
    bencher.counter(ItemsCount::new(rows)).bench_local(|| {
        for ((out, a), b) in output.iter_mut().zip(&data[0]).zip(&data[1]) {
            *out = a + b;
        }
    });
}

#[divan::bench(args = cases())]
fn distance(bencher: Bencher<'_, '_>, case: &Case) {
    assert!(force(Some(case.set)));
    let kernel = echo(Output::Distance, Law::parse(case.law).unwrap(), false);
    run(bencher, &*kernel, case.rows, 1);
}

#[divan::bench(args = cases())]
fn distance_in_single(bencher: Bencher<'_, '_>, case: &Case) {
    assert!(force(Some(case.set)));
    let kernel = echo(Output::Distance, Law::parse(case.law).unwrap(), false);
    run_single(bencher, &*kernel, case.rows, 1);
}

fn column<T>(values: &[T]) -> Column {
    Column {
        start: values.as_ptr().cast_mut().cast(),
        stride: if values.len() == 1 {
            0
        } else {
            size_of::<T>().cast_signed()
        },
    }
}

fn target<T>(values: &mut [T]) -> Column {
    Column {
        start: values.as_mut_ptr().cast(),
        stride: size_of::<T>().cast_signed(),
    }
}

fn run(bencher: Bencher<'_, '_>, kernel: &dyn Kernel, rows: usize, threads: usize) {
    let (data, mut output, carbon_dioxide) = (inputs(rows, |x| x), vec![0.0; rows], [4e-4]);
    let mut columns: Vec<_> = data.iter().map(|values| column(values)).collect();
    columns.push(column(&carbon_dioxide));
    let target = target(&mut output);
    bencher.counter(ItemsCount::new(rows)).bench_local(|| {
        // SAFETY: all columns have `rows` rows or are constant; nothing else uses the output.
        unsafe { kernel.run_f64(&columns, target, rows, threads) };
    });
}

fn run_single(bencher: Bencher<'_, '_>, kernel: &dyn Kernel, rows: usize, threads: usize) {
    let (data, mut output, carbon_dioxide) =
        (inputs(rows, |x| x as f32), vec![0.0_f32; rows], [4e-4_f32]);
    let mut columns: Vec<_> = data.iter().map(|values| column(values)).collect();
    columns.push(column(&carbon_dioxide));
    let target = target(&mut output);
    bencher.counter(ItemsCount::new(rows)).bench_local(|| {
        // SAFETY: all columns have `rows` rows or are constant; nothing else uses the output.
        unsafe { kernel.run_f32(&columns, target, rows, threads) };
    });
}
