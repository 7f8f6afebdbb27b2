//! Rows of a long table that stand for all of it.

/// Rows that a mean or a line is taken over: what it misses is far below any size that shows.
const MOST: usize = 100_000;
/// Rows that follow each other among those: a prime, so that no period of a table is missed.
const RUN: usize = 97;

/// Numbers of a column; of very many, those of evenly spread runs.
pub(super) fn spread(column: &[f64]) -> impl Iterator<Item = f64> {
    let parts = column.chunks(RUN * (1 + column.len() / MOST));
    parts.flat_map(|part| &part[..part.len().min(RUN)]).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_columns_are_taken_whole_and_long_ones_in_part() {
        let column: Vec<f64> = (0..250_000).map(f64::from).collect();
        let short: Vec<f64> = spread(&column[..99_999]).collect();
        assert_eq!(short, column[..99_999]);
        let long: Vec<f64> = spread(&column).collect();
        assert!((80_000..=MOST).contains(&long.len()), "{}", long.len());
        assert_eq!(
            long[..RUN + 1],
            [&column[..RUN], &[3.0 * RUN as f64]].concat()
        );
    }
}
