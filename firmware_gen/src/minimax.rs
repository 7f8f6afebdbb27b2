//! Polynomials of least weighted maximum error on a set of points: the exchange algorithm of Remez.
//!
//! E. W. Cheney, *Introduction to Approximation Theory*, 2nd ed., AMS Chelsea (1998), chapter 3.

/// Most exchanges; then the best polynomial so far is returned. Smooth data need about five. Set by hand.
const EXCHANGES: usize = 20;

/// Points to approximate, ascending and distinct in `x`.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// Abscissae.
    pub x: &'a [f64],
    /// Ordinates.
    pub y: &'a [f64],
    /// Weights of the errors, positive.
    pub weight: &'a [f64],
}

impl Points<'_> {
    fn error(&self, coefficients: &[f64], index: usize) -> f64 {
        (self.y[index] - horner(coefficients, self.x[index])) * self.weight[index]
    }
}

/// Coefficients of `x^0 ..= x^degree` and the weighted maximum error that they leave.
///
/// With no more points than coefficients, the polynomial goes through all of them.
#[must_use]
pub fn minimax(points: Points<'_>, degree: usize) -> (Vec<f64>, f64) {
    let count = points.x.len();
    if count < degree + 2 {
        let all: Vec<usize> = (0..count).collect();
        return (interpolate(points, &all, 0.0, degree), 0.0);
    }
    let mut reference = extrema(count, degree + 2);
    let mut best = (vec![0.0; degree + 1], f64::INFINITY);
    for _ in 0..EXCHANGES {
        let level = level(points, &reference);
        let coefficients = interpolate(points, &reference[..=degree], level, degree);
        let errors: Vec<f64> = (0..count)
            .map(|index| points.error(&coefficients, index))
            .collect();
        let worst = errors
            .iter()
            .fold(0.0_f64, |worst, error| worst.max(error.abs()));
        if worst < best.1 {
            best = (coefficients, worst);
        }
        let next = exchange(&errors, degree + 2);
        if worst <= level.abs() * (1.0 + 1e-9)
            || next.as_ref().is_none_or(|next| *next == reference)
        {
            break;
        }
        reference = next.unwrap_or(reference);
    }
    best
}

/// `size` of `count` points, spread like the extrema of Chebyshev's polynomial: near where the errors of a smooth
/// function alternate.
fn extrema(count: usize, size: usize) -> Vec<usize> {
    let spread = |k: usize| {
        let angle = std::f64::consts::PI * k as f64 / (size - 1) as f64;
        ((1.0 - angle.cos()) / 2.0 * (count - 1) as f64).round() as usize
    };
    let mut points: Vec<usize> = (0..size).map(spread).collect();
    for k in 1..size {
        points[k] = points[k].max(points[k - 1] + 1).min(count - (size - k));
    }
    points
}

