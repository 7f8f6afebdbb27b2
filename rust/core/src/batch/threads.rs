//! Rows shared out among threads.

use super::block::BLOCK;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{Builder, available_parallelism, scope};

/// Rows of a formula below which a thread costs more than it saves: starting one took 40 us (Zen 4), in which
/// Cramer's law computes 25,000 rows.
pub(super) const OF_A_FORMULA: usize = 50_000;
/// Rows of a law of the temperature alone: 130,000 in that time.
pub(super) const OF_A_SHORT_FORMULA: usize = 250_000;
/// Rows of a model, which take many times as long.
pub(super) const OF_A_MODEL: usize = 8_000;

/// Calls `span(first, count)` so that every row belongs to one call, on at most `threads` threads of
/// `least` rows or more.
///
/// The threads live for this call only, so a process that forks has none to lose. A row's result
/// does not depend on which thread computes it.
pub(super) fn split(
    rows: usize,
    threads: usize,
    least: usize,
    span: &(dyn Fn(usize, usize) + Sync),
) {
    let threads = threads.min(rows / least).max(1);
    let share = rows.div_ceil(threads).next_multiple_of(BLOCK);
    if threads == 1 || share >= rows {
        return span(0, rows);
    }
    scope(|scope| {
        for first in (share..rows).step_by(share) {
            let count = share.min(rows - first);
            let started = Builder::new().spawn_scoped(scope, move || span(first, count));
            if started.is_err() {
                span(first, count); // no more threads to be had: do it here
            }
        }
        span(0, share);
    });
}

/// What [`limit`] was told; 0 without a limit.
static MOST: AtomicUsize = AtomicUsize::new(0);

/// The number of threads that this process may run at once.
#[must_use]
pub fn available() -> usize {
    match MOST.load(Ordering::Relaxed) {
        0 => available_parallelism().map_or(1, usize::from),
        most => most,
    }
}

/// Sets what [`available`] tells: where several processes share the processors.
pub fn limit(most: NonZero<usize>) {
    MOST.store(most.get(), Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn every_row_once() {
        for rows in [0, 1, 99_999, 100_000, 123_457, 1_000_003] {
            for threads in [0, 1, 2, 7] {
                let spans = Mutex::new(Vec::new());
                split(rows, threads, OF_A_FORMULA, &|first, count| {
                    spans.lock().unwrap().push((first, count));
                });
                let mut spans = spans.into_inner().unwrap();
                spans.sort_unstable();
                assert!(spans.len() <= threads.max(1));
                let end = spans.iter().fold(0, |end, &(first, count)| {
                    assert_eq!(first, end);
                    end + count
                });
                assert_eq!(end, rows);
            }
        }
    }
}
