//! Probabilities before the data.

/// Probabilities before the data.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Of no, one, two and three causes.
    pub causes: [f64; 4],
    /// Of a shape without a cause, independently.
    pub shape: f64,
    /// Log odds against the most probable hypothesis beyond which one is left out.
    pub hopeless: f64,
}

impl Prior {
    /// Of so many causes; beyond three, each further one is as rare beside the last as the third
    /// is beside the second.
    pub(super) fn of(&self, count: usize) -> f64 {
        let last = self.causes.len() - 1;
        let rarer = self.causes[last] / self.causes[last - 1];
        (last..count).fold(self.causes[count.min(last)], |p, _| p * rarer)
    }
}

/// Sets of `chosen` among `all`.
pub(super) fn combinations(all: usize, chosen: usize) -> f64 {
    (0..chosen).fold(1.0, |sets, i| sets * (all - i) as f64 / (i + 1) as f64)
}