/// The value of a polynomial.
#[must_use]
pub fn horner(coefficients: &[f64], x: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// The error that alternates in sign over the reference points, all of them at the same weighted height.
fn level(points: Points<'_>, reference: &[usize]) -> f64 {
    let (mut rise, mut alternation) = (0.0, 0.0);
    for (k, &index) in reference.iter().enumerate() {
        let others = reference.iter().filter(|other| **other != index);
        let divided = 1.0
            / others
                .map(|&other| points.x[index] - points.x[other])
                .product::<f64>();
        rise += divided * points.y[index];
        alternation += divided * sign(k) / points.weight[index];
    }
    rise / alternation
}

fn sign(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Newton's divided differences through `y` less the alternating error, expanded to powers of `x`.
fn interpolate(points: Points<'_>, through: &[usize], level: f64, degree: usize) -> Vec<f64> {
    let x: Vec<f64> = through.iter().map(|&index| points.x[index]).collect();
    let lower =
        |(k, &index): (usize, &usize)| points.y[index] - sign(k) * level / points.weight[index];
    let mut divided: Vec<f64> = through.iter().enumerate().map(lower).collect();
    for order in 1..divided.len() {
        for k in (order..divided.len()).rev() {
            divided[k] = (divided[k] - divided[k - 1]) / (x[k] - x[k - order]);
        }
    }
    let mut coefficients = vec![0.0; degree + 1];
    for k in (0..divided.len()).rev() {
        for power in (1..=degree).rev() {
            coefficients[power] = (-x[k]).mul_add(coefficients[power], coefficients[power - 1]);
        }
        coefficients[0] = (-x[k]).mul_add(coefficients[0], divided[k]);
    }
    coefficients
}

/// The `size` largest errors that alternate in sign; `None` if they alternate less often.
fn exchange(errors: &[f64], size: usize) -> Option<Vec<usize>> {
    let mut peaks: Vec<usize> = Vec::new();
    for (index, error) in errors.iter().enumerate() {
        match peaks.last_mut() {
            Some(peak) if errors[*peak] * error > 0.0 && error.abs() <= errors[*peak].abs() => {}
            Some(peak) if errors[*peak] * error > 0.0 => *peak = index,
            _ if *error != 0.0 => peaks.push(index),
            _ => {}
        }
    }
    while peaks.len() > size {
        trim(&mut peaks, errors, size);
    }
    (peaks.len() == size).then_some(peaks)
}

/// Drop the least peak: one at an end, or a neighboring pair, which keeps the signs alternating.
fn trim(peaks: &mut Vec<usize>, errors: &[f64], size: usize) {
    let height = |peaks: &[usize], k: usize| errors[peaks[k]].abs();
    let last = peaks.len() - 1;
    let least = (0..peaks.len())
        .min_by(|&a, &b| height(peaks, a).total_cmp(&height(peaks, b)))
        .unwrap_or(0);
    if least == 0 || least == last || peaks.len() == size + 1 {
        let end = if height(peaks, 0) < height(peaks, last) {
            0
        } else {
            last
        };
        peaks.remove(if least == 0 || least == last {
            least
        } else {
            end
        });
    } else {
        let neighbor = if height(peaks, least - 1) < height(peaks, least + 1) {
            least - 1
        } else {
            least
        };
        peaks.drain(neighbor..neighbor + 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(
        function: impl Fn(f64) -> f64,
        weight: impl Fn(f64) -> f64,
        degree: usize,
    ) -> (Vec<f64>, f64) {
        let x: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 500.0 - 1.0).collect();
        let y: Vec<f64> = x.iter().map(|x| function(*x)).collect();
        let weight: Vec<f64> = x.iter().map(|x| weight(*x)).collect();
        minimax(
            Points {
                x: &x,
                y: &y,
                weight: &weight,
            },
            degree,
        )
    }

    /// The best polynomial below a monomial is what Chebyshev's polynomial leaves of it, 2^(1-n).
    #[test]
    fn monomials_leave_chebyshev_polynomials() {
        for degree in 1..6_usize {
            let (_, error) = fit(|x| x.powi(degree as i32 + 1), |_| 1.0, degree);
            let expected = 0.5_f64.powi(degree as i32);
            assert!(
                (error / expected - 1.0).abs() < 1e-4,
                "degree {degree}: {error} for {expected}"
            );
        }
    }

    #[test]
    fn a_polynomial_fits_itself() {
        let (coefficients, error) = fit(|x| (-2.0 * x).mul_add(x, 3.0), |_| 1.0, 2);
        assert!(error < 1e-12);
        for (found, expected) in coefficients.iter().zip([3.0, 0.0, -2.0]) {
            assert!((found - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn weights_move_the_error_where_it_costs_less() {
        let (constant, error) = fit(|x| x, |x| if x > 0.0 { 3.0 } else { 1.0 }, 0);
        assert!(
            (constant[0] - 0.5).abs() < 1e-3 && (error - 1.5).abs() < 3e-3,
            "{constant:?} {error}"
        );
    }

    #[test]
    fn few_points_are_met() {
        let points = Points {
            x: &[0.0, 1.0],
            y: &[5.0, 7.0],
            weight: &[1.0, 1.0],
        };
        assert_eq!(minimax(points, 1), (vec![5.0, 2.0], 0.0));
    }
}
