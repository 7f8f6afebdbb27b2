//! The batch kernels that need no model: laws, absorption, the echo.
//!
//! Which law and which output is asked once per vector of rows, where it costs nothing that can be
//! measured, instead of compiling every combination.

use super::{Formula, Kernel, kernel};
use crate::air::{self, Air, Law};
use crate::echo;
use crate::scalar::{Rows, Scalar};

/// What a kernel computes. The air comes last in its inputs, as temperature \[degC\], relative
/// humidity \[1\], pressure \[Pa\] and CO2 mole fraction \[1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Of a distance \[m\] and the air: time of flight \[s\], out and back.
    TimeOfFlight,
    /// Of a time of flight \[s\] and the air: distance \[m\], the compensation.
    Distance,
    /// Of a distance \[m\] and the air: error of indication \[m\] of a device that converts with
    /// this law.
    Error(Law),
}

/// Speed of sound \[m/s\] of the air; with `at_frequency` the frequency \[Hz\] is one more input.
#[must_use]
pub fn speed_of_sound(law: Law, at_frequency: bool) -> Box<dyn Kernel> {
    if at_frequency {
        kernel(DispersedSpeed(law))
    } else {
        kernel(Speed(law))
    }
}

/// An output of the echo; with `at_frequency` the frequency \[Hz\] is one more, last input.
#[must_use]
pub fn echo(output: Output, law: Law, at_frequency: bool) -> Box<dyn Kernel> {
    if at_frequency {
        kernel(DispersedEcho { output, law })
    } else {
        kernel(Echo { output, law })
    }
}

/// Attenuation of a pure tone \[dB/m\]: of temperature, relative humidity, pressure, frequency.
#[must_use]
pub fn absorption() -> Box<dyn Kernel> {
    kernel(Absorption)
}

#[inline(always)]
fn moist<S: Scalar>(air: [S; 4]) -> Air<S> {
    let [temperature, relative_humidity, pressure, co2_mole_fraction] = air;
    Air {
        temperature,
        relative_humidity,
        pressure,
        co2_mole_fraction,
    }
}

#[inline(always)]
fn at_frequency<S: Rows>(law: Law, air: &Air<S>, frequency: S) -> S {
    air::dispersed(law.speed_of_rows(air), air, frequency)
}

impl Output {
    /// Of a distance or time, the air, and its speed of sound.
    #[inline(always)]
    fn evaluate<S: Rows>(self, x: S, air: &Air<S>, speed: S) -> S {
        match self {
            Self::TimeOfFlight => echo::time_of_flight(x, speed),
            Self::Distance => echo::distance(x, speed),
            Self::Error(reading) => {
                let time = echo::time_of_flight(x, speed);
                echo::distance(time, reading.speed_of_rows(air)) - x
            }
        }
    }
}

struct Speed(Law);

impl Formula<4> for Speed {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, air: [S; 4], _: &[S]) -> S {
        self.0.speed_of_rows(&moist(air))
    }
}

struct DispersedSpeed(Law);

impl Formula<5> for DispersedSpeed {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [t, h, p, c, frequency]: [S; 5], _: &[S]) -> S {
        at_frequency(self.0, &moist([t, h, p, c]), frequency)
    }
}

struct Echo {
    output: Output,
    law: Law,
}

impl Formula<5> for Echo {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [x, t, h, p, c]: [S; 5], _: &[S]) -> S {
        let air = moist([t, h, p, c]);
        self.output.evaluate(x, &air, self.law.speed_of_rows(&air))
    }
}

struct DispersedEcho {
    output: Output,
    law: Law,
}

impl Formula<6> for DispersedEcho {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [x, t, h, p, c, frequency]: [S; 6], _: &[S]) -> S {
        let air = moist([t, h, p, c]);
        let speed = at_frequency(self.law, &air, frequency);
        self.output.evaluate(x, &air, speed)
    }
}

struct Absorption;

impl Formula<4> for Absorption {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [t, h, p, frequency]: [S; 4], _: &[S]) -> S {
        air::absorption(&moist([t, h, p, S::constant(0.0)]), frequency)
    }
}
