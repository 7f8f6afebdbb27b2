//! The measurement chain, from the air to the indication.
//!
//! Each stage has one variable that the effects of that stage change. A stage never looks
//! downstream: its effects may read what earlier stages left and what was recorded.

use crate::air::Air;
use crate::conditions::Conditions;
use crate::scalar::Scalar;

/// The stages of the measurement chain, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// State of the air on the path; changes [`Chain::air`].
    Air,
    /// Speed of sound; changes [`Chain::speed`].
    Speed,
    /// Acoustic path; changes [`Chain::path`].
    Path,
    /// Time of flight, out and back; changes [`Chain::time`].
    Flight,
    /// Transducer and comparator; changes [`Chain::time`].
    Transducer,
    /// Timer; changes [`Chain::time`].
    Timer,
    /// The firmware's own arithmetic; changes [`Chain::firmware_speed`].
    Firmware,
    /// The indication; changes [`Chain::indication`].
    Indication,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 8] = [
        Self::Air,
        Self::Speed,
        Self::Path,
        Self::Flight,
        Self::Transducer,
        Self::Timer,
        Self::Firmware,
        Self::Indication,
    ];

    /// Name in Python and in documentation.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Air => "air",
            Self::Speed => "speed",
            Self::Path => "path",
            Self::Flight => "flight",
            Self::Transducer => "transducer",
            Self::Timer => "timer",
            Self::Firmware => "firmware",
            Self::Indication => "indication",
        }
    }
}

/// The variables of one measurement as it passes the chain.
#[derive(Clone, Copy, Debug)]
pub struct Chain<S> {
    /// What was recorded beside the echo; no effect changes it.
    pub recorded: Conditions<S>,
    /// True distance from the sensor's face to the target \[m\]; no effect changes it.
    pub distance: S,
    /// Air on the path.
    pub air: Air<S>,
    /// Speed of sound on the path \[m/s\].
    pub speed: S,
    /// One-way acoustic path \[m\].
    pub path: S,
    /// Echo time, out and back, as known so far \[s\].
    pub time: S,
    /// Speed that the device converts the echo time with \[m/s\].
    pub firmware_speed: S,
    /// What the device indicates \[m\].
    pub indication: S,
}

impl<S: Scalar> Chain<S> {
    /// The start of the chain; later variables are NaN until their stage is reached.
    #[inline(always)]
    pub fn start(distance: S, recorded: &Conditions<S>) -> Self {
        let unset = S::constant(f64::NAN);
        Self {
            recorded: *recorded,
            distance,
            air: Air::recorded(recorded),
            speed: unset,
            path: unset,
            time: unset,
            firmware_speed: unset,
            indication: unset,
        }
    }
}
