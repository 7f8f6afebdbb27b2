//! Probabilities before the data: docs/method.md, Eq. 7 and 8.

/// Probabilities before the data.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Of no, one, two and three causes.
    pub causes: [f64; 4],
    /// Of an unexplained term, independently of the causes.
    pub unexplained: f64,
}

impl Prior {
    /// That there is no unexplained term, where some compete or none.
    pub(super) fn explained(&self, terms: bool) -> f64 {
        if terms { 1.0 - self.unexplained } else { 1.0 }
    }

    /// Of no cause and no unexplained term, where some terms compete or none.
    #[must_use]
    pub fn no_cause(&self, terms: bool) -> f64 {
        self.explained(terms) * self.of(0)
    }

    /// Of so many causes (docs/method.md, Eq. 7); beyond three, each further one is as rare beside
    /// the last as the third is beside the second.
    pub(super) fn of(&self, count: usize) -> f64 {
        let last = self.causes.len() - 1;
        let rarer = self.causes[last] / self.causes[last - 1];
        (last..count).fold(self.causes[count.min(last)], |p, _| p * rarer)
    }

    /// Of one set of so many causes among those that compete: docs/method.md, Eq. 8 without the weights
    /// of the forms and without the unexplained term.
    pub(super) fn of_set(&self, count: usize, competing: usize) -> f64 {
        self.of(count) / combinations(competing, count)
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
        };
        assert_eq!([0, 1, 2, 3].map(|count| prior.of(count)), prior.causes);
        assert!((prior.of(5) - 0.05 * 0.25 * 0.25).abs() < 1e-17);
        assert_eq!(prior.of_set(2, 6), 0.2 / 15.0);
        assert!((prior.no_cause(true) - 0.36).abs() < 1e-15);
        assert_eq!(prior.no_cause(false), 0.4);
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
