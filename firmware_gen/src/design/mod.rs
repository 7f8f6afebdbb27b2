//! The search for the form and the format of least cost that meet the error bound.

mod bend;
mod candidate;
mod frame;
mod request;
mod search;
#[cfg(test)]
mod tests;
mod unreachable;

use crate::error::Error;
use crate::form;
use candidate::Candidate;
use search::Search;

pub use request::{Design, Failure, Listen, Progress, Reachable, Request};

/// Most candidates that are refined before the search restricts itself to the likely ones. Set by hand: it bounds the
/// search time of designs with humidity.
const REFINED: usize = 200;

/// Find the cheapest program that meets the bound on every input.
///
/// # Errors
/// [`Error::Bound`] with the best design if none does; [`Error::Model`] if the model itself fails somewhere.
pub fn design(request: Request<'_>, listen: Listen<'_>) -> Result<Design, Failure> {
    check(&request)?;
    let made = std::cell::OnceCell::new();
    let search = Search::new(request, |picked, lines| {
        let found = frame::frames(&request, picked, lines)?;
        Ok(made.get_or_init(|| found))
    })?;
    // The cheapest last; rounding can make a candidate dearer, which then waits for its turn again.
    let key = |candidate: &Candidate<'_>| std::cmp::Reverse(request.prefer.key(candidate.cost));
    let mut candidates = search.candidates();
    candidates.reverse(); // of equals, the one proposed first comes first
    candidates.sort_by_key(key);
    let bound = request.maximum_error * request.device.output.per_meter;
    let mut failed = Vec::new();
    let mut tried = 0;
    while let Some(mut candidate) = candidates.pop() {
        if candidate.screened == f64::INFINITY
            && candidate.floor() <= bound
            && candidate.least() <= bound
            && (tried < REFINED || candidate.likely() <= bound)
            && search.refine(&mut candidate)
        {
            tried += 1;
            let place = candidates.partition_point(|other| key(other) <= key(&candidate));
            candidates.insert(place, candidate);
            continue;
        }
        if candidate.screened <= bound {
            match search.prove(&candidate, bound, listen) {
                Ok((program, proof)) => return Ok(candidate.proven(program, proof)),
                Err(Error::Beyond(error)) => candidate.screened = error,
                Err(Error::Proof(_)) => {}
                Err(error) => return Err(error.into()),
            }
        }
        failed.push(candidate);
    }
    search.unreachable(failed, listen)
}

/// Largest bound [m] that is accepted. Set by hand: a larger number is most likely one of millimeters.
const LOOSEST: f64 = 0.1;

fn check(request: &Request<'_>) -> Result<(), Error> {
    for (what, value, unit) in [
        ("error bound", request.maximum_error * 1e3, "mm"),
        ("largest bounded distance", request.maximum_distance, "m"),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::Request(format!(
                "the {what} is {value} {unit}: give a positive number [{unit}]"
            )));
        }
    }
    if request.maximum_error > LOOSEST {
        return Err(Error::Request(format!(
            "the error bound is {} mm, and no distance sensor needs one above {} mm: 0.5 mm is \
             max_error=0.5e-3 [m] in Python, --max-error-mm 0.5 on the command line",
            request.maximum_error * 1e3,
            LOOSEST * 1e3
        )));
    }
    check_form(request)?;
    let (given, further) = (request.device.conditions.len(), request.device.further());
    if !(1..=2 + usize::from(further.is_some())).contains(&given) {
        return Err(Error::Request(format!(
            "the device has {given} condition inputs; this version designs for one or two, and a further one"
        )));
    }
    Ok(())
}

/// Whether the form asked for exists, and takes what the device measures.
fn check_form(request: &Request<'_>) -> Result<(), Error> {
    let Some(form) = request.form else {
        return Ok(());
    };
    if !form::all().any(|(name, _)| *name == form) {
        let known: Vec<_> = form::all().map(|(name, _)| *name).collect();
        return Err(Error::Request(format!(
            "unknown form '{form}'; this version has {}",
            known.join(", ")
        )));
    }
    if request.device.further().is_some() {
        return Ok(()); // which conditions a form reads depends on what the further input changes
    }
    match (form::reads_two(form), request.device.conditions.len()) {
        (true, 1) => Err(Error::Request(format!(
            "form '{form}' is of temperature and humidity, and the device measures no humidity: give its codes, or another form"
        ))),
        (false, 2) if request.device.varied() == 2 => Err(Error::Request(format!(
            "form '{form}' is of the temperature alone, and the device measures humidity too: 'additive' joins such forms"
        ))),
        _ => Ok(()),
    }
}
