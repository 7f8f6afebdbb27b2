//! The proof: the twin against the model on every input that the function accepts.

use crate::device::Device;
use crate::error::Error;
use crate::ir::{Block, LANES, Program};
use crate::reference::{Reference, place};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// How often the caller hears about the progress.
const TICK: Duration = Duration::from_millis(50);

/// The input at which the error is largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// |output - model| \[um\].
    pub error: f64,
    /// Combination of conditions, as [`Device::codes`] counts them.
    pub row: usize,
    /// Echo code.
    pub echo: i64,
}

impl Worst {
    const NONE: Self = Self {
        error: -1.0,
        row: 0,
        echo: 0,
    };

    fn or(self, other: Self) -> Self {
        if other.error > self.error {
            other
        } else {
            self
        }
    }
}

/// What holds for every input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// Largest error where the model's distance is within the bounded domain.
    pub bounded: Worst,
    /// Largest error over all inputs.
    pub overall: Worst,
    /// Inputs that were checked.
    pub inputs: u64,
    /// Inputs within the bounded domain.
    pub bounded_inputs: u64,
    /// Hash of all outputs in order, see [`fold`].
    pub hash: u32,
}

/// One step of the hash over outputs (FNV-1a with words for bytes): short enough to be repeated on any target.
///
/// Each row of echo times is folded from [`SEED`]; the rows' hashes are folded from [`SEED`] again.
#[must_use]
pub const fn fold(hash: u32, word: u32) -> u32 {
    (hash ^ word).wrapping_mul(16_777_619)
}

/// Where the hash begins.
pub const SEED: u32 = 2_166_136_261;

/// What to prove a program against.
#[derive(Clone, Copy)]
pub struct Claim<'a> {
    /// The inputs.
    pub device: &'a Device,
    /// The truth.
    pub reference: &'a dyn Reference,
    /// The bounded domain: distances up to this \[m\].
    pub maximum_distance: f64,
    /// Threads to use.
    pub threads: usize,
}

struct Row {
    bounded: Worst,
    overall: Worst,
    within: u64,
    hash: u32,
}

/// Check `program` on every input. `progress` hears how many inputs are done and says whether to go on.
///
/// # Errors
/// If an intermediate overflows, the output falls as the echo time grows, the model has no distance somewhere, or
/// `progress` said stop.
pub fn prove(
    program: &Program,
    claim: Claim<'_>,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<Proof, Error> {
    let rows = claim.device.rows();
    let (next, done, stop) = (
        AtomicUsize::new(0),
        AtomicU64::new(0),
        AtomicBool::new(false),
    );
    let (send, receive) = mpsc::channel();
    let work = |send: &mpsc::Sender<Result<(usize, Row), Error>>| {
        let mut checker = Checker::new(program, claim)?;
        loop {
            let row = next.fetch_add(1, Ordering::Relaxed);
            if row >= rows || stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let result = checker.row(row)?;
            done.fetch_add(claim.device.echo.len() as u64, Ordering::Relaxed);
            let _ = send.send(Ok((row, result)));
        }
    };
    let mut found: Vec<Option<Row>> = (0..rows).map(|_| None).collect();
    std::thread::scope(|scope| {
        for _ in 0..claim.threads.clamp(1, rows) {
            let send = send.clone();
            let work = &work;
            scope.spawn(move || {
                if let Err(error) = work(&send) {
                    let _ = send.send(Err(error));
                }
            });
        }
        drop(send);
        let listened = listen(&receive, &mut found, &done, progress);
        stop.store(true, Ordering::Relaxed);
        listened
    })?;
    Ok(gather(&found, claim.device))
}

