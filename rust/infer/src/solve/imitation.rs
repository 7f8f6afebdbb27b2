//! How well forms of other causes imitate what some causes add to the readings: docs/method.md, Eq. 23.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::hypothesis::Variant;
use crate::numeric::cholesky::{backward, factor, forward};

/// Part of the squares below which columns are the same but for rounding.
const ROUNDING: f64 = 1e-12;

/// Products of columns over the variance of the innovations, a signal, and what stays beside it.
#[derive(Clone, Copy, Debug)]
pub struct Signal<'a> {
    /// A square of `signal.len()`.
    pub products: &'a [f64],
    /// Combination of columns that is imitated.
    pub signal: &'a [f64],
    /// What causes that stay add, whose sizes may change.
    pub beside: &'a [f64],
}

/// One form's imitation of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imitation {
    /// Log odds that remain against it.
    pub left: f64,
    /// Largest size that it needs, in prior standard deviations; also that of what stays, where that
    /// becomes larger than it was.
    pub size: f64,
}

impl Signal<'_> {
    /// The imitation by each form, at sizes within its bounds: a cause that only warms imitates nothing
    /// that cools.
    ///
    /// # Panics
    /// If a column of a form is not there.
    #[must_use]
    pub fn imitations(&self, forms: &[Variant]) -> Vec<Imitation> {
        let width = self.signal.len();
        let stays: Vec<usize> = (0..width).filter(|&i| self.beside[i] != 0.0).collect();
        let used: Vec<usize> = (0..width).filter(|&i| self.signal[i] != 0.0).collect();
        let line = |i: usize| &self.products[i * width..][..width];
        let along: Vec<f64> = (0..width)
            .map(|i| used.iter().map(|&j| line(i)[j] * self.signal[j]).sum())
            .collect();
        let square = used.iter().map(|&i| along[i] * self.signal[i]).sum();
        let by = |form: &Variant| self.imitation(form, &stays, &along, square);
        forms.iter().map(by).collect()
    }

    fn imitation(&self, form: &Variant, stays: &[usize], along: &[f64], square: f64) -> Imitation {
        let product = |i: usize, j: usize| self.products[i * self.signal.len() + j];
        let fixed = |i: usize| form.offsets.iter().map(|&o| product(i, o)).sum::<f64>();
        let offsets = form.offsets.iter();
        let square = square + offsets.map(|&o| fixed(o) - 2.0 * along[o]).sum::<f64>();
        let free = [&form.free[..], stays].concat();
        if free.is_empty() {
            return Imitation {
                left: 0.5 * square,
                size: 1.0,
            };
        }
        let (own, order) = (form.free.len(), free.len());
        let among: Vec<f64> = free
            .iter()
            .flat_map(|&i| free.iter().map(move |&j| product(i, j)))
            .collect();
        let along: Vec<f64> = free.iter().map(|&i| along[i] - fixed(i)).collect();
        let mut size = sizes(&among, order, 0, &along);
        let bounds = size.iter().zip(&form.bounds);
        let within: Vec<f64> = bounds.map(|(size, b)| size.max(b.0).min(b.1)).collect();
        if within != size[..own] {
            // the form cannot be that: the others give way as far as they can
            let rest: Vec<f64> = (0..order)
                .map(|i| {
                    along[i]
                        - (0..own)
                            .map(|j| among[i * order + j] * within[j])
                            .sum::<f64>()
                })
                .collect();
            size = [within, sizes(&among, order, own, &rest)].concat();
        }
        let taken: f64 = (0..order)
            .map(|i| {
                let explained = (0..order).map(|j| among[i * order + j] * size[j]);
                size[i] * (2.0 * along[i] - explained.sum::<f64>())
            })
            .sum();
        let grown = stays.iter().zip(&size[own..]).map(|(&i, more)| {
            let (before, after) = (self.beside[i].abs(), (self.beside[i] + more).abs());
            if after > before { after } else { 0.0 }
        });
        let needed = size[..own].iter().map(|size| size.abs()).chain(grown);
        Imitation {
            left: 0.5 * (square - taken).max(0.0),
            size: needed.fold(0.0, f64::max),
        }
    }
}

/// Coefficients of the columns from the `first` on that leave the least.
fn sizes(among: &[f64], order: usize, first: usize, along: &[f64]) -> Vec<f64> {
    let count = order - first;
    let mut lower: Vec<f64> = (first..order)
        .flat_map(|i| among[i * order + first..(i + 1) * order].iter().copied())
        .collect();
    let trace: f64 = (0..count).map(|i| lower[i * count + i]).sum();
    let ridge = ROUNDING * trace + f64::MIN_POSITIVE;
    for i in 0..count {
        lower[i * count + i] += ridge;
    }
    factor(&mut lower, count, ridge);
    let mut found = along[first..].to_vec();
    forward(&lower, count, &mut found);
    backward(&lower, count, &mut found);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(free: &[usize], bounds: (f64, f64)) -> Variant {
        Variant {
            cause: 0,
            is_unexplained: false,
            offsets: Vec::new(),
            free: free.to_vec(),
            bounds: vec![bounds; free.len()],
            weight: 1.0,
        }
    }

    #[test]
    fn a_form_within_its_bounds_and_beside_what_stays() {
        // columns 0 and 1 are the same, column 2 is at 60 degrees to them
        let products = [4.0, 4.0, 2.0, 4.0, 4.0, 2.0, 2.0, 2.0, 4.0];
        let (signal, nothing) = ([-2.0, 0.0, 0.0], [0.0; 3]);
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let forms = [form(&[1], any), form(&[1], (0.0, 9.0)), form(&[2], any)];
        let mut given = Signal {
            products: &products,
            signal: &signal,
            beside: &nothing,
        };
        let found = given.imitations(&forms);
        for (found, (left, size)) in found.iter().zip([(0.0, 2.0), (8.0, 0.0), (6.0, 1.0)]) {
            assert!((found.left - left).abs() < 1e-9 && (found.size - size).abs() < 1e-9);
        }
        let beside = [0.0, 0.5, 0.0]; // it may become what the third column misses
        given.beside = &beside;
        let found = given.imitations(&forms[2..])[0];
        assert!(found.left < 1e-9 && (found.size - 1.5).abs() < 1e-9);
    }
}
