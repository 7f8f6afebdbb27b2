//! Kernels against the memory roof, per row: `cargo bench -p echocal-core`.
#![allow(unsafe_code, missing_docs)]

use divan::Bencher;
use divan::counter::ItemsCount;
use echocal_core::Law;
use echocal_core::batch::{Column, Kernel, Output, echo};

const ROWS: usize = 4_000_000;
const RANGES: [(f64, f64); 4] = [(1e-3, 3e-2), (-20.0, 60.0), (0.0, 1.0), (6e4, 1.1e5)];

fn main() {
    divan::main();
}

fn inputs() -> Vec<Vec<f64>> {
    let spread = |low: f64, high: f64| {
        let at = move |row: usize| (high - low).mul_add((row as f64 * 0.618_034).fract(), low);
        (0..ROWS).map(at).collect()
    };
    RANGES.map(|(low, high)| spread(low, high)).into()
}

/// The least arithmetic on four inputs and one output.
#[divan::bench]
fn memory_of_five(bencher: Bencher<'_, '_>) {
    let data = inputs();
    let mut output = vec![0.0; ROWS];
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
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

#[divan::bench(args = ["cramer", "virial", "ideal_gas", "linear"])]
fn distance(bencher: Bencher<'_, '_>, law: &str) {
    let kernel = echo(Output::Distance, Law::parse(law).unwrap(), false);
    run(bencher, &*kernel, 1);
}

#[divan::bench(args = [1, 2])]
fn distance_on_threads(bencher: Bencher<'_, '_>, threads: usize) {
    let kernel = echo(Output::Distance, Law::parse("cramer").unwrap(), false);
    run(bencher, &*kernel, threads);
}

fn run(bencher: Bencher<'_, '_>, kernel: &dyn Kernel, threads: usize) {
    let (data, mut output, carbon_dioxide) = (inputs(), vec![0.0; ROWS], [4e-4]);
    let column = |values: &[f64]| Column {
        start: values.as_ptr().cast_mut().cast(),
        stride: if values.len() == 1 { 0 } else { 8 },
    };
    let mut columns: Vec<_> = data.iter().map(|values| column(values)).collect();
    columns.push(column(&carbon_dioxide));
    let target = Column {
        start: output.as_mut_ptr().cast(),
        stride: 8,
    };
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
        // SAFETY: all columns have `ROWS` rows or are constant; nothing else uses the output.
        unsafe { kernel.run_f64(&columns, target, ROWS, threads) };
    });
}
