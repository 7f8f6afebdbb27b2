//! Choosing the constants of a square: minimax in real numbers, then a descent over integers that looks at every code.

use super::constants::{CODE_BITS, Layer, SQUARE_BITS, Square};
use crate::form::contract::{Fit, center};
use crate::minimax::{Points, minimax};

/// Points of a minimax fit. Set by hand; the integers are chosen on all codes afterwards.
const POINTS: usize = 80;
/// Constants of an outer square that are tried first. Set by hand.
const CONSTANTS: usize = 10;
/// The lowest of them lies below the least value by the square of this, in spans of the values. Set by hand.
const FARTHEST: f64 = 1.6;
/// The step between them is halved this often around the best: to 1/32 of it. Set by hand.
const HALVINGS: usize = 5;
/// Steps of the descent over integers, the last of them a single unit. Set by hand.
const STEPS: [i64; 5] = [64, 16, 4, 2, 1];
/// Most rounds with each step. Set by hand; a round without an improvement ends the step.
const ROUNDS: usize = 40;

/// A square with real constants.
#[derive(Clone, Debug)]
pub(super) struct Ideal {
    /// Value at code 0, and growth per code.
    straight: (f64, f64),
    /// Constant and sign of each squaring.
    layers: Vec<(f64, f64)>,
    error: f64,
}

/// `sign * (start + growth * code)^2 / 2^16 + constant` nearest to `y`; `None` where the points have no bend.
fn single(x: &[f64], y: &[f64], weight: &[f64]) -> Option<Ideal> {
    let span = x[x.len() - 1];
    let scaled: Vec<f64> = x.iter().map(|x| x / span).collect();
    let (found, error) = minimax(
        Points {
            x: &scaled,
            y,
            weight,
        },
        2,
    );
    let (constant, slope, bend) = (found[0], found[1] / span, found[2] / span / span);
    let growth = (bend.abs() * f64::from(SQUARE_BITS).exp2()).sqrt();
    let vertex = -slope / (2.0 * bend);
    // The square runs the way that keeps its argument positive over most of the codes.
    let way = if vertex < span / 2.0 { 1.0 } else { -1.0 };
    let ideal = Ideal {
        straight: (-way * vertex * growth, way * growth),
        layers: vec![((bend * vertex).mul_add(-vertex, constant), bend.signum())],
        error,
    };
    (vertex.is_finite() && growth > 0.0).then_some(ideal)
}

/// `layers` squares, one of the other, nearest to `y`: the outermost constant that leaves the least error.
fn nested(x: &[f64], y: &[f64], weight: &[f64], layers: usize) -> Option<Ideal> {
    if layers < 2 {
        return single(x, y, weight);
    }
    let (low, high) = y
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |ends, y| {
            (y.min(ends.0), y.max(ends.1))
        });
    let unit = f64::from(SQUARE_BITS).exp2();
    let trial = |share: f64| {
        let constant = (high - low).mul_add(-share * share, low);
        let root: Vec<f64> = y.iter().map(|y| ((y - constant) * unit).sqrt()).collect();
        let pairs = weight.iter().zip(&root);
        let weight: Vec<f64> = pairs
            .map(|(w, root)| w * 2.0 * root.max(1.0) / unit)
            .collect();
        let mut inner = nested(x, &root, &weight, layers - 1)?;
        inner.layers.push((constant, 1.0));
        Some(inner)
    };
    let better = |a: &(f64, Ideal), b: &(f64, Ideal)| a.1.error.total_cmp(&b.1.error);
    let of = |share: f64| trial(share).map(|ideal| (share, ideal));
    let mut step = FARTHEST / CONSTANTS as f64;
    let mut best = (0..CONSTANTS)
        .filter_map(|k| of(k as f64 * step))
        .min_by(better)?;
    for _ in 0..HALVINGS {
        step /= 2.0;
        let beside = [best.0 - step, best.0 + step];
        let found = beside
            .into_iter()
            .filter(|share| *share >= 0.0)
            .filter_map(of);
        best = found.chain([best]).min_by(better)?;
    }
    Some(best.1)
}

