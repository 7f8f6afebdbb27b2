//! Models of noise: how it is correlated, and what rows share.
//!
//! Correlation is a registry. To add a model, write its file with the trait [`Correlation`] and add
//! one line to `registry!` below: the gathering of sums, the whitening and the conformance tests read
//! the registry.

mod correlation;
mod shared_error;
mod whiten;

pub use convection::Path;
pub use correlation::{Autoregression, Correlation};
pub use whiten::{NoiseModel, TableSums};

use crate::gram::{LagProducts, RowLayout, Source};

macro_rules! registry {
    ($($module:ident :: $model:ident),+ $(,)?) => {
        $(mod $module; pub use $module::$model;)+

        /// How the noise of a row is tied to that of the rows before: one model of the registry.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum NoiseCorrelation {
            $(#[doc = concat!("See [`", stringify!($model), "`].")] $model($model)),+
        }

        impl NoiseCorrelation {
            /// The sums of products of the filtered columns for each of some models, in at most one
            /// pass over the rows for each kind.
            ///
            /// # Panics
            /// If the columns and the layout differ in length.
            #[must_use]
            pub fn gather(
                source: &dyn Source,
                layout: &RowLayout<'_>,
                models: &[Self],
                threads: usize,
            ) -> Vec<LagProducts> {
                let mut found: Vec<Option<LagProducts>> = vec![None; models.len()];
                $(
                    let (mut places, mut own) = (Vec::new(), Vec::new());
                    for (place, &model) in models.iter().enumerate() {
                        if let Self::$model(model) = model {
                            places.push(place);
                            own.push(model);
                        }
                    }
                    if !own.is_empty() {
                        let sums = $model::gather(source, layout, &own, threads);
                        for (place, sums) in places.into_iter().zip(sums) {
                            found[place] = Some(sums);
                        }
                    }
                )+
                found.into_iter().flatten().collect()
            }

            /// A series of values whitened, with the sum of the log variances that its rows had
            /// beside the innovations'.
            ///
            /// # Panics
            /// If the slices differ in length.
            #[must_use]
            pub fn whitened(
                self,
                autoregression: Autoregression,
                values: &[f64],
                starts: &[bool],
                distance: &[f64],
            ) -> (Vec<f64>, f64) {
                match self {
                    $(Self::$model(model) => model.whitened(autoregression, values, starts, distance)),+
                }
            }
        }

        /// Every example of every model, with its name and its autoregressive coefficient.
        #[cfg(test)]
        fn examples() -> Vec<(NoiseCorrelation, f64)> {
            let mut found = Vec::new();
            $(found.extend($model::examples().into_iter().map(|(m, rho)| (NoiseCorrelation::$model(m), rho)));)+
            found
        }

        #[cfg(test)]
        fn covariance(of: NoiseCorrelation, rho: f64, lag: usize, distances: [f64; 2]) -> f64 {
            match of {
                $(NoiseCorrelation::$model(model) => model.covariance(rho, lag, distances)),+
            }
        }
    };
}

registry! {
    white::White,
    autocorrelation::MovingAverage,
    convection::Convection,
}

#[cfg(test)]
mod conformance;
