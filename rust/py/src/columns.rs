//! Columns of candidate causes, over arrays.

use echocal_core::batch::{Numbers, available_threads};
use echocal_core::model::Term;
use echocal_core::{Model, Quantity};
use echocal_infer::columns::{BasisFunction, Columns, Distinct, Level, Recipe};
use echocal_infer::gram::{LagProducts, RowLayout};
use echocal_infer::noise::{Correlation, NoiseCorrelation, TableSums, White};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use crate::border::{
    Column, ascending, at_most, labels, same_length, same_length_not_empty, within,
};
use crate::columns_layout::{layout, same_series};
use crate::errors::to_python;
use crate::model::CoreModel;
use crate::sums::{CoreSums, GivenCorrelation, correlation, distances};

/// A column that Python holds: read anew each time.
type Held = Py<PyArray1<f64>>;

/// Polynomials of one column, or waves. The diagnosis asks for 16 degrees and 2 waves at most; time and
/// memory grow with them, so that a wrong number must not ask for any number of them.
pub const MOST_FUNCTIONS: usize = 1000;

/// A recorded quantity: one number, or a column.
#[derive(FromPyObject)]
enum Recorded {
    Number(f64),
    Column(Held),
}

/// A table, and recipes of columns that are made from it where a pass needs them.
#[pyclass(name = "Columns", module = "echocal._core")]
pub struct CoreColumns {
    base: Model,
    distance: Held,
    recorded: [Recorded; Quantity::COUNT],
    stored: Vec<Held>,
    groups: Option<(Vec<u32>, Vec<f64>)>,
    recipes: Vec<Recipe>,
    taken: Vec<Vec<f64>>,
}

