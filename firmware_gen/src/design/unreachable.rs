//! What is reported if no candidate meets the bound: the smallest error that is possible.

use super::candidate::Candidate;
use super::request::{Design, Failure, Listen, Reachable};
use super::search::Search;
use crate::error::Error;
use crate::form::is_bent;

/// Most candidates that are screened again. Set by hand.
const LIKELIEST: usize = 12;

impl Search<'_> {
    /// Prove the best of the failed candidates, and state its error.
    pub(super) fn unreachable(
        &self,
        failed: Vec<Candidate<'_>>,
        listen: Listen<'_>,
    ) -> Result<Design, Failure> {
        for candidate in self.likeliest(failed) {
            let (program, proof) = match self.prove(&candidate, f64::INFINITY, listen) {
                Ok(found) => found,
                Err(Error::Proof(_)) => continue,
                Err(error) => return Err(error.into()),
            };
            if proof.bounded.error <= self.bound() {
                return Ok(candidate.proven(program, proof)); // its estimated error was too large
            }
            let reachable = Reachable {
                asked: self.request.maximum_error,
                best: proof.bounded.error * self.request.device.output.lsb,
                maximum_distance: self.request.maximum_distance,
                form: candidate.form.describe(),
            };
            return Err(Failure {
                error: Error::Bound(reachable.to_string()),
                best: Some(Box::new(candidate.proven(program, proof))),
            });
        }
        Err(self.no_candidate().into())
    }

    /// The failed candidates that have a program, the most exact first.
    fn likeliest<'b>(&self, mut failed: Vec<Candidate<'b>>) -> Vec<Candidate<'b>> {
        let screened = failed.iter().map(|candidate| candidate.screened);
        let mut best = screened.fold(f64::INFINITY, f64::min);
        failed.sort_by(|a, b| a.floor().total_cmp(&b.floor()));
        for candidate in &mut failed {
            if candidate.screened == f64::INFINITY
                && candidate.floor() < best
                && candidate.least() < best
                && self.refine(candidate)
            {
                best = best.min(candidate.screened);
            }
        }
        // What was never screened is worse than the best, or has larger tables than allowed.
        failed.retain(|candidate| candidate.screened.is_finite());
        failed.sort_by(|a, b| a.screened.total_cmp(&b.screened));
        let mut best = f64::INFINITY;
        let (mut found, mut rest) = (Vec::new(), Vec::new());
        for mut candidate in failed {
            if found.len() >= LIKELIEST || candidate.screened >= best {
                rest.push(candidate);
            } else if self.look_at(&mut candidate) {
                best = best.min(candidate.screened);
                found.push(candidate);
            }
        }
        found.sort_by(|a, b| a.screened.total_cmp(&b.screened));
        found.extend(rest); // for where the proof finds fault with the best
        found
    }

    /// The error if there is no candidate at all.
    fn no_candidate(&self) -> Error {
        let form = self.request.form;
        if self.bend.is_none() && form.is_some_and(is_bent) {
            return Error::Request(format!(
                "form '{}' is for distances that bend over the echo time, and these are straight within a tenth of the bound: choose another form",
                form.unwrap_or_default()
            ));
        }
        self.request.no_candidate()
    }
}
