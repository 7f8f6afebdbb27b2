//! Whole models as batch kernels.

use super::{Formula, Kernel, kernel};
use crate::chain::Stage;
use crate::conditions::{Conditions, Quantity};
use crate::model::{Given, Model};
use crate::scalar::Rows;

/// What a kernel of a model computes; its inputs are the quantity named here and every influence
/// quantity, in the order of [`Quantity::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelOutput {
    /// Of a distance \[m\]: what the device indicates \[m\].
    Indication,
    /// Of a distance \[m\]: speed of sound on the path \[m/s\].
    SpeedOfSound,
    /// Of a distance \[m\]: recorded echo time \[s\].
    TimeOfFlight,
    /// Of an indication \[m\]: the distance \[m\], NaN where there is none.
    Correction,
    /// Of a recorded echo time \[s\]: the distance \[m\], NaN where there is none.
    Distance,
}

/// The kernel of a model. It computes row by row in double precision, also between single-precision
/// columns.
#[must_use]
pub fn of_model(model: Model, output: ModelOutput) -> Box<dyn Kernel> {
    kernel(Simulation { model, output })
}

const INPUTS: usize = 1 + Quantity::COUNT;

struct Simulation {
    model: Model,
    output: ModelOutput,
}

impl Formula<INPUTS> for Simulation {
    /// All effects and laws in one function, on several registers of several numbers with their
    /// derivatives, take the compiler more than ten minutes.
    const ROW_BY_ROW: bool = true;

    fn parameters(&self) -> Vec<f64> {
        self.model.parameters()
    }

    #[inline(always)]
    fn evaluate<S: Rows>(&self, [first, rest @ ..]: [S; INPUTS], parameters: &[S]) -> S {
        let recorded = Conditions::new(rest);
        let last = match self.output {
            ModelOutput::Correction | ModelOutput::Distance => {
                let given = match self.output {
                    ModelOutput::Correction => Given::Indication(first),
                    _ => Given::Time(first),
                };
                return self.model.invert(given, &recorded, parameters);
            }
            ModelOutput::Indication => Stage::Indication,
            ModelOutput::TimeOfFlight => Stage::Timer,
            ModelOutput::SpeedOfSound => Stage::Speed,
        };
        let chain = self.model.simulate_to(last, first, &recorded, parameters);
        match self.output {
            ModelOutput::Indication => chain.indication,
            ModelOutput::TimeOfFlight => chain.time,
            _ => chain.speed,
        }
    }
}
