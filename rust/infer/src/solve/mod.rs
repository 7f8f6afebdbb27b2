//! The log evidence of one hypothesis: small linear systems, with the sizes of its causes integrated out.

mod bounds;
mod fit;
mod hypothesis;
mod log_evidence;
mod mixture;
mod moments;
mod prior_widths;
mod stack;
mod system;

pub(crate) use fit::Accuracy;
pub use fit::HypothesisFit;
pub use hypothesis::Variant;
pub(crate) use hypothesis::{HypothesisColumns, columns};
pub use log_evidence::log_evidence;
pub(crate) use log_evidence::{EvidenceSolver, NARROWER};
pub(crate) use mixture::log_sum;
pub use prior_widths::WIDTHS;
pub(crate) use stack::NoiseTable;
pub use stack::WhitenedStack;
