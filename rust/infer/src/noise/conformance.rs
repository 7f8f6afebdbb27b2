//! What every model of correlated noise in the registry must fulfil.

use super::{Autoregression, NoiseCorrelation, covariance, examples};
use crate::gram::{LagProducts, RowLayout, Stored};

/// Rows of a table of two series.
const ROWS: usize = 120;
/// Row at which the second series begins.
const SECOND: usize = 50;
/// Rows after which what a filter does not know about a series' beginning is forgotten: the largest
/// moving-average coefficient among the examples is 0.5, and `0.5^40 = 1e-12`.
const SETTLED: usize = 40;

struct Table {
    values: Vec<f64>,
    starts: Vec<bool>,
    distance: Vec<f64>,
    labels: Vec<u32>,
}

fn table() -> Table {
    let each = |of: &dyn Fn(usize) -> f64| (0..ROWS).map(of).collect::<Vec<f64>>();
    Table {
        values: each(&|row| (row as f64 * 0.754_877).fract() - 0.5),
        starts: (0..ROWS).map(|row| row == 0 || row == SECOND).collect(),
        distance: each(&|row| 0.2 + 3.0 * (row as f64 * 0.569_84).fract()),
        labels: vec![0; ROWS],
    }
}

impl Table {
    fn layout(&self) -> RowLayout<'_> {
        RowLayout {
            starts: &self.starts,
            blocks: &self.labels,
            cells: &self.labels,
            distance: &self.distance,
            block_count: 1,
            cell_count: 1,
        }
    }
}

/// The autoregression of a model: the variance of the process is its covariance at lag 0.
fn autoregression(model: NoiseCorrelation, rho: f64) -> Autoregression {
    Autoregression {
        rho,
        first_weight: 1.0 / covariance(model, rho, 0, [1.0; 2]),
    }
}

/// White rows of the first series by Cholesky's factor of its covariance, and the log of its
/// determinant: the slow and obvious way.
fn by_cholesky(model: NoiseCorrelation, rho: f64, table: &Table) -> (Vec<f64>, f64) {
    let (mut factor, mut white, mut log) = (vec![[0.0; SECOND]; SECOND], Vec::new(), 0.0);
    for i in 0..SECOND {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let distances = [table.distance[i], table.distance[j]];
            let left = covariance(model, rho, i - j, distances) - known;
            factor[i][j] = if i == j {
                left.sqrt()
            } else {
                left / factor[j][j]
            };
        }
        let known: f64 = (0..i).map(|k| factor[i][k] * white[k]).sum();
        white.push((table.values[i] - known) / factor[i][i]);
        log += 2.0 * factor[i][i].ln();
    }
    (white, log)
}

#[test]
fn whitened_series_are_those_of_the_covariance() {
    let table = table();
    for (model, rho) in examples() {
        let own = autoregression(model, rho);
        let (found, _) = model.whitened(own, &table.values, &table.starts, &table.distance);
        let (white, _) = by_cholesky(model, rho, &table);
        for row in SETTLED..SECOND {
            let error = found[row] - white[row];
            assert!(error.abs() < 1e-9, "{model:?} row {row}: {error}");
        }
    }
}

/// With a moving average the first rows are approximate, and so is the determinant.
#[test]
fn determinants_are_those_of_the_covariance() {
    let table = table();
    for (model, rho) in examples() {
        if matches!(model, NoiseCorrelation::MovingAverage(own) if own.coefficient != 0.0) {
            continue;
        }
        let own = autoregression(model, rho);
        let first = &table.starts[..SECOND];
        let (_, log) = model.whitened(
            own,
            &table.values[..SECOND],
            first,
            &table.distance[..SECOND],
        );
        let (_, slow) = by_cholesky(model, rho, &table);
        assert!((log - slow).abs() < 1e-9, "{model:?}: {log} {slow}");
    }
}

#[test]
fn nothing_is_carried_across_series() {
    let table = table();
    for (model, rho) in examples() {
        let own = autoregression(model, rho);
        let whole = model.whitened(own, &table.values, &table.starts, &table.distance);
        let parts = [0..SECOND, SECOND..ROWS].map(|rows| {
            let (values, starts) = (&table.values[rows.clone()], &table.starts[rows.clone()]);
            model.whitened(own, values, starts, &table.distance[rows])
        });
        let joined: Vec<f64> = parts.iter().flat_map(|part| part.0.clone()).collect();
        assert_eq!(whole.0, joined, "{model:?}");
        assert!(
            (whole.1 - parts[0].1 - parts[1].1).abs() < 1e-12,
            "{model:?}"
        );
    }
}

/// Sum of squares of a whitened column from the sums of a pass.
fn square(sums: &LagProducts, own: Autoregression) -> f64 {
    let rho = own.rho;
    let factors = [1.0, rho * rho, -2.0 * rho, own.first_weight];
    let each = sums.blocks.iter().zip(factors);
    each.map(|(block, factor)| block.get(3).map_or(0.0, |sum| factor * sum))
        .sum()
}

#[test]
fn sums_of_a_pass_are_those_of_the_whitened_series() {
    let table = table();
    let ones = vec![1.0; ROWS];
    let stored = Stored(vec![&ones, &table.values]);
    let (models, rhos): (Vec<_>, Vec<_>) = examples().into_iter().unzip();
    let all = NoiseCorrelation::gather(&stored, &table.layout(), &models, 1);
    assert_eq!(all.len(), models.len());
    for ((&model, rho), sums) in models.iter().zip(rhos).zip(&all) {
        let mut own = autoregression(model, rho);
        let (white, log) = model.whitened(own, &table.values, &table.starts, &table.distance);
        if sums.blocks[0].is_empty() {
            own.first_weight = 1.0; // every row is white by itself
        }
        let expected: f64 = white.iter().map(|value| value * value).sum();
        let found = square(sums, own);
        assert!(
            (found - expected).abs() < 1e-10,
            "{model:?}: {found} {expected}"
        );
        let beside = 2.0 * own.first_weight.ln(); // of two first rows
        assert!(
            (sums.log_variance[0] - beside - log).abs() < 1e-10,
            "{model:?}"
        );
        assert_eq!(
            *sums,
            NoiseCorrelation::gather(&stored, &table.layout(), &[model], 2)[0]
        );
    }
}
