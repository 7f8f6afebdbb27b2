//! The batch kernels that a law alone gives.

use super::{Formula, Kernel, kernel};
use crate::air::{Air, Law, LawVisitor, SpeedLaw};
use crate::echo;
use crate::scalar::Scalar;

/// Temperature, relative humidity, pressure and CO2 mole fraction to speed of sound.
#[must_use]
pub fn speed_of_sound(law: &Law) -> Box<dyn Kernel> {
    struct Build;
    impl LawVisitor for Build {
        type Output = Box<dyn Kernel>;
        fn visit<L: SpeedLaw>(self, law: L) -> Self::Output {
            kernel(SpeedOfSound(law))
        }
    }
    law.visit(Build)
}
