//! The proof: the twin against the model on every input that the function accepts.

mod checker;
mod claim;
mod crew;
mod hash;
mod quick;
mod row;
mod straight;

use crate::error::Error;
use crate::ir::Program;
use checker::Checker;
use crew::each;
use quick::{Quick, Records};
use row::{Fault, Row, Times};

pub use claim::{Claim, Proof, SEED, Worst, fold};
pub(crate) use straight::Straight;

/// How a row was proven, and with what outcome.
enum Checked {
    /// By bounds; its outputs are to be hashed.
    Quick(Row, Straight),
    /// At every echo code; with the hash of its outputs.
    Every(Row, u32),
}

/// One thread of the proof.
struct Prover<'a> {
    program: &'a Program,
    claim: Claim<'a>,
    times: &'a Times,
    records: &'a Records,
    checker: Checker<'a>,
    /// Whether every echo code is evaluated, whatever could be proven without.
    every: bool,
}

impl Prover<'_> {
    fn row(&mut self, row: usize) -> Result<Checked, Error> {
        let quick = if self.every { None } else { self.quick(row)? };
        let checked = match quick {
            Some((result, straight)) => Checked::Quick(result, straight),
            None => {
                let (result, hash) = self.checker.row(row)?;
                Checked::Every(result, hash)
            }
        };
        let error = checked.row().bounded.error;
        if error > self.claim.most {
            return Err(Error::Beyond(error));
        }
        Ok(checked)
    }

    fn quick(&self, row: usize) -> Result<Option<(Row, Straight)>, Error> {
        let device = self.claim.device;
        let ends = (device.echo.codes.minimum, device.echo.codes.maximum);
        let straight = Straight::of(self.program, &device.codes(row), ends)
            .map_err(|overflow| Fault { device, row }.overflow(&overflow, ends.0))?;
        let Some(straight) = straight else {
            return Ok(None);
        };
        let conditions = device.values(row);
        let quick = Quick {
            claim: self.claim,
            times: self.times,
            records: self.records,
            straight,
            shape: self.claim.reference.shape(&conditions),
            row,
            conditions,
        };
        Ok(quick.check()?.map(|row| (row, straight)))
    }
}

impl Checked {
    const fn row(&self) -> &Row {
        match self {
            Self::Quick(row, _) | Self::Every(row, _) => row,
        }
    }
}

/// Check `program` on every input. `progress` receives the number of checked inputs; it returns `false` to stop.
///
/// Where bounds show that the error of some inputs is below the largest, these inputs are not evaluated one by one; the
/// result is the same as that of [`prove_one_by_one`]. All outputs are hashed in any case.
///
/// # Errors
/// If an intermediate overflows, the output falls as the echo time grows, the model has no distance somewhere, the
/// error exceeds the claim, no input is within the bounded domain, or `progress` returned `false`.
pub fn prove(
    program: &Program,
    claim: Claim<'_>,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<Proof, Error> {
    run(program, claim, false, progress)
}

/// [`prove`] by brute force: every step of the twin and the model at every input.
///
/// # Errors
/// As for [`prove`].
pub fn prove_one_by_one(
    program: &Program,
    claim: Claim<'_>,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<Proof, Error> {
    run(program, claim, true, progress)
}

fn run(
    program: &Program,
    claim: Claim<'_>,
    every: bool,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Result<Proof, Error> {
    let rows = claim.device.rows();
    let (times, records) = (&Times::of(claim.device), &Records::default());
    let mut proof = Proof {
        bounded: Worst::NONE,
        overall: Worst::NONE,
        inputs: claim.device.inputs(),
        bounded_inputs: 0,
        hash: SEED,
    };
    let mut lines = vec![None; rows];
    let mut hashes = vec![None; rows];
    // Half of the work is to bound the errors, half to hash the outputs.
    let (inputs, threads) = (proof.inputs, claim.threads);
    let half = |done: usize, of: usize| (inputs as f64 / 2.0 * done as f64 / of as f64) as u64;
    each(
        threads,
        rows,
        || {
            let mut prover = Prover {
                program,
                claim,
                times,
                records,
                checker: Checker::new(program, claim, times)?,
                every,
            };
            Ok(move |row| prover.row(row))
        },
        &mut |row, checked: Checked| {
            let found = checked.row();
            proof.bounded = proof.bounded.or(found.bounded);
            proof.overall = proof.overall.or(found.overall);
            proof.bounded_inputs += found.within;
            match checked {
                Checked::Quick(_, straight) => lines[row] = Some(straight),
                Checked::Every(_, hash) => hashes[row] = Some(hash),
            }
        },
        &mut |done| progress(half(done, rows)),
    )?;
    let straight: Vec<usize> = (0..rows).filter(|row| lines[*row].is_some()).collect();
    let groups: Vec<&[usize]> = straight.chunks(hash::ROWS).collect();
    each(
        threads,
        groups.len(),
        || {
            Ok(|group: usize| {
                let line = |row: &usize| lines[*row];
                let mut found = groups[group].iter().filter_map(line);
                let first = found.next().ok_or(Error::Stopped)?;
                let rows = std::array::from_fn(|k| {
                    if k == 0 {
                        first
                    } else {
                        found.next().unwrap_or(first)
                    }
                });
                Ok(hash::hashes(&rows, claim.device.echo.codes))
            })
        },
        &mut |group: usize, found| {
            let pairs = groups[group].iter().zip(found);
            pairs.for_each(|(row, hash)| hashes[*row] = Some(hash));
        },
        &mut |done| progress(inputs / 2 + half(done, groups.len())),
    )?;
    if !progress(inputs) {
        return Err(Error::Stopped);
    }
    for hash in hashes {
        let hash = hash.ok_or_else(|| Error::Proof("a row was not checked".into()))?;
        proof.hash = fold(proof.hash, hash);
    }
    if proof.bounded_inputs == 0 {
        return Err(Error::Request(
            "no input is within the largest bounded distance: nothing would be proven".into(),
        ));
    }
    Ok(proof)
}
