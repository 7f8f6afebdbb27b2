//! The log evidence of one hypothesis: small linear systems, with the sizes of its causes integrated out.

mod averaged_out;
mod bounds;
mod fit;
mod hypothesis;
mod imitation;
mod log_evidence;
mod mixture;
mod moments;
mod prior_widths;
mod ridge;
mod stack;
mod system;

pub use averaged_out::AveragedOut;
pub(crate) use fit::Accuracy;
pub use fit::HypothesisFit;
pub use hypothesis::Variant;
pub(crate) use hypothesis::{HypothesisColumns, columns};
pub use imitation::{Imitation, Signal};
pub use log_evidence::log_evidence;
pub(crate) use log_evidence::{EvidenceSolver, NARROWER};
pub(crate) use mixture::log_sum;
pub use prior_widths::WIDTHS;
pub use ridge::{mean_squares_left, residual_variance, ridge_coefficients};
pub(crate) use stack::NoiseTable;
pub use stack::WhitenedStack;
