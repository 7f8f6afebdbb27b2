//! Columns of candidate causes, over arrays.

use echocal_core::batch::available_threads;
use echocal_core::evidence::{
    Columns, Distinct, Layout, Level, Memory, Numbers, Recipe, Shape, Sums, gram, legendre_lines,
    wave_means,
};
use echocal_core::model::Term;
use echocal_core::{Model, Quantity};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::to_python;
use crate::evidence::layout;
use crate::model::CoreModel;
use crate::sums::{CoreSums, Remembered, memory};

type Array = Py<PyArray1<f64>>;

/// A recorded quantity: one number, or a column.
#[derive(FromPyObject)]
enum Recorded {
    Number(f64),
    Column(Array),
}

/// A table, and recipes of columns that are made from it where a pass needs them.
#[pyclass(name = "Columns", module = "echocal._core")]
pub struct CoreColumns {
    base: Model,
    distance: Array,
    recorded: [Recorded; Quantity::COUNT],
    stored: Vec<Array>,
    groups: Option<(Vec<u32>, Vec<f64>)>,
    recipes: Vec<Recipe>,
    taken: Vec<Vec<f64>>,
}

#[pymethods]
impl CoreColumns {
    /// `groups`: of each row, where the level of each is unknown.
    #[new]
    fn new(
        base: &CoreModel,
        distance: Array,
        recorded: [Recorded; Quantity::COUNT],
        groups: Option<PyReadonlyArray1<'_, u32>>,
    ) -> PyResult<Self> {
        let counted = |groups: &[u32]| {
            let most = groups.iter().max().map_or(0, |&last| last as usize + 1);
            let mut counts = vec![0.0; most];
            groups
                .iter()
                .for_each(|&group| counts[group as usize] += 1.0);
            (groups.to_vec(), counts)
        };
        let groups = groups
            .as_ref()
            .map(|groups| groups.as_slice())
            .transpose()?;
        Ok(Self {
            base: base.model.clone(),
            distance,
            recorded,
            stored: Vec::new(),
            groups: groups.map(counted),
            recipes: Vec::new(),
            taken: Vec::new(),
        })
    }

    fn __len__(&self) -> usize {
        self.recipes.len()
    }

    /// Derivative of the base's reading to the distance.
    fn slope(&mut self) -> usize {
        self.keep(Recipe::Slope)
    }

    /// A column as it stands.
    fn store(&mut self, column: Array) -> usize {
        let recipe = Recipe::Stored(self.hold(column));
        self.keep(recipe)
    }

    /// Change of the reading by an effect; `levels` of the groups if it were there.
    fn shift(
        &mut self,
        id: &str,
        parameters: Vec<(String, f64)>,
        levels: Option<Vec<f64>>,
    ) -> PyResult<usize> {
        let level = levels.map_or(Level::Known, Level::OfGroups);
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
        let level = match levels {
            Some(levels) => Level::OfGroups(levels),
            None if at_work => Level::Known,
            None => Level::OfBase,
        };
        let position = term.facts().parameter(parameter);
        let position = position.ok_or_else(|| PyValueError::new_err("no such parameter"))?;
        Ok(self.keep(Recipe::Tangent(term, level, position, scale)))
    }

    /// Legendre polynomials of a column between two values, one per scale from the first degree on;
    /// less their means and, from the second degree on, less the straight line.
    fn legendre(
        &mut self,
        py: Python<'_>,
        column: Array,
        low: f64,
        high: f64,
        first: usize,
        scales: Vec<f64>,
    ) -> PyResult<Vec<usize>> {
        let between = (low, high);
        let of = self.hold(column);
        let recipes: Vec<Recipe> = self.using(py, |columns| {
            let degrees = first..first + scales.len();
            let lines = legendre_lines(degrees.clone(), columns.stored[of], between, first > 1);
            let each = scales.into_iter().zip(degrees).zip(lines);
            each.map(|((scale, degree), line)| {
                let shape = Shape::Legendre {
                    degree,
                    between,
                    line,
                };
                Recipe::Of(of, shape, scale)
            })
            .collect()
        })?;
        Ok(recipes
            .into_iter()
            .map(|recipe| self.keep(recipe))
            .collect())
    }

