//! What can go wrong, each with both sides of the comparison.

use crate::design::Reachable;
use crate::lower::Omission;

/// Why no firmware came out.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Error {
    /// The codes of the device make no sense.
    #[error("{0}")]
    Codes(String),
    /// A parameter of the request makes no sense.
    #[error("{0}")]
    Request(String),
    /// The model gives no finite distance, or one that does not grow with the echo time.
    #[error("{0}")]
    Model(String),
    /// An effect needs an input that the device lacks.
    #[error("{0}; {way_out}", way_out = .0.way_out())]
    Refused(Box<Omission>),
    /// No form meets the bound; what the best one reaches is inside.
    #[error("{0}")]
    Bound(Box<Reachable>),
    /// The caller asked to stop.
    #[error("stopped before the proof was complete")]
    Stopped,
    /// The program breaks a promise on some input: a defect of the design, tried again with the next candidate.
    #[error("{0}")]
    Proof(String),
    /// The program goes beyond the error allowed \[unit\] on some input: tried again with the next candidate.
    #[error("an error of {0} units is beyond what was claimed")]
    Beyond(f64),
    /// A template failed: a defect of this crate.
    #[error("template {0}")]
    Template(String),
}