/// Take the rows as they come, and tell the caller now and then.
fn listen(
    receive: &mpsc::Receiver<Result<(usize, Row), Error>>,
    found: &mut [Option<Row>],
    done: &AtomicU64,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<(), Error> {
    let mut told = std::time::Instant::now();
    loop {
        match receive.recv_timeout(TICK) {
            Ok(message) => {
                let (row, result) = message?;
                found[row] = Some(result);
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Err(mpsc::RecvTimeoutError::Timeout) => {}
        }
        if told.elapsed() >= TICK {
            told = std::time::Instant::now();
            if !progress(done.load(Ordering::Relaxed)) {
                return Err(Error::Stopped);
            }
        }
    }
    progress(done.load(Ordering::Relaxed))
        .then_some(())
        .ok_or(Error::Stopped)
}

fn gather(found: &[Option<Row>], device: &Device) -> Proof {
    let none = Proof {
        bounded: Worst::NONE,
        overall: Worst::NONE,
        inputs: 0,
        bounded_inputs: 0,
        hash: SEED,
    };
    found.iter().flatten().fold(none, |proof, row| Proof {
        bounded: proof.bounded.or(row.bounded),
        overall: proof.overall.or(row.overall),
        inputs: proof.inputs + device.echo.len() as u64,
        bounded_inputs: proof.bounded_inputs + row.within,
        hash: fold(proof.hash, row.hash),
    })
}

/// One thread's working memory.
struct Checker<'a> {
    claim: Claim<'a>,
    block: Block<'a>,
    times: Vec<f64>,
    truth: Vec<f64>,
}

impl<'a> Checker<'a> {
    fn new(program: &'a Program, claim: Claim<'a>) -> Result<Self, Error> {
        let codes = claim.device.echo.codes;
        let times: Vec<f64> = (codes.minimum..=codes.maximum)
            .map(|code| claim.device.echo.value(code))
            .collect();
        let block = Block::new(program).map_err(|overflow| Error::Proof(overflow.to_string()))?;
        Ok(Self {
            claim,
            block,
            truth: vec![0.0; times.len()],
            times,
        })
    }

    fn row(&mut self, row: usize) -> Result<Row, Error> {
        let device = self.claim.device;
        let overflow = |overflow: crate::ir::Overflow| {
            Error::Proof(format!("{overflow}; {}", place(device, row, 0)))
        };
        self.claim
            .reference
            .distances(&device.values(row), &self.times, &mut self.truth);
        self.block
            .set_conditions(&device.codes(row))
            .map_err(overflow)?;
        let mut result = Row {
            bounded: Worst::NONE,
            overall: Worst::NONE,
            within: 0,
            hash: SEED,
        };
        let mut before = i64::MIN;
        let codes = device.echo.codes;
        for (index, truth) in self.truth.chunks(LANES).enumerate() {
            let first = codes.minimum + (index * LANES) as i64;
            let outputs = self
                .block
                .evaluate(first, codes.maximum)
                .map_err(overflow)?;
            let outputs = &outputs[..truth.len()];
            if let Some(fall) = falls(before, outputs) {
                let place = place(device, row, first + fall as i64);
                return Err(Error::Proof(format!(
                    "the output falls as the echo time grows, at {place}"
                )));
            }
            before = outputs[outputs.len() - 1];
            result.hash = outputs
                .iter()
                .fold(result.hash, |hash, output| fold(hash, *output as u32));
            compare(self.claim, &mut result, (row, first), outputs, truth)?;
        }
        Ok(result)
    }
}

/// Take in the errors of one block of outputs.
fn compare(
    claim: Claim<'_>,
    result: &mut Row,
    (row, first): (usize, i64),
    outputs: &[i64],
    truth: &[f64],
) -> Result<(), Error> {
    let far = claim.maximum_distance * 1e6;
    let (mut overall, mut bounded, mut within, mut finite) = (-1.0_f64, -1.0_f64, 0, 0.0);
    for (output, truth) in outputs.iter().zip(truth) {
        let truth = truth * 1e6;
        // Outputs fit `int32_t`; the narrower conversion is the one that vectorizes.
        let error = (f64::from(*output as i32) - truth).abs();
        let inside = truth <= far;
        finite += truth * 0.0;
        overall = overall.max(error);
        bounded = bounded.max(if inside { error } else { -1.0 });
        within += u64::from(inside);
    }
    if finite != 0.0 {
        return Err(Error::Model(format!(
            "the model gives no distance near {}",
            place(claim.device, row, first)
        )));
    }
    result.within += within;
    let find = |largest: f64, limit: f64| {
        let errors = outputs.iter().zip(truth).position(|(output, truth)| {
            truth * 1e6 <= limit && (f64::from(*output as i32) - truth * 1e6).abs() >= largest
        });
        Worst {
            error: largest,
            row,
            echo: first + errors.unwrap_or(0) as i64,
        }
    };
    if overall > result.overall.error {
        result.overall = find(overall, f64::INFINITY);
    }
    if bounded > result.bounded.error {
        result.bounded = find(bounded, far);
    }
    Ok(())
}

/// The first place at which `outputs` fall, continuing from `before`.
fn falls(before: i64, outputs: &[i64]) -> Option<usize> {
    let fell = outputs
        .windows(2)
        .fold(outputs[0] < before, |fell, pair| fell | (pair[1] < pair[0]));
    let first = || {
        outputs
            .windows(2)
            .position(|pair| pair[1] < pair[0])
            .map_or(0, |position| position + 1)
    };
    fell.then(first)
}
