//! How distances bend over the echo time: samples of each row, and the straight lines that are left once the bend is off.

use super::request::Request;
use crate::form::{Sample, Tail};
use crate::minimax::{Points, minimax};
use crate::reference::Line;

/// Echo codes sampled in a row, in pairs: enough for a polynomial of degree 2. Set by hand; the proof checks all.
const SAMPLES: usize = 16;
/// Between two pairs the high bits of the echo code change: a form may take them as constant between.
const BYTE: i64 = 256;
/// Share of the bound from which a bend matters. Set by hand: a straight line through both ends leaves it whole, the best
/// one half of it.
const MATTERS: f64 = 0.1;

/// Distances that bend.
pub(super) struct Bend {
    /// Echo codes and distances \[unit\] of each row.
    rows: Vec<Vec<(i64, f64)>>,
    /// What is left of each row without the square of the echo code.
    pub(super) lines: Vec<Line>,
}

impl Bend {
    /// `None` where no row bends so much that it matters.
    pub(super) fn of(request: &Request<'_>, picked: &[usize], lines: &[Line]) -> Option<Self> {
        let output = request.device.output;
        let bound = request.maximum_error * output.per_meter;
        let sag = |line: &Line| {
            let middle = i64::midpoint(line.first, line.reach) as f64;
            (line.middle - line.slope.mul_add(middle, line.start)).abs()
        };
        if request.device.varied() > 1 || !lines.iter().any(|line| sag(line) > MATTERS * bound) {
            return None;
        }
        let row = |(row, line): (&usize, &Line)| {
            let echoes = echoes(line);
            let times: Vec<f64> = echoes
                .iter()
                .map(|echo| request.device.echo.value(*echo))
                .collect();
            let mut distances = vec![0.0; times.len()];
            let at = request.device.values(*row);
            request.reference.distances(&at, &times, &mut distances);
            let units = distances.iter().map(|distance| distance * output.per_meter);
            echoes.into_iter().zip(units).collect()
        };
        let rows: Vec<Vec<_>> = picked.iter().zip(lines).map(row).collect();
        let lines = rows
            .iter()
            .zip(lines)
            .map(|(row, line)| straightened(row, line));
        Some(Self {
            lines: lines.collect(),
            rows,
        })
    }

    /// Echo codes and distances \[unit\] of a row.
    pub(super) fn row(&self, index: usize) -> impl Iterator<Item = (i64, f64)> {
        self.rows[index].iter().copied()
    }

    /// The factors that bring each sample to its distance.
    pub(super) fn samples(&self, tail: &Tail) -> Vec<Vec<Sample>> {
        let row = |row: &Vec<(i64, f64)>| {
            let samples = row
                .iter()
                .map(|(echo, distance)| tail.sample(*echo, *distance));
            samples.collect()
        };
        self.rows.iter().map(row).collect()
    }
}

/// Echo codes of a row, ascending: as Chebyshev's nodes they are close to each other at both ends.
fn echoes(line: &Line) -> Vec<i64> {
    let span = (line.reach - line.first) as f64;
    let node = |k: usize| {
        let angle = std::f64::consts::PI * k as f64 / SAMPLES as f64;
        let code = line.first + ((1.0 - angle.cos()) / 2.0 * span).round() as i64;
        let edge = (code + BYTE / 2) / BYTE * BYTE;
        [edge - 1, edge]
    };
    let inner = (1..SAMPLES).flat_map(node);
    let mut all: Vec<i64> = inner.chain([line.first, line.reach]).collect();
    all.retain(|echo| (line.first..=line.reach).contains(echo));
    all.sort_unstable();
    all.dedup();
    all
}

/// The line that is left of a row without the square of the echo code.
fn straightened(row: &[(i64, f64)], line: &Line) -> Line {
    let (x, y): (Vec<f64>, Vec<f64>) = row.iter().map(|(echo, d)| (*echo as f64, *d)).unzip();
    let weight = vec![1.0; x.len()];
    let points = Points {
        x: &x,
        y: &y,
        weight: &weight,
    };
    let (coefficients, _) = minimax(points, 2);
    let (start, slope) = (coefficients[0], coefficients[1]);
    let middle = i64::midpoint(line.first, line.reach) as f64;
    Line {
        slope,
        start,
        middle: slope.mul_add(middle, start),
        ..*line
    }
}
