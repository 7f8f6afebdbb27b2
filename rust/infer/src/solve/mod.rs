//! The log evidence of one hypothesis: small linear systems, with the sizes of its causes integrated out.

mod blocks;
mod bounds;
mod fit;
mod hypothesis;
mod log_evidence;
mod mixture;
mod moments;
mod prior_widths;
mod ridge;
mod stack;
mod system;

pub use blocks::{Fitted, fit_blocks};
pub(crate) use fit::Accuracy;
pub use fit::HypothesisFit;
pub use hypothesis::Variant;
pub(crate) use hypothesis::{HypothesisColumns, columns};
pub use log_evidence::log_evidence;
pub(crate) use log_evidence::{EvidenceSolver, NARROWER};
pub(crate) use mixture::log_sum;
pub use prior_widths::WIDTHS;
pub use ridge::{residual_variance, ridge_coefficients};
pub(crate) use stack::NoiseTable;
pub use stack::WhitenedStack;
