//! Hypotheses: which columns act together, and what is known about their sizes beforehand.

/// One linear form of a cause: columns that enter as they are, columns with a coefficient, or both.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Which cause it is a form of; forms of one cause exclude each other.
    pub cause: usize,
    /// Whether it is an unexplained term: a basis function without a cause.
    pub is_unexplained: bool,
    /// Columns with coefficient one.
    pub offsets: Vec<usize>,
    /// Columns whose coefficient is to be found, in units of its prior standard deviation.
    pub free: Vec<usize>,
    /// Bounds of each coefficient, in the same units.
    pub bounds: Vec<(f64, f64)>,
    /// Probability among the forms of its cause.
    pub weight: f64,
}

/// Columns of some variants, and the last of all, in ascending order.
pub(crate) fn columns<'a>(
    variants: impl IntoIterator<Item = &'a Variant>,
    last: usize,
) -> Vec<usize> {
    let each = variants.into_iter();
    let own = each.flat_map(|variant| variant.offsets.iter().chain(&variant.free));
    let mut columns: Vec<usize> = own.copied().chain([last]).collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}

/// Several variants at once, one of each cause, laid out for the arithmetic.
#[derive(Clone, Debug, Default)]
pub(crate) struct HypothesisColumns {
    pub offsets: Vec<usize>,
    pub free: Vec<usize>,
    pub bounds: Vec<(f64, f64)>,
    /// Free columns of each variant that has any: they share one width of the prior.
    pub counts: Vec<usize>,
}

impl HypothesisColumns {
    pub(crate) fn fill<'a>(&mut self, variants: impl IntoIterator<Item = &'a Variant>) {
        self.offsets.clear();
        self.free.clear();
        self.bounds.clear();
        self.counts.clear();
        for variant in variants {
            self.offsets.extend(&variant.offsets);
            self.free.extend(&variant.free);
            self.bounds.extend(&variant.bounds);
            if !variant.free.is_empty() {
                self.counts.push(variant.free.len());
            }
        }
    }
}
