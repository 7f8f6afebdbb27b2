//! A uniform table in two conditions, a power of two of codes between entries, linear between them both ways.

use super::additive::words;
use super::contract::{Fit, Form};
use super::plane::Plane;
use super::steps::{floor_shift, plus, second_index, temperature_index};
use crate::ir::{Builder, TableId, Value};
use crate::minimax::horner;

/// Name of the form.
pub const NAME: &str = "grid";
/// Most entries that are proposed: 8 KiB of 16-bit entries, a quarter of the flash of an ATmega328P.
const MOST: usize = 4096;
/// Passes in which entries move to the middle of the errors around them. Set by hand.
const PASSES: usize = 8;
/// Degree of the polynomial that interpolates a row of the second condition between the codes that are sampled. Set by
/// hand: moist air is nearly linear in the humidity.
const DEGREE: usize = 3;
/// The error of the best table is taken to be at least this share of the first table's. In one dimension,
/// moving the entries of a parabola halves the error; 0.4 leaves a margin. Set by hand.
const SPARE: f64 = 0.4;

/// Entries row by row, a row for each temperature.
#[derive(Clone, Debug)]
struct Grid {
    /// Binary logarithm of the codes between entries, of the temperature and of the second condition.
    bits: (u32, u32),
    columns: usize,
    entries: Vec<i64>,
    floor: f64,
}

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    if fit.device.conditions.len() != 2 {
        return Vec::new();
    }
    let plane = Plane::new(fit);
    let lines: Vec<Vec<f64>> = plane
        .lines(DEGREE)
        .iter()
        .map(|line| line.0.clone())
        .collect();
    let wide = fit.device.conditions[1].len() - 1;
    let steps = |codes: usize| 1..usize::BITS - codes.leading_zeros() + 1;
    let shapes = steps(lines.len())
        .flat_map(|temperature| steps(wide).map(move |humidity| (temperature, humidity)));
    let nodes = |codes: usize, bits: u32| (codes >> bits) + 2;
    shapes
        .filter(|(temperature, humidity)| {
            nodes(lines.len() - 1, *temperature) * nodes(wide, *humidity) <= MOST
        })
        .map(|bits| {
            let rows = nodes(lines.len() - 1, bits.0);
            let grid = Grid::new(fit, &plane, &lines, bits, (rows, nodes(wide, bits.1)));
            Box::new(grid) as _
        })
        .collect()
}

impl Grid {
    fn new(
        fit: &Fit<'_>,
        plane: &Plane<'_>,
        lines: &[Vec<f64>],
        bits: (u32, u32),
        (rows, columns): (usize, usize),
    ) -> Self {
        let last = lines.len() - 1;
        let entry = |index: usize| {
            let (row, column) = (index / columns, index % columns);
            let humidity = (column << bits.1) as f64;
            let temperature = row << bits.0;
            let at = |code: usize| horner(&lines[code], humidity);
            // Past the end on in a straight line.
            let beyond = temperature.saturating_sub(last) as f64;
            (at(last) - at(last.saturating_sub(1))).mul_add(beyond, at(temperature.min(last)))
        };
        let mut values: Vec<f64> = (0..rows * columns).map(entry).collect();
        let mut grid = Self {
            bits,
            columns,
            entries: Vec::new(),
            floor: 0.0,
        };
        let first = grid.relax(fit, plane, &mut values);
        grid.floor = SPARE * first;
        grid.entries = values.iter().map(|value| value.round() as i64).collect();
        grid
    }

    /// The cell of a combination of codes: index of its first entry, and the place in it.
    fn cell(&self, temperature: usize, humidity: usize) -> (usize, f64, f64) {
        let share =
            |code: usize, bits: u32| (code & ((1 << bits) - 1)) as f64 / f64::from(bits).exp2();
        let index = (temperature >> self.bits.0) * self.columns + (humidity >> self.bits.1);
        (
            index,
            share(temperature, self.bits.0),
            share(humidity, self.bits.1),
        )
    }

    /// Move each entry by the middle of the errors in the cells around it; the first error \[unit\].
    fn relax(&self, fit: &Fit<'_>, plane: &Plane<'_>, values: &mut [f64]) -> f64 {
        let mut first = 0.0_f64;
        for pass in 0..PASSES {
            let mut ends = vec![(0.0_f64, 0.0_f64); values.len()];
            for (index, target) in fit.target.iter().enumerate() {
                let (temperature, humidity) = plane.place(index);
                let (cell, down, along) = self.cell(temperature, humidity);
                let corners = [cell, cell + 1, cell + self.columns, cell + self.columns + 1];
                let [a, b, c, d] = corners.map(|corner| values[corner]);
                let (upper, lower) = ((b - a).mul_add(along, a), (d - c).mul_add(along, c));
                let error = target - (lower - upper).mul_add(down, upper);
                if pass == 0 {
                    first = first.max(error.abs() * fit.weight[index]);
                }
                for corner in corners {
                    ends[corner] = (ends[corner].0.min(error), ends[corner].1.max(error));
                }
            }
            let middles = ends.iter().map(|(low, high)| (low + high) / 2.0);
            values
                .iter_mut()
                .zip(middles)
                .for_each(|(value, middle)| *value += middle);
        }
        first
    }

    /// The value between two entries.
    fn between(
        &self,
        builder: &mut Builder<'_>,
        low: Value,
        high: Value,
        within: Value,
        bits: u32,
    ) -> Value {
        let rise = builder.subtract(high, low);
        let product = builder.multiply(within, rise);
        let lift = floor_shift(builder, product, bits);
        builder.add(low, lift)
    }
}

/// The entry `more` behind `index`.
fn entry(builder: &mut Builder<'_>, table: TableId, index: Value, more: usize) -> Value {
    let index = plus(builder, index, more as i64);
    builder.load(table, index)
}

impl Form for Grid {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!(
            "table of {} by {} speed factors, {} by {} codes apart, linear between them",
            self.entries.len() / self.columns,
            self.columns,
            1 << self.bits.0,
            1 << self.bits.1
        )
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({ "step_bits": self.bits, "columns": self.columns, "entries": self.entries })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let temperature = temperature_index(builder);
        let humidity = second_index(builder);
        let second = words(&builder.device().conditions[1]);
        let note =
            format!("speed factors: one row for each temperature, one column for each {second}");
        let table = builder.table("speed", note, self.entries.clone());
        let row = builder.shift_right(temperature, self.bits.0);
        let columns = builder.constant(self.columns as i64);
        let row = builder.multiply(row, columns);
        let column = builder.shift_right(humidity, self.bits.1);
        let cell = builder.add(row, column);
        let cell = builder.name(cell, "cell", "index of the first entry of the cell");
        let down = builder.low_bits(temperature, self.bits.0);
        let down = builder.name(
            down,
            "down",
            "position in the cell along temperature [codes]",
        );
        let along = builder.low_bits(humidity, self.bits.1);
        let along = builder.name(
            along,
            "along",
            format!("position in the cell along {second} [codes]"),
        );
        let [a, b, c, d] =
            [0, 1, self.columns, self.columns + 1].map(|more| entry(builder, table, cell, more));
        let upper = self.between(builder, a, b, along, self.bits.1);
        let upper = builder.name(
            upper,
            "first_row",
            "speed factor at the cell's first temperature code",
        );
        let lower = self.between(builder, c, d, along, self.bits.1);
        let lower = builder.name(
            lower,
            "next_row",
            "speed factor at the next cell's first temperature code",
        );
        self.between(builder, upper, lower, down, self.bits.0)
    }

    fn refine(&mut self, _: &Fit<'_>) {} // its entries are in the middle of their errors already

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}
