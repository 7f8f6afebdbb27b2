//! The search: priors, hypotheses, pruning, and the posterior.

mod candidates;
mod form_preference;
mod noise_selection;
mod posterior;
mod prior;
mod pruning;
mod shortlist;

pub use posterior::{Outcome, Posterior, posterior};
pub use prior::Prior;
