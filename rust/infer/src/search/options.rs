//! What a search leaves out.

/// What a search leaves out, and which of several forms represents its causes.
#[derive(Clone, Copy, Debug)]
pub struct SearchOptions {
    /// Log odds against the most probable hypothesis beyond which one is pruned.
    pub pruning_log_odds: f64,
    /// Log odds between two forms of the same causes below which neither is preferred by its evidence,
    /// and the one with more coefficients is taken. 1.5, the value of the diagnosis, means odds of
    /// 4.5, well below the 20 that count as "strong" in Kass & Raftery 1995,
    /// doi:10.1080/01621459.1995.10476572.
    pub form_preference: f64,
    /// Probability that the least probable hypotheses may share and still be left out of what is found.
    pub unlisted: f64,
}
