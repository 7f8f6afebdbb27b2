//! The search: priors, hypotheses, pruning, and the posterior.

mod candidates;
mod form_preference;
mod noise_selection;
mod options;
mod posterior;
mod prior;
mod pruning;
mod shortlist;

pub use form_preference::preferred_form;
pub use options::SearchOptions;
pub use posterior::{Outcome, Posterior, posterior};
pub use prior::Prior;
