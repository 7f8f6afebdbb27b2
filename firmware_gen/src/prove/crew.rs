//! The threads of a proof: turn after turn, until none is left or one failed.

use crate::error::Error;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Interval between two reports of the progress. Set by hand.
const TICK: Duration = Duration::from_millis(50);
/// Results that a thread sends together. Set by hand.
const BATCH: usize = 64;

/// What the threads share.
struct Work {
    turns: usize,
    next: AtomicUsize,
    done: AtomicUsize,
    stop: AtomicBool,
}

type Batch<T> = Result<Vec<(usize, T)>, Error>;

impl Work {
    /// Take turns until none is left, or the caller said stop.
    fn run<T>(
        &self,
        mut turn: impl FnMut(usize) -> Result<T, Error>,
        send: &mpsc::Sender<Batch<T>>,
    ) -> Result<(), Error> {
        let stride = stride(self.turns);
        let mut batch = Vec::new();
        loop {
            let next = self.next.fetch_add(1, Ordering::Relaxed);
            let over = next >= self.turns || self.stop.load(Ordering::Relaxed);
            if over || batch.len() == BATCH {
                let _ = send.send(Ok(std::mem::take(&mut batch)));
            }
            if over {
                return Ok(());
            }
            let place = next * stride % self.turns;
            batch.push((place, turn(place)?));
            self.done.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Collect what arrives, and report the turns that are done.
    fn listen<T>(
        &self,
        receive: &mpsc::Receiver<Batch<T>>,
        take: &mut dyn FnMut(usize, T),
        tell: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), Error> {
        let mut told = Instant::now();
        let mut tell = || {
            tell(self.done.load(Ordering::Relaxed))
                .then_some(())
                .ok_or(Error::Stopped)
        };
        loop {
            match receive.recv_timeout(TICK) {
                Ok(batch) => batch?
                    .into_iter()
                    .for_each(|(place, found)| take(place, found)),
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => return tell(),
            }
            if told.elapsed() >= TICK {
                told = Instant::now();
                tell()?;
            }
        }
    }
}

/// The distance between consecutive turns. Every turn is taken once. The first ones are spread over all conditions, so
/// that a program with too large an error is dropped early.
fn stride(turns: usize) -> usize {
    let divisor = |a: usize, b: usize| {
        let (mut a, mut b) = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = turns * 5 / 8;
    (golden.max(1)..)
        .find(|stride| divisor(*stride, turns) == 1)
        .unwrap_or(1)
}

/// Take each of `turns` turns on one of `threads` threads, with what `make` makes for the thread; `take` gets place and
/// result, in any order; `tell` is told how many turns are done, and returns `false` to stop.
pub(super) fn each<T: Send, W: FnMut(usize) -> Result<T, Error>>(
    threads: usize,
    turns: usize,
    make: impl Fn() -> Result<W, Error> + Sync,
    take: &mut dyn FnMut(usize, T),
    tell: &mut dyn FnMut(usize) -> bool,
) -> Result<(), Error> {
    let work = &Work {
        turns,
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
    };
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, turns.max(1)) {
            let (send, make) = (send.clone(), &make);
            scope.spawn(move || {
                if let Err(error) = make().and_then(|turn| work.run(turn, &send)) {
                    let _ = send.send(Err(error));
                }
            });
        }
        drop(send);
        let found = work.listen(&receive, take, tell);
        work.stop.store(true, Ordering::Relaxed);
        found
    })
}
