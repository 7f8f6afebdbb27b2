//! The proof: the twin against the model on every input that the function accepts.

mod checker;
mod claim;
mod crew;
mod quick;
mod row;
mod straight;

use crate::error::Error;
use crate::hash::Hash;
use crate::ir::Program;
use checker::Checker;
use crew::each;
use quick::{Quick, Records};
use row::{Fault, Row};

pub use claim::{Claim, Proof, Reach, Worst};
pub(crate) use straight::Straight;

/// One thread of the proof.
struct Prover<'a> {
    program: &'a Program,
    claim: Claim<'a>,
    records: &'a Records,
    checker: Checker<'a>,
    /// Whether every echo code is evaluated, whatever could be proven without.
    every: bool,
}

impl Prover<'_> {
    fn row(&mut self, row: usize) -> Result<(Row, Hash), Error> {
        let quick = if self.every { None } else { self.quick(row)? };
        let checked = quick.map_or_else(|| self.checker.row(row), Ok)?;
        let error = checked.0.bounded.error;
        if error > self.claim.most {
            return Err(Error::Beyond(error));
        }
        Ok(checked)
    }

    fn quick(&self, row: usize) -> Result<Option<(Row, Hash)>, Error> {
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
            records: self.records,
            straight,
            shape: self.claim.reference.shape(&conditions),
            row,
            conditions,
        };
        let hash = |row| (row, straight.hash(device.echo.codes));
        Ok(quick.check()?.map(hash))
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
    let records = &Records::default();
    let mut proof = Proof {
        bounded: Worst::NONE,
        overall: Worst::NONE,
        inputs: claim.device.inputs(),
        bounded_inputs: 0,
        reach: Reach::NONE,
        hash: 0,
    };
    let mut hashes = vec![None; rows];
    let width = claim.device.echo.len() as u64;
    each(
        claim.threads,
        rows,
        || {
            let mut prover = Prover {
                program,
                claim,
                records,
                checker: Checker::new(program, claim)?,
                every,
            };
            Ok(move |row| prover.row(row))
        },
        &mut |row, (found, hash): (Row, Hash)| {
            proof.bounded = proof.bounded.or(found.bounded);
            proof.overall = proof.overall.or(found.overall);
            proof.bounded_inputs += found.within;
            proof.reach = proof.reach.with(found.ends);
            hashes[row] = Some(hash);
        },
        &mut |done| progress(done as u64 * width),
    )?;
    let mut all = Hash::default();
    for hash in hashes {
        let hash = hash.ok_or_else(|| Error::Proof("a row was not checked".into()))?;
        all = all.then(hash);
    }
    proof.hash = all.value;
    if proof.bounded_inputs == 0 {
        return Err(Error::Request(
            "no input is within the largest bounded distance: nothing would be proven".into(),
        ));
    }
    Ok(proof)
}
