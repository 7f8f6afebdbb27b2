//! Fits to some blocks of a table under one noise: only the columns in use are whitened.

use super::fit::HypothesisFit;
use super::hypothesis::{Variant, columns};
use super::log_evidence::log_evidence;
use super::stack::WhitenedStack;
use crate::noise::{NoiseModel, TableSums};

/// Which rows are fitted, and what is known of them beforehand.
#[derive(Clone, Copy, Debug)]
pub struct Fitted<'a> {
    /// Whether each block is in use.
    pub blocks: &'a [bool],
    /// Rows less unknown levels.
    pub degrees: f64,
    /// Smallest variance of noise that is assumed.
    pub variance_floor: f64,
}

/// As [`log_evidence`], of hypotheses on some blocks under one noise.
#[must_use]
pub fn fit_blocks(
    sums: &TableSums,
    noise: &NoiseModel,
    fitted: &Fitted<'_>,
    hypotheses: &[Vec<Variant>],
    one_width: bool,
    threads: usize,
) -> Vec<HypothesisFit> {
    let mut chosen = columns(hypotheses.iter().flatten(), sums.width() - 1);
    if chosen[0] != 0 {
        chosen.insert(0, 0); // what a group's own level adds
    }
    let (products, log_weight) = sums.whiten(&[*noise], fitted.blocks, &chosen, threads);
    let stack = WhitenedStack {
        products: &products,
        log_weight: &log_weight,
        width: chosen.len(),
        degrees: fitted.degrees,
        variance_floor: fitted.variance_floor,
    };
    let place = |column: &usize| chosen.partition_point(|other| other < column);
    let moved = |variant: &Variant| Variant {
        offsets: variant.offsets.iter().map(place).collect(),
        free: variant.free.iter().map(place).collect(),
        ..variant.clone()
    };
    let each = hypotheses.iter();
    let moved: Vec<Vec<Variant>> = each.map(|one| one.iter().map(moved).collect()).collect();
    log_evidence(&stack, &moved, one_width, threads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::FromParts;
    use crate::gram::LagProducts;
    use std::sync::Arc;

    fn variant(free: usize) -> Variant {
        Variant {
            cause: free,
            is_unexplained: false,
            offsets: Vec::new(),
            free: vec![free],
            bounds: vec![(f64::NEG_INFINITY, f64::INFINITY)],
            weight: 1.0,
        }
    }

    #[test]
    fn other_columns_do_not_matter() {
        let width = 4; // the group's own, two causes, what is to be explained
        let block = |seed: f64| -> Vec<f64> {
            let column =
                |i: usize, row: usize| ((i * 7 + row * 3) as f64 * 0.755 + seed).fract() - 0.5;
            let product = |i, j| (0..30).map(|row| column(i, row) * column(j, row)).sum();
            (0..width * width)
                .map(|at| product(at / width, at % width))
                .collect()
        };
        let first = [block(0.1), block(0.3)].concat();
        let cells = first
            .chunks(width * width)
            .flat_map(|one| one[..width].to_vec());
        let sums = TableSums {
            products: vec![Arc::new(LagProducts {
                cells: [vec![], vec![], vec![], cells.collect()],
                blocks: [vec![], vec![], vec![], first],
                log_variance: vec![0.0; 2],
                edges: vec![],
            })],
            columns: Arc::new(FromParts::same(width)),
            cells: vec![(0, 0), (1, 1)],
            series: vec![30.0; 2],
            flat_level: false,
            finite: vec![true; width],
        };
        let noise = NoiseModel {
            correlation: 0,
            rho: 0.0,
            station_ratio: 0.1,
            first_weight: 1.0,
            log_prior: -1.0,
        };
        let hypotheses = [vec![variant(2)], vec![variant(1), variant(2)], vec![]];
        let fitted = Fitted {
            blocks: &[false, true],
            degrees: 30.0,
            variance_floor: 1e-18,
        };
        let found = fit_blocks(&sums, &noise, &fitted, &hypotheses, false, 1);
        let (products, log_weight) = sums.whiten(&[noise], fitted.blocks, &[0, 1, 2, 3], 1);
        let stack = WhitenedStack {
            products: &products,
            log_weight: &log_weight,
            width,
            degrees: fitted.degrees,
            variance_floor: fitted.variance_floor,
        };
        let expected = log_evidence(&stack, &hypotheses, false, 1);
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.log_evidence, expected.log_evidence);
            assert_eq!(found.mean, expected.mean);
            assert_eq!(found.covariance, expected.covariance);
        }
        assert_ne!(found[0].log_evidence, found[2].log_evidence);
    }
}
