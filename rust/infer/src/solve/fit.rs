//! What is found out about one hypothesis.

/// A hypothesis after the data.
#[derive(Clone, Debug, Default)]
pub struct HypothesisFit {
    /// Without the hypothesis's prior, with an arbitrary constant common to all.
    pub log_evidence: f64,
    /// Coefficients of the free columns, in prior standard deviations.
    pub mean: Vec<f64>,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Probability of each noise under this hypothesis.
    pub noise: Vec<f64>,
    /// Variance of the innovations.
    pub variance: f64,
}

/// How accurately the log evidence of a hypothesis is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// Every combination of widths that matters.
    Full,
    /// Of many causes, one width changed at a time; sizes with the best widths.
    Rough,
    /// The widest prior alone.
    Widest,
}
