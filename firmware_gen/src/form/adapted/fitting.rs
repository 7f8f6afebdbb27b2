//! Choosing the constants: the real ones from a minimax fit, then a descent over integers that looks at every code.

use super::constants::{Adapted, BITS, Signed};
use crate::form::contract::Fit;
use crate::form::steps::INDEX_STARTS as BEFORE;
use crate::minimax::{Points, minimax};

/// Points of a minimax fit. Set by hand: the integers are chosen on all codes afterwards.
const POINTS: usize = 96;
/// Steps of the descent over integers. Set by hand.
const STEPS: [i64; 3] = [16, 4, 1];
/// Most rounds with each step. Set by hand; a round without an improvement ends the step.
const ROUNDS: usize = 30;
/// Share of the error of the best polynomial with this leading coefficient that no rounding undercuts. Set by hand.
const SURE: f64 = 0.9;
/// Shapes of a degree that are refined. Set by hand.
pub(super) const SHAPES: usize = 12;
/// Descents from constants that are changed at random, and the most that each is changed by. Set by hand.
const RESTARTS: usize = 6;
const AWAY: i64 = 24;
/// They are tried if the error is at most this many times the bound. Set by hand.
const NEAR: f64 = 1.4;

/// Coefficients in powers of the code, the leading one fixed, and the error that they leave \[unit\].
pub(super) fn solve(fit: &Fit<'_>, degree: usize, leading: f64) -> (Vec<f64>, f64) {
    let last = fit.target.len() - 1;
    let count = POINTS.min(last + 1);
    let picked: Vec<usize> = (0..count).map(|k| k * last / (count - 1)).collect();
    let span = last as f64;
    let x: Vec<f64> = picked.iter().map(|u| *u as f64 / span).collect();
    let settled = |u: usize| leading * (u as f64).powi(degree as i32);
    let y: Vec<f64> = picked
        .iter()
        .map(|u| fit.target[*u] - settled(*u))
        .collect();
    let weight: Vec<f64> = picked.iter().map(|u| fit.weight[*u]).collect();
    let free = if leading == 0.0 { degree } else { degree - 1 };
    let (mut found, error) = minimax(
        Points {
            x: &x,
            y: &y,
            weight: &weight,
        },
        free,
    );
    let mut scale = 1.0;
    for coefficient in &mut found {
        *coefficient /= scale;
        scale *= span;
    }
    if leading != 0.0 {
        found.push(leading);
    }
    (found, error)
}

/// Coefficients of the same polynomial in a variable that is larger by `more`.
fn moved(found: &[f64], more: f64) -> Vec<f64> {
    let mut moved = found.to_vec();
    for least in 0..moved.len() {
        for k in (least..moved.len() - 1).rev() {
            moved[k] = more.mul_add(-moved[k + 1], moved[k]);
        }
    }
    moved
}

/// The polynomials of a degree whose leading coefficient is near `leading`, with their errors as they are rounded
/// \[unit\], the least first.
pub(super) fn shapes(fit: &Fit<'_>, degree: usize, leading: f64) -> Vec<(f64, Adapted)> {
    let last = fit.target.len() as i64 - 1;
    let unit = f64::from(BITS).exp2();
    let mut made = Vec::new();
    for twice in [1, 2] {
        let power = leading.abs() * unit.powi(degree as i32 - 1) / twice as f64;
        let ideal = power.powf((degree as f64).recip());
        for multiplier in [ideal.floor(), ideal.ceil()] {
            if multiplier < 1.0 || multiplier * (last + BEFORE) as f64 > 65_535.0 {
                continue;
            }
            let fixed = leading.signum() * twice as f64 * multiplier.powi(degree as i32)
                / unit.powi(degree as i32 - 1);
            let (found, floor) = solve(fit, degree, fixed);
            if floor > fit.bound {
                continue;
            }
            for (slant, before) in [-2, -1, 1, 2]
                .into_iter()
                .flat_map(|slant| (0..BEFORE).map(move |before| (slant, before)))
            {
                let found = moved(&found, before as f64);
                let form = Adapted::of(&found, multiplier, (twice, slant), floor);
                let form = form.map(|form| Adapted { before, ..form });
                let form = form.map(|form| form.turned(last / 2));
                let form = form.filter(|form| form.is_natural(last));
                made.extend(form.map(|mut form| (form.settle(fit), form)));
            }
        }
    }
    made.sort_by(|a, b| a.0.total_cmp(&b.0));
    made
}