/// Codes, targets and weights, thinned out.
fn points(fit: &Fit<'_>) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let span = fit.target.len() - 1;
    let count = fit.target.len().min(POINTS);
    let picked: Vec<usize> = (0..count).map(|k| k * span / (count - 1)).collect();
    let of = |values: &[f64]| picked.iter().map(|&code| values[code]).collect();
    (
        picked.iter().map(|&code| code as f64).collect(),
        of(&fit.target),
        of(&fit.weight),
    )
}

impl Ideal {
    /// The outer constants are searched for; the innermost square is fitted to the roots that they leave.
    pub(super) fn nested(fit: &Fit<'_>, layers: usize) -> Option<Self> {
        let (x, y, weight) = points(fit);
        nested(&x, &y, &weight, layers)
    }

    pub(super) fn rounded(&self) -> Square {
        let layer = |&(constant, sign): &(f64, f64)| Layer {
            constant: constant.round() as i64,
            sign: sign as i64,
        };
        let (start, growth) = self.straight;
        Square {
            start: start.round() as i64,
            multiplier: (growth.abs() * f64::from(CODE_BITS).exp2()).round() as i64,
            sign: growth.signum() as i64,
            layers: self.layers.iter().map(layer).collect(),
            floor: self.error,
        }
    }
}

impl Square {
    /// The largest error \[unit\], the outermost constant set to what suits the others best.
    fn settle(&mut self, fit: &Fit<'_>) -> f64 {
        let last = self.layers.len() - 1;
        self.layers[last].constant = 0;
        let settled: Vec<f64> = (0..fit.target.len())
            .map(|code| self.at(code as i64) as f64)
            .collect();
        self.layers[last].constant = center(fit, &settled);
        let constant = self.layers[last].constant as f64;
        let rests = settled.iter().zip(&fit.target).zip(&fit.weight);
        rests.fold(0.0, |worst, ((settled, target), weight)| {
            ((settled + constant - target) * weight).abs().max(worst)
        })
    }

    /// Change the constants by ever smaller steps while that helps.
    pub(super) fn descend(&mut self, fit: &Fit<'_>) {
        let half = fit.target.len() as i64 / 2;
        let moves = self.moves();
        let mut best = (self.settle(fit), self.clone());
        for step in STEPS {
            for _ in 0..ROUNDS {
                let before = best.0;
                for change in &moves {
                    for way in [step, -step] {
                        let mut trial = best.1.clone();
                        trial.change(change, way, half);
                        if trial.multiplier > 0 {
                            let error = trial.settle(fit);
                            if error < best.0 {
                                best = (error, trial);
                            }
                        }
                    }
                }
                if best.0 >= before {
                    break;
                }
            }
        }
        *self = best.1;
    }

    /// Changes that are tried: each constant alone, a steeper line turned about the middle, and pairs that make up for
    /// each other.
    fn moves(&self) -> Vec<Change> {
        let inner = self.layers.len() - 1; // the outermost constant is settled
        let zero = vec![0; inner];
        let change = |start, multiplier, turned, layers: &[i64]| Change {
            start,
            multiplier,
            turned,
            layers: layers.to_vec(),
        };
        let mut moves = vec![
            change(1, 0, false, &zero),
            change(0, 1, false, &zero),
            change(0, 1, true, &zero),
            change(1, 1, true, &zero),
        ];
        for layer in 0..inner {
            let mut one = zero.clone();
            one[layer] = 1;
            moves.push(change(0, 0, false, &one));
            moves.push(change(1, 0, false, &one));
            moves.push(change(-1, 0, false, &one));
            for other in 0..layer {
                for sign in [1, -1] {
                    let mut two = one.clone();
                    two[other] = sign;
                    moves.push(change(0, 0, false, &two));
                }
            }
        }
        moves
    }

    fn change(&mut self, change: &Change, way: i64, half: i64) {
        let turn = (change.multiplier * half * way) >> CODE_BITS;
        if change.turned {
            self.start += change.start - self.sign * turn;
        } else {
            self.start += change.start * way;
        }
        self.multiplier += change.multiplier * way;
        for (layer, by) in self.layers.iter_mut().zip(&change.layers) {
            layer.constant += by * way;
        }
    }
}

/// A change of the constants, once per step.
struct Change {
    start: i64,
    multiplier: i64,
    /// Whether the line turns about the middle of the codes.
    turned: bool,
    layers: Vec<i64>,
}
