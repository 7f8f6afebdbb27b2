//! Rows in spans, on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The spans of a table, at most: as many sums are kept, and added up in the end.
const SPANS: usize = 16;
/// Rows that are worth a span: some 17 blocks.
const WORTH: usize = 4096;

/// What each span of rows gives, in order. Where spans begin and end depends on the table alone.
///
/// `worker` makes what one thread works with.
pub(crate) fn in_spans<T: Send, W: FnMut(usize, usize) -> T>(
    rows: usize,
    threads: usize,
    worker: impl Fn() -> W + Sync,
) -> Vec<T> {
    let spans = (rows / WORTH).clamp(1, SPANS);
    let bound = |span: usize| rows * span / spans;
    each_part(spans, threads, || {
        let mut run = worker();
        move |span| run(bound(span), bound(span + 1))
    })
}

/// Fills numbers, one for each row, span by span as [`in_spans`].
///
/// `worker` makes what one thread works with: it is given the first row and the numbers.
pub(crate) fn fill_spans<W: FnMut(usize, &mut [f64])>(
    into: &mut [f64],
    threads: usize,
    worker: impl Fn() -> W + Sync,
) {
    let size = into.len().div_ceil(SPANS).max(WORTH);
    let parts: Vec<_> = into.chunks_mut(size).map(Mutex::new).collect();
    each_part(parts.len(), threads, || {
        let mut run = worker();
        let parts = &parts;
        move |part: usize| run(part * size, &mut held(&parts[part]))
    });
}

/// What each part of some work gives, in order; threads take the next part when they are done.
fn each_part<T: Send, W: FnMut(usize) -> T>(
    parts: usize,
    threads: usize,
    worker: impl Fn() -> W + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<T>>> = (0..parts).map(|_| Mutex::new(None)).collect();
    let work = || {
        let mut run = worker();
        loop {
            let part = next.fetch_add(1, Ordering::Relaxed);
            let Some(place) = done.get(part) else { break };
            let found = run(part);
            *held(place) = Some(found);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(parts) {
            scope.spawn(work);
        }
        work();
    });
    let each = done.into_iter();
    each.filter_map(|place| place.into_inner().ok().flatten())
        .collect()
}

/// What only one thread asks for.
fn held<T>(place: &Mutex<T>) -> MutexGuard<'_, T> {
    place.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What each item gives, in order, on several threads where there are many.
///
/// `worker` makes what one thread works with.
pub(crate) fn each_of<I: Sync, T: Send, W: FnMut(&I) -> T>(
    items: &[I],
    threads: usize,
    worker: impl Fn() -> W + Sync,
) -> Vec<T> {
    let threads = if items.len() < FEW { 1 } else { threads };
    let size = (items.len() / (4 * threads.max(1))).clamp(1, MANY);
    let chunks: Vec<&[I]> = items.chunks(size).collect();
    let done = each_part(chunks.len(), threads, || {
        let mut run = worker();
        let chunks = &chunks;
        move |chunk: usize| chunks[chunk].iter().map(&mut run).collect::<Vec<_>>()
    });
    done.into_iter().flatten().collect()
}

/// Items that one thread does sooner than several are started: some 10 us each.
const FEW: usize = 256;
/// Items that are handed over at once, at most: so few that no thread waits long for the last.
const MANY: usize = 8;

/// Numbers that one thread fills sooner than several are started: some 1 ns each.
const SHORT: usize = 1 << 20;

/// Fills each item's part of some numbers, as many for each, and returns what each gives, in order.
///
/// `worker` makes what one thread works with.
pub(crate) fn fill_each<I: Sync, T: Send, W: FnMut(&I, &mut [f64]) -> T>(
    items: &[I],
    into: &mut [f64],
    threads: usize,
    worker: impl Fn() -> W + Sync,
) -> Vec<T> {
    let each = into.len() / items.len().max(1);
    let fill = |(items, into): (&[I], &mut [f64])| -> Vec<T> {
        let mut run = worker();
        let parts = into.chunks_exact_mut(each.max(1));
        let both = items.iter().zip(parts);
        both.map(|(item, part)| run(item, part)).collect()
    };
    let threads = if into.len() < SHORT { 1 } else { threads };
    let share = items.len().div_ceil(threads.max(1)).max(1);
    let shares = items
        .chunks(share)
        .zip(into.chunks_mut((share * each).max(1)));
    std::thread::scope(|scope| {
        let mut shares = shares.collect::<Vec<_>>().into_iter();
        let own = shares.next();
        let others: Vec<_> = shares.map(|part| scope.spawn(|| fill(part))).collect();
        let mut found = own.map_or_else(Vec::new, fill);
        for other in others {
            match other.join() {
                Ok(more) => found.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        found
    })
}
