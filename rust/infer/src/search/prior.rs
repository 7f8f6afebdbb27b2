//! Probabilities before the data.

/// Probabilities before the data.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Of no, one, two and three causes.
    pub causes: [f64; 4],
    /// Of an unexplained term, independently of the causes.
    pub unexplained: f64,
    /// Log odds against the most probable hypothesis beyond which one is pruned.
    pub pruning_log_odds: f64,
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
    (0..chosen).fold(1.0, |sets, i| {
        sets * all.saturating_sub(i) as f64 / (i + 1) as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_further_cause_is_as_rare_as_the_third() {
        let prior = Prior {
            causes: [0.4, 0.3, 0.2, 0.05],
            unexplained: 0.1,
            pruning_log_odds: 25.0,
        };
        assert_eq!([0, 1, 2, 3].map(|count| prior.of(count)), prior.causes);
        assert!((prior.of(5) - 0.05 * 0.25 * 0.25).abs() < 1e-17);
    }

    #[test]
    fn sets_as_pascal_counts_them() {
        assert_eq!(
            [0, 1, 2, 3].map(|k| combinations(6, k)),
            [1.0, 6.0, 15.0, 20.0]
        );
        assert_eq!(combinations(1, 2), 0.0);
    }
}
