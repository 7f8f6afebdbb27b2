//! The batch kernels that need no model: laws, absorption, the echo.

use super::{Formula, Kernel, kernel};
use crate::air::{self, Air, Law, LawVisitor, SpeedLaw};
use crate::echo;
use crate::scalar::Scalar;

/// What a kernel of one law computes. The air comes last in its inputs, as temperature \[degC\],
/// relative humidity \[1\], pressure \[Pa\] and CO2 mole fraction \[1\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Of the air: speed of sound \[m/s\].
    SpeedOfSound,
    /// Of a distance \[m\] and the air: time of flight \[s\], out and back.
    TimeOfFlight,
    /// Of a time of flight \[s\] and the air: distance \[m\], the compensation.
    Distance,
}

/// The kernel of a law; with `at_frequency` the sound's frequency \[Hz\] is one more, last input.
#[must_use]
pub fn of_law(output: Output, law: &Law, at_frequency: bool) -> Box<dyn Kernel> {
    law.visit(Build {
        output,
        at_frequency,
    })
}

/// Error of indication \[m\] of a device that converts with the law `reading`, where `law` is the
/// air's: of a distance \[m\] and the air, with `at_frequency` also the sound's frequency \[Hz\].
#[must_use]
pub fn error(reading: &Law, law: &Law, at_frequency: bool) -> Box<dyn Kernel> {
    let (reading, law) = (*reading, *law);
    if at_frequency {
        kernel(DispersedError { reading, law })
    } else {
        kernel(Error { reading, law })
    }
}

/// Attenuation of a pure tone \[dB/m\]: of temperature, relative humidity, pressure, frequency.
#[must_use]
pub fn absorption() -> Box<dyn Kernel> {
    kernel(Absorption)
}

struct Build {
    output: Output,
    at_frequency: bool,
}

impl LawVisitor for Build {
    type Output = Box<dyn Kernel>;

    fn visit<L: SpeedLaw>(self, law: L) -> Box<dyn Kernel> {
        match (self.output, self.at_frequency) {
            (Output::SpeedOfSound, false) => kernel(Speed(law)),
            (Output::SpeedOfSound, true) => kernel(DispersedSpeed(law)),
            (Output::TimeOfFlight, false) => kernel(Time(law)),
            (Output::TimeOfFlight, true) => kernel(DispersedTime(law)),
            (Output::Distance, false) => kernel(Distance(law)),
            (Output::Distance, true) => kernel(DispersedDistance(law)),
        }
    }
}

#[inline(always)]
fn moist<S: Scalar>(
    [temperature, relative_humidity, pressure, co2_mole_fraction]: [S; 4],
) -> Air<S> {
    Air {
        temperature,
        relative_humidity,
        pressure,
        co2_mole_fraction,
    }
}

struct Speed<L>(L);

impl<L: SpeedLaw> Formula<4> for Speed<L> {
    #[inline(always)]
    fn evaluate<S: Scalar>(&self, air: [S; 4], _: &[S]) -> S {
        self.0.speed(&moist(air))
    }
}

struct DispersedSpeed<L>(L);

impl<L: SpeedLaw> Formula<5> for DispersedSpeed<L> {
    #[inline(always)]
    fn evaluate<S: Scalar>(&self, [t, h, p, c, frequency]: [S; 5], _: &[S]) -> S {
        let air = moist([t, h, p, c]);
        air::dispersed(self.0.speed(&air), &air, frequency)
    }
}

/// A function of one more quantity and the speed of sound.
macro_rules! of_speed {
    ($plain:ident, $dispersed:ident, $function:path) => {
        struct $plain<L>(L);

        impl<L: SpeedLaw> Formula<5> for $plain<L> {
            #[inline(always)]
            fn evaluate<S: Scalar>(&self, [x, t, h, p, c]: [S; 5], none: &[S]) -> S {
                $function(x, Speed(self.0).evaluate([t, h, p, c], none))
            }
        }

        struct $dispersed<L>(L);

        impl<L: SpeedLaw> Formula<6> for $dispersed<L> {
            #[inline(always)]
            fn evaluate<S: Scalar>(&self, [x, t, h, p, c, f]: [S; 6], none: &[S]) -> S {
                $function(x, DispersedSpeed(self.0).evaluate([t, h, p, c, f], none))
            }
        }
    };
}

of_speed!(Time, DispersedTime, echo::time_of_flight);
of_speed!(Distance, DispersedDistance, echo::distance);

/// Two laws at once; which ones is asked per vector, not compiled for every pair.
struct Error {
    reading: Law,
    law: Law,
}

impl Formula<5> for Error {
    #[inline(always)]
    fn evaluate<S: Scalar>(&self, [distance, t, h, p, c]: [S; 5], _: &[S]) -> S {
        let air = moist([t, h, p, c]);
        let time = echo::time_of_flight(distance, self.law.speed(&air));
        echo::distance(time, self.reading.speed(&air)) - distance
    }
}

struct DispersedError {
    reading: Law,
    law: Law,
}

impl Formula<6> for DispersedError {
    #[inline(always)]
    fn evaluate<S: Scalar>(&self, [distance, t, h, p, c, frequency]: [S; 6], _: &[S]) -> S {
        let air = moist([t, h, p, c]);
        let speed = self.law.speed_at_frequency(&air, frequency);
        let time = echo::time_of_flight(distance, speed);
        echo::distance(time, self.reading.speed(&air)) - distance
    }
}

struct Absorption;

impl Formula<4> for Absorption {
    #[inline(always)]
    fn evaluate<S: Scalar>(&self, [t, h, p, frequency]: [S; 4], _: &[S]) -> S {
        air::absorption(&moist([t, h, p, S::constant(0.0)]), frequency)
    }
}