#[pymethods]
impl CoreColumns {
    /// `groups`: of each row, where the level of each is unknown.
    #[new]
    fn new(
        py: Python<'_>,
        base: &CoreModel,
        distance: Held,
        recorded: [Recorded; Quantity::COUNT],
        groups: Option<Column<'_, u32>>,
    ) -> PyResult<Self> {
        let counted = |groups: Column<'_, u32>| {
            let (labels, most) = labels("groups", &groups)?;
            let mut counts = vec![0.0; most];
            labels.into_iter().for_each(|group| counts[group] += 1.0);
            PyResult::Ok((groups.to_vec(), counts))
        };
        let made = Self {
            base: base.model.clone(),
            distance,
            recorded,
            stored: Vec::new(),
            groups: groups.map(counted).transpose()?,
            recipes: Vec::new(),
            taken: Vec::new(),
        };
        made.using(py, |_| ())?;
        Ok(made)
    }

    fn __len__(&self) -> usize {
        self.recipes.len()
    }

    /// Derivative of the base's reading to the distance.
    fn slope(&mut self) -> usize {
        self.keep(Recipe::Slope)
    }

    /// A column as it stands.
    fn store(&mut self, py: Python<'_>, column: Held) -> PyResult<usize> {
        let recipe = Recipe::Stored(self.hold(py, column)?);
        Ok(self.keep(recipe))
    }

    /// Change of the reading by an effect; `levels` of the groups if it were there.
    fn shift(
        &mut self,
        id: &str,
        parameters: Vec<(String, f64)>,
        levels: Option<Vec<f64>>,
    ) -> PyResult<usize> {
        let level = self.level(levels, Level::Known)?;
        Ok(self.keep(Recipe::Shift(term(id, &parameters)?, level)))
    }

    /// Derivative to a parameter of an effect, times a scale; `levels` as for a shift, where the
    /// effect is at work.
    fn tangent(
        &mut self,
        id: &str,
        parameters: Vec<(String, f64)>,
        at_work: bool,
        levels: Option<Vec<f64>>,
        parameter: &str,
        scale: f64,
    ) -> PyResult<usize> {
        let term = term(id, &parameters)?;
        let unmoved = if at_work { Level::Known } else { Level::OfBase };
        let level = self.level(levels, unmoved)?;
        let position = term.facts().parameter(parameter);
        let position = position.ok_or_else(|| PyValueError::new_err("no such parameter"))?;
        Ok(self.keep(Recipe::Tangent(term, level, position, scale)))
    }

    /// Legendre polynomials of a column between two values, one per scale from the first degree on; less
    /// a straight line each, given by its value at 0 and its slope.
    #[allow(clippy::too_many_arguments)] // as Python sees it
    fn legendre(
        &mut self,
        py: Python<'_>,
        column: Held,
        low: f64,
        high: f64,
        first: usize,
        scales: Vec<f64>,
        lines: Vec<(f64, f64)>,
    ) -> PyResult<Vec<usize>> {
        let last = first.saturating_add(scales.len());
        at_most("degrees from 0 on", last, MOST_FUNCTIONS)?;
        same_length(&[("scales", scales.len()), ("lines", lines.len())])?;
        let of = self.hold(py, column)?;
        let each = scales.into_iter().zip(lines).zip(first..);
        let made = each.map(|((scale, line), degree)| {
            let function = BasisFunction::Legendre {
                degree,
                between: (low, high),
                line,
            };
            self.keep(Recipe::Of(of, function, scale))
        });
        Ok(made.collect())
    }

    /// Sine and cosine of multiples of a column's phase in its period, from the first on, one pair per
    /// scale; less their means.
    fn waves(
        &mut self,
        py: Python<'_>,
        column: Held,
        period: f64,
        scales: Vec<f64>,
        means: Vec<(f64, f64)>,
    ) -> PyResult<Vec<usize>> {
        at_most("multiples of a wave", scales.len(), MOST_FUNCTIONS)?;
        same_length(&[("scales", scales.len()), ("means", means.len())])?;
        let of = self.hold(py, column)?;
        let mut kept = Vec::new();
        for (k, (scale, means)) in scales.into_iter().zip(means).enumerate() {
            for (mean, cosine) in [(means.0, false), (means.1, true)] {
                let function = BasisFunction::Wave {
                    period,
                    multiple: 1 + k,
                    cosine,
                    mean,
                };
                kept.push(self.keep(Recipe::Of(of, function, scale)));
            }
        }
        Ok(kept)
    }

    /// Finds what unknown levels take up of the columns: to be done before these are used.
    fn settle(&mut self, py: Python<'_>) -> PyResult<()> {
        self.taken = self.using(py, |columns| {
            columns.find_levels();
            core::mem::take(&mut columns.taken)
        })?;
        Ok(())
    }

    /// Some columns, at some rows in ascending order or all, one per line.
    #[pyo3(signature = (chosen, rows=None))]
    fn made<'py>(
        &self,
        py: Python<'py>,
        chosen: Vec<usize>,
        rows: Option<Column<'py, usize>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = rows.as_deref();
        let all = self.distance.bind(py).len();
        within("column", chosen.iter().copied(), self.recipes.len())?;
        within("row", rows.into_iter().flatten().copied(), all)?;
        ascending("rows", rows.unwrap_or_default())?;
        let length = rows.map_or(all, <[usize]>::len);
        let found = self.using(py, |columns| columns.made(&chosen, rows))?;
        PyArray1::from_vec(py, found).reshape([chosen.len(), length])
    }

    /// Sum of some columns, each times a factor.
    fn combined<'py>(
        &self,
        py: Python<'py>,
        chosen: Vec<(usize, f64)>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let columns = chosen.iter().map(|&(column, _)| column);
        within("column", columns, self.recipes.len())?;
        let found = self.using(py, |columns| columns.combined(&chosen, available_threads()))?;
        Ok(PyArray1::from_vec(py, found))
    }

    /// Products of every pair of columns, summed over all rows.
    fn gram<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.recipes.len();
        let found = self.using(py, |columns| {
            let rows = columns.distance.len();
            let (starts, none) = (vec![true; rows], vec![0; rows]);
            let one = RowLayout {
                starts: &starts,
                blocks: &none,
                cells: &none,
                distance: columns.distance,
                block_count: 1,
                cell_count: 1,
            };
            let sums = White::gather(columns, &one, &[White], available_threads()).pop();
            sums.map_or_else(
                Vec::new,
                |LagProducts {
                     blocks: [.., first],
                     ..
                 }| first,
            )
        })?;
        PyArray1::from_vec(py, found).reshape([width, width])
    }

    /// Lag-0 and lag-1 products of all columns for each correlation; `places` has block and group of each
    /// cell, `series` those that begin in each block.
    #[allow(clippy::too_many_arguments)] // as Python sees it
    fn products<'py>(
        &self,
        py: Python<'py>,
        starts: Column<'py, bool>,
        blocks: Column<'py, u32>,
        cells: Column<'py, u32>,
        distance: Column<'py, f64>,
        places: Vec<(usize, usize)>,
        series: Vec<f64>,
        correlations: Vec<Option<GivenCorrelation>>,
        flat_level: bool,
    ) -> PyResult<CoreSums> {
        if self.recipes.is_empty() || correlations.is_empty() {
            let message = "there are no columns or no correlations";
            return Err(PyValueError::new_err(message));
        }
        let (rows, count) = (self.distance.bind(py).len(), series.len());
        let (layout, places) = layout(&starts, &blocks, &cells, &distance, rows, &places, count)?;
        let threads = available_threads();
        same_series(&series, &layout)?;
        let models = correlations.into_iter().map(correlation);
        let models: Vec<NoiseCorrelation> = models.collect::<PyResult<_>>()?;
        distances(&models, &distance)?;
        let (products, parts) = self.using(py, |columns| {
            let distinct = Distinct::of(columns);
            let sums =
                NoiseCorrelation::gather(&distinct.among(columns), &layout, &models, threads);
            (sums.into_iter().map(Arc::new).collect(), distinct.columns)
        })?;
        let sums = TableSums {
            products,
            columns: Arc::new(parts),
            cells: places,
            series,
            flat_level,
            finite: Vec::new(),
        };
        Ok(CoreSums { sums })
    }
}

