//! Rows in spans, on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The spans of a table, at most: as many sums are added up in the end.
const SPANS: usize = 16;
/// Rows that are worth a span.
const WORTH: usize = 4096;

/// What each span of rows gives, in order. Where spans begin and end depends on the table alone.
///
/// `worker` makes what one thread works with.
pub(super) fn in_spans<T: Send, W: FnMut(usize, usize) -> T>(
    rows: usize,
    threads: usize,
    worker: impl Fn() -> W + Sync,
) -> Vec<T> {
    let spans = (rows / WORTH).clamp(1, SPANS);
    let bound = |span: usize| rows * span / spans;
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<T>>> = (0..spans).map(|_| Mutex::new(None)).collect();
    let work = || {
        let mut run = worker();
        loop {
            let span = next.fetch_add(1, Ordering::Relaxed);
            let Some(place) = done.get(span) else { break };
            let found = run(bound(span), bound(span + 1));
            *place
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner) = Some(found);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(spans) {
            scope.spawn(work);
        }
        work();
    });
    let each = done.into_iter();
    each.filter_map(|place| place.into_inner().ok().flatten())
        .collect()
}

/// What each item gives, in order, on several threads where there are many.
pub(super) fn each_of<I: Sync, T: Send>(
    items: &[I],
    threads: usize,
    work: impl Fn(&I) -> T + Sync,
) -> Vec<T> {
    let share = items.len().div_ceil(threads.max(1)).max(MANY);
    std::thread::scope(|scope| {
        let mut parts = items.chunks(share);
        let own = parts.next().unwrap_or(&[]);
        let work = &work;
        let others: Vec<_> = parts
            .map(|part| scope.spawn(move || part.iter().map(work).collect::<Vec<_>>()))
            .collect();
        let mut all: Vec<T> = own.iter().map(work).collect();
        for other in others {
            all.extend(
                other
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            );
        }
        all
    })
}

/// Items that are worth a thread.
const MANY: usize = 8;