impl Adapted {
    /// The best constants that are found from these, until the bound is met, and their error \[unit\].
    pub(super) fn improved(&self, fit: &Fit<'_>) -> (f64, Self) {
        let moves = self.moves();
        let mut best = self.descended(fit, &moves);
        let mut draw = 1_u64;
        for _ in 0..RESTARTS {
            if best.0 <= fit.bound || best.0 > NEAR * fit.bound {
                break;
            }
            let mut other = best.1.clone();
            let mut by = [0; 4];
            for by in by.iter_mut().take(self.degree() - 1) {
                draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                *by = (draw >> 33) as i64 % (2 * AWAY + 1) - AWAY;
            }
            other.change(by);
            let found = other.descended(fit, &moves);
            if found.0 < best.0 {
                best = found;
            }
        }
        best
    }

    /// Changes of one constant, and of two.
    fn moves(&self) -> Vec<[i64; 4]> {
        let mut moves: Vec<[i64; 4]> = Vec::new();
        for one in 0..self.degree() - 1 {
            let mut single = [0; 4];
            single[one] = 1;
            moves.push(single);
            for other in 0..one {
                for way in [1, -1] {
                    let mut pair = single;
                    pair[other] = way;
                    moves.push(pair);
                }
            }
        }
        moves
    }

    /// The constants to which single steps lead that each leave less error, and that error \[unit\].
    fn descended(&self, fit: &Fit<'_>, moves: &[[i64; 4]]) -> (f64, Self) {
        let last = fit.target.len() as i64 - 1;
        let mut best = (self.clone().settle(fit), self.clone());
        if !self.is_natural(last) {
            best.0 = f64::INFINITY;
        }
        for step in STEPS {
            for _ in 0..ROUNDS {
                let before = best.0;
                for by in moves {
                    for way in [step, -step] {
                        let mut trial = best.1.clone();
                        trial.change(by.map(|by| by * way));
                        let error = trial.settle(fit);
                        if error < best.0 && trial.is_natural(last) {
                            best = (error, trial);
                        }
                    }
                }
                if best.0 == before {
                    break;
                }
            }
        }
        best
    }

    /// The constants of the polynomial with these coefficients in powers of the code, where the second factor holds
    /// `y` and `x` so many times.
    fn of(found: &[f64], multiplier: f64, (twice, slant): (i64, i64), floor: f64) -> Option<Self> {
        let unit = f64::from(BITS).exp2();
        let in_x = |k: usize| found[k] / multiplier.powi(k as i32);
        let base = (found.len() == 6).then(|| in_x(0));
        let power = |k: usize| {
            if base.is_some() {
                in_x(k + 1) * unit
            } else {
                in_x(k)
            }
        };
        let (k, j) = (twice as f64, slant as f64);
        let sign = power(4).signum();
        // y = b + (x^2 + a x) / unit; c + sign * y * (d + k y + j x) / unit.
        let a = 0.5 * (power(3) * sign).mul_add(unit, -j / unit) * unit * unit / k;
        let (square, straight) = (power(2) * sign * unit, power(1) * sign * unit);
        let bent = k * a * a / unit / unit + j * a / unit;
        let b = (a.mul_add(-square, straight) + a * bent) / j;
        let d = (square - bent - 2.0 * k * b / unit) * unit;
        let c = (-sign * b).mul_add(k.mul_add(b, d) / unit, power(0));
        let round = |value: f64| value.abs().lt(&1e9).then(|| value.round() as i64);
        let (a, b, c, d) = (round(a)?, round(b)?, round(c)?, round(d)?);
        let sign = sign as i64;
        let form = Self {
            before: 0,
            multiplier: multiplier as i64,
            line: Signed {
                constant: a,
                sign: 1,
            },
            parabola: Signed {
                constant: b,
                sign: 1,
            },
            second: (d, twice, slant),
            quartic: Signed { constant: c, sign },
            base: base.map(|base| Signed {
                constant: base.round() as i64,
                sign: 1,
            }),
            floor: SURE * floor,
        };
        Some(form)
    }
}