impl CoreColumns {
    fn keep(&mut self, recipe: Recipe) -> usize {
        self.recipes.push(recipe);
        self.recipes.len() - 1
    }

    fn hold(&mut self, py: Python<'_>, column: Held) -> PyResult<usize> {
        let lengths = [column.bind(py).len(), self.distance.bind(py).len()];
        same_length(&[("column", lengths[0]), ("distance", lengths[1])])?;
        self.stored.push(column);
        Ok(self.stored.len() - 1)
    }

    /// The levels of the groups, where they are given.
    fn level(&self, levels: Option<Vec<f64>>, unmoved: Level) -> PyResult<Level> {
        let Some(levels) = levels else {
            return Ok(unmoved);
        };
        let groups = self.groups.as_ref().map_or(0, |(_, counts)| counts.len());
        same_length(&[("levels", levels.len()), ("groups", groups)])?;
        Ok(Level::OfGroups(levels))
    }

    /// Does something with the columns while Python goes on.
    ///
    /// Python may have changed an array in place since it was given, so all are checked each time.
    fn using<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Columns<'_>) -> R + Send,
    ) -> PyResult<R> {
        let distance = Column::of(self.distance.bind(py))?;
        let held = self.stored.iter().map(|array| Column::of(array.bind(py)));
        let held: Vec<_> = held.collect::<PyResult<_>>()?;
        let recorded = self.recorded.iter().map(|quantity| match quantity {
            Recorded::Number(number) => Ok(Err(number)),
            Recorded::Column(array) => Column::of(array.bind(py)).map(Ok),
        });
        let recorded: Vec<_> = recorded.collect::<PyResult<_>>()?;
        let mut lengths = vec![("distance", distance.len())];
        let groups = self.groups.as_ref().map(|(groups, _)| groups.len());
        lengths.extend(groups.map(|length| ("groups", length)));
        lengths.extend(held.iter().map(|column| ("a stored column", column.len())));
        let mut each = Vec::with_capacity(Quantity::COUNT);
        for (quantity, facts) in recorded.iter().zip(&Quantity::ALL) {
            each.push(match quantity {
                Err(number) => Numbers::All(number),
                Ok(array) => {
                    lengths.push((facts.name, array.len()));
                    Numbers::Each(array)
                }
            });
        }
        same_length_not_empty(&lengths)?;
        let mut columns = Columns {
            base: &self.base,
            distance: &distance,
            recorded: core::array::from_fn(|q| each[q]),
            stored: held.iter().map(|column| &**column).collect(),
            groups: self
                .groups
                .as_ref()
                .map(|(groups, counts)| (&groups[..], counts.clone())),
            recipes: &self.recipes,
            taken: self.taken.clone(),
        };
        Ok(py.detach(|| work(&mut columns)))
    }
}

fn term(id: &str, parameters: &[(String, f64)]) -> PyResult<Term> {
    let parameters: Vec<_> = parameters.iter().map(|(n, v)| (n.as_str(), *v)).collect();
    Term::new(id, &parameters).map_err(|e| to_python(&e))
}
