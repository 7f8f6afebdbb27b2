//! Errors. Each message states the value found and the value required.

/// The reason why no firmware was generated.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Error {
    /// The codes of the device are invalid.
    #[error("{0}")]
    Codes(String),
    /// A parameter of the request is invalid.
    #[error("{0}")]
    Request(String),
    /// The model gives no finite distance, or one that does not grow with the echo time.
    #[error("{0}")]
    Model(String),
    /// An effect needs an input that the device lacks.
    #[error("{0}")]
    Refused(String),
    /// No form meets the error bound.
    #[error("{0}")]
    Bound(String),
    /// The caller asked to stop.
    #[error("stopped before the proof was complete")]
    Stopped,
    /// The program violates a claim on some input. The search goes on with the next candidate.
    #[error("{0}")]
    Proof(String),
    /// The error \[unit\] of the program exceeds the bound on some input. The search goes on with the next candidate.
    #[error("the error of {0} units exceeds the bound")]
    Beyond(f64),
    /// A template failed: a defect of this crate.
    #[error("template {0}")]
    Template(String),
}
