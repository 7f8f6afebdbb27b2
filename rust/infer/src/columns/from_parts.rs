//! Columns from the parts that are summed over the rows: multiples of parts, and sums of parts.

use super::onsets::Onsets;

/// Which part each column is a multiple of, after parts that set in somewhere were added up.
///
/// Sums over the rows are kept for the parts alone, which are fewer. What is linear in each of two
/// columns (their product, whitened or not) is that of the parts, multiplied and added up.
#[derive(Clone, Debug, Default)]
pub struct FromParts {
    pub(super) of: Vec<(usize, f64)>,
    pub(super) onsets: Onsets,
    pub(super) parts: usize,
}

impl FromParts {
    /// Each of some columns is a part of its own.
    #[must_use]
    pub fn same(columns: usize) -> Self {
        Self {
            of: (0..columns).map(|part| (part, 1.0)).collect(),
            parts: columns,
            ..Self::default()
        }
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.of.len()
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// Products of each two of some columns from those of the parts, which are changed.
    ///
    /// # Panics
    /// If the lengths are not the squares of the numbers of parts and of chosen columns.
    pub fn products(&self, parts: &mut [f64], chosen: &[usize], into: &mut [f64]) {
        assert!(parts.len() == self.parts * self.parts);
        assert!(into.len() == chosen.len() * chosen.len());
        self.onsets.add_up(parts, self.parts);
        for (line, &column) in into.chunks_exact_mut(chosen.len().max(1)).zip(chosen) {
            let (part, factor) = self.of[column];
            let own = &parts[part * self.parts..(part + 1) * self.parts];
            for (product, &beside) in line.iter_mut().zip(chosen) {
                let (other, times) = self.of[beside];
                *product = factor * times * own[other];
            }
        }
    }

    /// Whether each column is finite, from whether each part is.
    #[must_use]
    pub fn finite(&self, mut parts: Vec<bool>) -> Vec<bool> {
        for pair in self.onsets.pairs() {
            parts[pair[0]] &= parts[pair[1]];
        }
        self.of.iter().map(|&(part, _)| parts[part]).collect()
    }

    /// The same with zero in place of some columns.
    #[must_use]
    pub fn without(&self, finite: &[bool]) -> Self {
        let both = self.of.iter().zip(finite);
        let kept = both.map(|(&(part, factor), &finite)| (part, if finite { factor } else { 0.0 }));
        Self {
            of: kept.collect(),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_multiples_too() {
        let found = FromParts {
            of: vec![(0, 1.0), (1, 1.0), (1, 4.0)],
            parts: 2,
            ..FromParts::default()
        };
        let mut whole = [0.0; 9];
        found.products(&mut [1.0, 2.0, 2.0, 5.0], &[0, 1, 2], &mut whole);
        assert_eq!(whole, [1.0, 2.0, 8.0, 2.0, 5.0, 20.0, 8.0, 20.0, 80.0]);
        let mut some = [0.0; 4];
        found.products(&mut [1.0, 2.0, 2.0, 5.0], &[0, 2], &mut some);
        assert_eq!(some, [1.0, 8.0, 8.0, 80.0]);
        let finite = found.finite(vec![true, false]);
        assert_eq!(finite, [true, false, false]);
        let less = found.without(&finite);
        less.products(&mut [1.0, 0.0, 0.0, 0.0], &[0, 2], &mut some);
        assert_eq!(some, [1.0, 0.0, 0.0, 0.0]);
    }
}
