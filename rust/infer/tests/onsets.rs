//! Columns of effects that set in somewhere, made in parts, against the columns themselves.

use echocal_core::batch::Numbers;
use echocal_core::model::Term;
use echocal_core::{Law, Model, Quantity};
use echocal_infer::columns::{Columns, Distinct, FromParts, Level, Recipe};
use echocal_infer::gram::{LagProducts, RowLayout};
use echocal_infer::noise::{Correlation, MovingAverage, NoiseModel, TableSums};
use std::sync::Arc;

const ROWS: usize = 1500;

fn recipes() -> Option<Vec<Recipe>> {
    let tangent = |id, parameters: &[(&str, f64)], scale| {
        let term = Term::new(id, parameters).ok()?;
        Some(Recipe::Tangent(term, Level::OfBase, 0, scale))
    };
    let step = |time, scale| tangent("step_change", &[("time", time)], scale);
    [
        Some(Recipe::Slope),
        step(400.0, 0.3),
        step(700.5, 0.3),
        tangent("reference_scale", &[], 0.1),
        step(700.5, 0.5),
        step(20.0, 0.3),
        step(1400.0, 0.3),
    ]
    .into_iter()
    .collect()
}

/// Whitened products of all columns under some noises, from the sums of the columns or of their parts.
fn whitened(products: Vec<LagProducts>, columns: FromParts) -> Vec<f64> {
    let noises = [(0, 0.6, 0.0), (1, 0.8, 0.3), (2, 0.95, 2.0)];
    let noises = noises.map(|(correlation, rho, station_ratio)| NoiseModel {
        correlation,
        rho,
        station_ratio,
        first_weight: 0.5,
        log_prior: 0.0,
    });
    let chosen: Vec<usize> = (0..columns.columns()).collect();
    let sums = TableSums {
        products: products.into_iter().map(Arc::new).collect(),
        columns: Arc::new(columns),
        cells: vec![(0, 0), (1, 1)],
        series: vec![2.0, 1.0],
        flat_level: false,
        finite: Vec::new(),
    };
    sums.whiten(&noises, &[true, true], &chosen, 1).0
}

#[test]
fn the_sums_are_those_of_the_columns() {
    let (Some(recipes), Ok(law)) = (recipes(), Law::parse("linear")) else {
        unreachable!("effects and law are in the catalog")
    };
    let (base, twenty) = (Model::new(law), 20.0);
    let distance: Vec<f64> = (0..ROWS).map(|row| 1.0 + (row % 7) as f64).collect();
    let ascending: Vec<f64> = (0..ROWS).map(|row| row as f64).collect();
    let shuffled: Vec<f64> = (0..ROWS).map(|row| (row * 701 % ROWS) as f64).collect();
    let starts: Vec<bool> = (0..ROWS).map(|row| row % 600 == 0).collect();
    let labels: Vec<u32> = (0..ROWS).map(|row| u32::from(row > 800)).collect();
    let layout = RowLayout {
        starts: &starts,
        blocks: &labels,
        cells: &labels,
        distance: &distance,
        block_count: 2,
        cell_count: 2,
    };
    for elapsed in [&ascending, &shuffled] {
        let mut recorded = [Numbers::All(&twenty); Quantity::COUNT];
        recorded[Quantity::ElapsedTime as usize] = Numbers::Each(elapsed);
        let columns = Columns {
            base: &base,
            distance: &distance,
            recorded,
            stored: Vec::new(),
            groups: None,
            recipes: &recipes,
            taken: Vec::new(),
        };
        let distinct = Distinct::of(&columns);
        assert_eq!(distinct.recipes.len(), recipes.len() - 1);
        let models = [0.0, 0.5, 0.9].map(|coefficient| MovingAverage { coefficient });
        let parts = MovingAverage::gather(&distinct.among(&columns), &layout, &models, 1);
        let whole = MovingAverage::gather(&columns, &layout, &models, 1);
        let found = whitened(parts, distinct.columns.clone());
        let expected = whitened(whole, FromParts::same(recipes.len()));
        assert_eq!(found.len(), expected.len());
        for (x, y) in found.iter().zip(&expected) {
            assert!((x - y).abs() <= 1e-11 * y.abs().max(1.0), "{x} {y}");
        }
    }
}
