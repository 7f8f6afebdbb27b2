//! The proof: the twin against the model on every input that the function accepts.

mod checker;
mod claim;
mod crew;
mod quick;
mod row;
mod straight;

use crate::error::Error;
use crate::hash::Hash;
use crate::ir::{Operation, Program, Value};
use crate::types::Range;
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
        let fault = Fault { device, row };
        let (codes, conditions) = (device.codes(row), device.values(row));
        let shape = self.claim.reference.shape(&conditions);
        let (mut whole, mut hash) = (Row::new(row, self.claim), Hash::default());
        let mut before = i64::from(i32::MIN);
        for part in parts(self.program, device.echo.codes) {
            let ends = (part.minimum, part.maximum);
            let straight = Straight::of(self.program, &codes, ends)
                .map_err(|overflow| fault.overflow(&overflow, ends.0))?;
            let Some(straight) = straight else {
                return Ok(None);
            };
            if i64::from(straight.output(ends.0)) < before {
                return Err(fault.falls(ends.0));
            }
            before = straight.output(ends.1).into();
            let quick = Quick {
                claim: self.claim,
                records: self.records,
                straight,
                codes: part,
                shape: &shape,
                row,
                conditions: &conditions,
            };
            let Some(found) = quick.check()? else {
                return Ok(None);
            };
            whole.join(&found);
            hash = hash.then(straight.hash(part));
        }
        Ok(Some((whole, hash)))
    }
}

/// The echo codes in parts, in each of which what the program takes of the high bits of the code is constant.
fn parts(program: &Program, codes: Range) -> impl Iterator<Item = Range> {
    let echo = |value: Value| matches!(program.node(value).operation, Operation::Input(0));
    let taken = program
        .nodes
        .iter()
        .filter_map(|node| match node.operation {
            Operation::ShiftRight(value, bits) if echo(value) => Some(bits),
            _ => None,
        });
    let width = taken.min().map_or(i64::MAX, |bits| 1 << bits);
    let first = codes.minimum / width;
    (first..=codes.maximum / width).map(move |part| Range {
        minimum: codes.minimum.max(part.saturating_mul(width)),
        maximum: codes.maximum.min((part + 1).saturating_mul(width) - 1),
    })
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
