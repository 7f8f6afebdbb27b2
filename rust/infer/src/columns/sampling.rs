//! Rows of a long table that represent all of it.

/// Rows that a mean, a line or a quantile is taken over: what they miss is far below any size that
/// shows.
const MOST: usize = 100_000;
/// Rows that follow each other among those: a prime, so that no period of a table is missed.
const RUN: usize = 97;

/// Numbers of a column; of more than 100,000, those of evenly spread runs.
pub fn spread(column: &[f64]) -> impl Iterator<Item = f64> {
    let skip = column.len().div_ceil(MOST).max(1);
    let whole = column.len() / (RUN * skip) * RUN * skip;
    let length = if skip == 1 { column.len() } else { whole };
    let parts = column[..length].chunks(RUN * skip);
    parts.flat_map(|part| &part[..part.len().min(RUN)]).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_columns_are_taken_whole_and_long_ones_in_part() {
        let column: Vec<f64> = (0..250_000).map(f64::from).collect();
        let short: Vec<f64> = spread(&column[..MOST]).collect();
        assert_eq!(short, column[..MOST]);
        let long: Vec<f64> = spread(&column).collect();
        assert!((80_000..=MOST).contains(&long.len()), "{}", long.len());
        assert_eq!(long.len() % RUN, 0, "whole runs");
        assert_eq!(
            long[..RUN + 1],
            [&column[..RUN], &[3.0 * RUN as f64]].concat()
        );
        assert_eq!(spread(&[]).count(), 0);
    }
}
