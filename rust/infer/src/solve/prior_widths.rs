//! Which widths the priors of the causes have, combination by combination.

use super::hypothesis::HypothesisColumns;

/// Widths of the mixture of normal priors on a size, in prior standard deviations, the widest last: an
/// even mixture that spans a decade, because the typical size of an effect is rarely known better.
pub const WIDTHS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];
/// Position of the widest.
pub(super) const WIDEST: usize = WIDTHS.len() - 1;

/// Combinations of widths, one width a cause.
#[derive(Default)]
pub(super) struct Widths {
    /// Columns of each cause.
    counts: Vec<usize>,
    /// Widths of the causes, combination after combination.
    causes: Vec<usize>,
    /// Widths of their columns.
    columns: Vec<usize>,
    combinations: usize,
}

impl Widths {
    fn begin(&mut self, layout: &HypothesisColumns) {
        self.counts.clone_from(&layout.counts);
        self.causes.clear();
        self.columns.clear();
        self.combinations = 0;
    }

    fn push(&mut self, width: impl Fn(usize) -> usize) {
        for (cause, &count) in self.counts.iter().enumerate() {
            self.causes.push(width(cause));
            self.columns
                .extend(core::iter::repeat_n(width(cause), count));
        }
        self.combinations += 1;
    }

    /// One combination.
    pub fn one(&mut self, layout: &HypothesisColumns, width: impl Fn(usize) -> usize) {
        self.begin(layout);
        self.push(width);
    }

    /// All widest; then of each cause, in order, each narrower width beside the widest of the others.
    pub fn star(&mut self, layout: &HypothesisColumns) {
        self.one(layout, |_| WIDEST);
        for cause in 0..self.counts.len() {
            for narrow in 0..WIDEST {
                self.push(|other| if other == cause { narrow } else { WIDEST });
            }
        }
    }

    /// Every combination of some widths of each cause; the first causes' change most often.
    pub fn every(&mut self, layout: &HypothesisColumns, kept: &[[bool; WIDTHS.len()]]) {
        self.begin(layout);
        let choices: Vec<Vec<usize>> = kept
            .iter()
            .map(|kept| (0..WIDTHS.len()).filter(|&width| kept[width]).collect())
            .collect();
        for code in 0..choices.iter().map(Vec::len).product() {
            let mut rest: usize = code;
            let digits: Vec<usize> = choices
                .iter()
                .map(|choice| {
                    let digit = rest % choice.len();
                    rest /= choice.len();
                    choice[digit]
                })
                .collect();
            self.push(|cause| digits[cause]);
        }
    }

    /// Number of combinations.
    pub fn len(&self) -> usize {
        self.combinations
    }

    /// Width of each column in one combination.
    pub fn of(&self, combination: usize) -> &[usize] {
        let order = self.columns.len() / self.combinations;
        &self.columns[combination * order..][..order]
    }

    /// Columns up to the last whose width is another than in the combination before; all at first.
    pub fn changed(&self, combination: usize) -> usize {
        let causes = self.counts.len();
        let own = &self.causes[combination * causes..][..causes];
        let before = combination
            .checked_sub(1)
            .map(|before| &self.causes[before * causes..][..causes]);
        let last = before.map_or(Some(causes), |before| {
            (0..causes)
                .rev()
                .find(|&i| own[i] != before[i])
                .map(|i| i + 1)
        });
        self.counts[..last.unwrap_or(0)].iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_is_told() {
        let layout = HypothesisColumns {
            counts: vec![1, 2],
            free: vec![0, 1, 2],
            ..HypothesisColumns::default()
        };
        let mut widths = Widths::default();
        widths.star(&layout);
        let found: Vec<_> = (0..widths.len())
            .map(|c| (widths.of(c).to_vec(), widths.changed(c)))
            .collect();
        let narrow = |w: [usize; 3], changed| (w.to_vec(), changed);
        let star = [
            narrow([2, 2, 2], 3),
            narrow([0, 2, 2], 1),
            narrow([1, 2, 2], 1),
            narrow([2, 0, 0], 3),
            narrow([2, 1, 1], 3),
        ];
        assert_eq!(found, star);
        widths.every(&layout, &[[true, false, true], [false, true, true]]);
        let found: Vec<_> = (0..widths.len()).map(|c| widths.of(c).to_vec()).collect();
        assert_eq!(found, [[0, 1, 1], [2, 1, 1], [0, 2, 2], [2, 2, 2]]);
        assert_eq!(widths.changed(1), 1);
        assert_eq!(widths.changed(2), 3);
    }
}