    /// Sine and cosine of multiples of a column's phase in its period, from the first on, one pair per
    /// scale; less their means.
    fn waves(
        &mut self,
        py: Python<'_>,
        column: Array,
        period: f64,
        scales: Vec<f64>,
    ) -> PyResult<Vec<usize>> {
        let of = self.hold(column);
        let means = self.using(py, |columns| {
            wave_means(scales.len(), columns.stored[of], period)
        })?;
        let mut kept = Vec::new();
        for (k, (scale, means)) in scales.into_iter().zip(means).enumerate() {
            for (mean, cosine) in [(means.0, false), (means.1, true)] {
                let shape = Shape::Wave {
                    period,
                    multiple: 1 + k,
                    cosine,
                    mean,
                };
                kept.push(self.keep(Recipe::Of(of, shape, scale)));
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
        rows: Option<PyReadonlyArray1<'py, usize>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = rows.as_ref().map(|rows| rows.as_slice()).transpose()?;
        let length = rows.map_or(self.distance.bind(py).len(), <[usize]>::len);
        let found = self.using(py, |columns| columns.made(&chosen, rows))?;
        PyArray1::from_vec(py, found).reshape([chosen.len(), length])
    }

    /// Sum of some columns, each times a factor.
    fn combined<'py>(
        &self,
        py: Python<'py>,
        chosen: Vec<(usize, f64)>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        if chosen
            .iter()
            .any(|&(column, _)| column >= self.recipes.len())
        {
            return Err(PyValueError::new_err("no such column"));
        }
        let found = self.using(py, |columns| columns.combined(&chosen, available_threads()))?;
        Ok(PyArray1::from_vec(py, found))
    }

    /// Products of every pair of columns from a position on, summed over all rows.
    fn gram<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.recipes.len();
        let found = self.using(py, |columns| gram(columns, available_threads()))?;
        PyArray1::from_vec(py, found).reshape([width, width])
    }

    /// Lag-0 and lag-1 products of all columns per memory; `places` has block and group of each
    /// cell, `series` those that begin in each block.
    #[allow(clippy::too_many_arguments)] // as Python sees it
    fn products<'py>(
        &self,
        py: Python<'py>,
        starts: PyReadonlyArray1<'py, bool>,
        blocks: PyReadonlyArray1<'py, u32>,
        cells: PyReadonlyArray1<'py, u32>,
        distance: PyReadonlyArray1<'py, f64>,
        places: Vec<(usize, usize)>,
        series: Vec<f64>,
        memories: Vec<Option<Remembered>>,
        flat_level: bool,
    ) -> PyResult<CoreSums> {
        let rows = self.distance.bind(py).len();
        let layout = layout(&starts, &blocks, &cells, &distance, rows)?;
        let known = places.iter().all(|&(block, _)| block < series.len());
        if layout.block_count > series.len() || layout.cell_count != places.len() || !known {
            return Err(PyValueError::new_err(
                "labels of blocks and cells do not fit",
            ));
        }
        let layout = Layout {
            block_count: series.len(),
            ..layout
        };
        let threads = available_threads();
        let memories: Vec<Memory> = memories.into_iter().map(memory).collect();
        let products = self.using(py, |columns| {
            let distinct = Distinct::of(columns);
            let sums = Memory::gather(&distinct.among(columns), &layout, &memories, threads);
            sums.iter().map(|sums| distinct.spread(sums)).collect()
        })?;
        let sums = Sums {
            products,
            width: self.recipes.len(),
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

    fn hold(&mut self, column: Array) -> usize {
        self.stored.push(column);
        self.stored.len() - 1
    }

    /// Does something with the columns while Python goes on.
    fn using<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Columns<'_>) -> R + Send,
    ) -> PyResult<R> {
        let distance = self.distance.bind(py).readonly();
        let held: Vec<_> = self
            .stored
            .iter()
            .map(|array| array.bind(py).readonly())
            .collect();
        let recorded: Vec<_> = self
            .recorded
            .iter()
            .map(|quantity| match quantity {
                Recorded::Number(number) => Ok(Err(*number)),
                Recorded::Column(array) => array.bind(py).try_readonly().map(Ok),
            })
            .collect::<Result<_, _>>()
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        let rows = distance.len();
        let mut numbers = Vec::with_capacity(recorded.len());
        for quantity in &recorded {
            numbers.push(match quantity {
                Err(number) => Numbers::All(number),
                Ok(array) => Numbers::Each(array.as_slice()?),
            });
        }
        let stored: Vec<&[f64]> = held
            .iter()
            .map(|array| array.as_slice())
            .collect::<Result<_, _>>()?;
        let each = numbers.iter().filter_map(|n| match n {
            Numbers::Each(column) => Some(column.len()),
            Numbers::All(_) => None,
        });
        let groups = self.groups.as_ref().map(|(groups, _)| groups.len());
        let mut lengths = each
            .chain(stored.iter().map(|column| column.len()))
            .chain(groups);
        if rows == 0 || lengths.any(|length| length != rows) {
            return Err(PyValueError::new_err(
                "columns differ in length or are empty",
            ));
        }
        let mut columns = Columns {
            base: &self.base,
            distance: distance.as_slice()?,
            recorded: core::array::from_fn(|q| numbers[q]),
            stored,
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
