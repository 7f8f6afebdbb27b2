//! The proof: the twin against the model on every input that the function accepts.

mod checker;
mod claim;
mod straight;

use crate::device::Device;
use crate::error::Error;
use crate::ir::Program;
use checker::{Checker, Row};

pub use claim::{Claim, Proof, SEED, Worst, fold};

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Interval between two reports of the progress. Set by hand.
const TICK: Duration = Duration::from_millis(50);

type Message = Result<(usize, Row), Error>;

/// What the threads share.
#[derive(Default)]
struct Work {
    next: AtomicUsize,
    done: AtomicU64,
    stop: AtomicBool,
}

impl Work {
    /// Check rows until none is left, or the caller said stop.
    fn run(
        &self,
        program: &Program,
        claim: Claim<'_>,
        send: &mpsc::Sender<Message>,
    ) -> Result<(), Error> {
        let mut checker = Checker::new(program, claim)?;
        let rows = claim.device.rows();
        let stride = stride(rows);
        loop {
            let turn = self.next.fetch_add(1, Ordering::Relaxed);
            if turn >= rows || self.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let row = turn * stride % rows;
            let result = checker.row(row)?;
            if result.bounded.error > claim.most {
                return Err(Error::Beyond(result.bounded.error));
            }
            self.done
                .fetch_add(claim.device.echo.len() as u64, Ordering::Relaxed);
            let _ = send.send(Ok((row, result)));
        }
    }

    /// Collect the rows as they arrive, and report the progress.
    fn listen(
        &self,
        receive: &mpsc::Receiver<Message>,
        rows: usize,
        progress: &mut dyn FnMut(u64) -> bool,
    ) -> Result<Vec<Option<Row>>, Error> {
        let mut found: Vec<Option<Row>> = (0..rows).map(|_| None).collect();
        let mut told = Instant::now();
        let mut tell = || {
            progress(self.done.load(Ordering::Relaxed))
                .then_some(())
                .ok_or(Error::Stopped)
        };
        loop {
            match receive.recv_timeout(TICK) {
                Ok(message) => {
                    let (row, result) = message?;
                    found[row] = Some(result);
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => return tell().map(|()| found),
            }
            if told.elapsed() >= TICK {
                told = Instant::now();
                tell()?;
            }
        }
    }
}

/// The distance between consecutively checked rows. Every row is checked once. The first rows are spread over all
/// conditions, so that a program with too large an error is dropped early.
fn stride(rows: usize) -> usize {
    let divisor = |a: usize, b: usize| {
        let (mut a, mut b) = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = rows * 5 / 8;
    (golden.max(1)..)
        .find(|stride| divisor(*stride, rows) == 1)
        .unwrap_or(1)
}

/// Check `program` on every input. `progress` receives the number of checked inputs; it returns `false` to stop.
///
/// # Errors
/// If an intermediate overflows, the output falls as the echo time grows, the model has no distance somewhere, the
/// error exceeds the claim, no input is within the bounded domain, or `progress` returned `false`.
pub fn prove(
    program: &Program,
    claim: Claim<'_>,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<Proof, Error> {
    let rows = claim.device.rows();
    let work = &Work::default();
    let (send, receive) = mpsc::channel();
    let found = std::thread::scope(|scope| {
        for _ in 0..claim.threads.clamp(1, rows) {
            let send = send.clone();
            scope.spawn(move || {
                if let Err(error) = work.run(program, claim, &send) {
                    let _ = send.send(Err(error));
                }
            });
        }
        drop(send);
        let found = work.listen(&receive, rows, progress);
        work.stop.store(true, Ordering::Relaxed);
        found
    })?;
    gather(&found, claim.device)
}

/// The proof of all rows, in their order; a row without a result proves nothing, and neither do no inputs.
fn gather(found: &[Option<Row>], device: &Device) -> Result<Proof, Error> {
    let mut proof = Proof {
        bounded: Worst::NONE,
        overall: Worst::NONE,
        inputs: 0,
        bounded_inputs: 0,
        hash: SEED,
    };
    for row in found {
        let row = row
            .as_ref()
            .ok_or_else(|| Error::Proof("a row was not checked".into()))?;
        proof.bounded = proof.bounded.or(row.bounded);
        proof.overall = proof.overall.or(row.overall);
        proof.inputs += device.echo.len() as u64;
        proof.bounded_inputs += row.within;
        proof.hash = fold(proof.hash, row.hash);
    }
    if proof.bounded_inputs == 0 {
        return Err(Error::Request(
            "no input is within the largest bounded distance: nothing would be proven".into(),
        ));
    }
    Ok(proof)
}
