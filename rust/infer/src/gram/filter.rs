//! Linear filters with one state for each column: what one row does, and how far back they reach.

/// Part of a row that a filter may have forgotten where a span begins: below the rounding of a double,
/// 1.1e-16, by a factor of ten.
const FORGOTTEN: f64 = 1e-17;
/// A state below this is set to zero \[m\]: its square, 1e-60, is lost beside any sum of squares of
/// distances.
const FAINT: f64 = 1e-30;

/// What one row asks of every column: `e = (x - from state) scale`, then `state = kept state + taken x`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterStep {
    /// Factor of the state that is taken off the row.
    pub from: f64,
    /// Factor of the rest.
    pub scale: f64,
    /// Part of the state that is kept.
    pub kept: f64,
    /// Part of the row that the state takes.
    pub taken: f64,
    /// Log of the innovation's variance over that of the white noise.
    pub log_variance: f64,
}

/// Row at which a filter that keeps a `factor` of its state must begin, so that the state is right from
/// the row `first` on: where a series begins, or far enough back.
pub(crate) fn beginning(starts: &[bool], first: usize, factor: f64) -> usize {
    let rows = if factor > 0.0 {
        FORGOTTEN.log(factor)
    } else {
        1.0
    };
    let earliest = first.saturating_sub(rows.ceil() as usize);
    starts[earliest..=first]
        .iter()
        .rposition(|&starts| starts)
        .map_or(earliest, |at| earliest + at)
}

/// Sets faint states to zero: whole panels of zeros are then left out of the sums.
pub(crate) fn forget(state: &mut [f64]) {
    for number in state.iter_mut().filter(|number| number.abs() < FAINT) {
        *number = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_begins_at_its_series_or_far_enough_back() {
        let mut starts = [false; 100];
        starts[0] = true;
        assert_eq!(beginning(&starts, 99, 0.5), 99 - 57); // 2^-57 < 1e-17
        assert_eq!(beginning(&starts, 99, 0.0), 98);
        starts[80] = true;
        assert_eq!(beginning(&starts, 99, 0.5), 80);
        assert_eq!(beginning(&starts, 30, 0.999), 0);
    }

    #[test]
    fn faint_states_end() {
        let mut state = [1e-31, -1e-29, -1e-31, 2.0];
        forget(&mut state);
        assert_eq!(state, [0.0, -1e-29, 0.0, 2.0]);
    }
}
