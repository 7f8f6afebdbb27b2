//! The batch kernels that need no model: laws, absorption, the echo.
//!
//! Each law with each output is compiled apart, so that a kernel holds nothing that it does not
//! need: what all laws need at once does not fit the registers.

use super::{Formula, Kernel, kernel, threads};
use crate::air::{self, Air, Law, LawOfRows, LawVisitor, SpeedLaw};
use crate::conditions::Quantity;
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
        return kernel(DispersedSpeed(law));
    }
    law.visit(OfSpeed)
}

/// An output of the echo; with `at_frequency` the frequency \[Hz\] is one more, last input.
#[must_use]
pub fn echo(output: Output, law: Law, at_frequency: bool) -> Box<dyn Kernel> {
    if at_frequency {
        return kernel(DispersedEcho { output, law });
    }
    match output {
        Output::TimeOfFlight => law.visit(OfEcho(TimeOfFlight)),
        Output::Distance => law.visit(OfEcho(Distance)),
        Output::Error(Law::Linear(reading)) => law.visit(OfEcho(Error(reading))),
        Output::Error(reading) => kernel(Echo {
            output: Error(reading),
            law,
        }),
    }
}

/// Attenuation of a pure tone \[dB/m\]: of temperature, relative humidity, pressure, frequency.
#[must_use]
pub fn absorption() -> Box<dyn Kernel> {
    kernel(Absorption)
}

struct OfSpeed;

impl LawVisitor for OfSpeed {
    type Output = Box<dyn Kernel>;

    fn visit<L: SpeedLaw + 'static>(self, law: L) -> Self::Output {
        kernel(Speed(law))
    }
}

struct OfEcho<O>(O);

impl<O: OfSound> LawVisitor for OfEcho<O> {
    type Output = Box<dyn Kernel>;

    fn visit<L: SpeedLaw + 'static>(self, law: L) -> Self::Output {
        kernel(Echo {
            output: self.0,
            law,
        })
    }
}

/// An output of the echo, given a distance or time, the air, and its speed of sound.
trait OfSound: Send + Sync + 'static {
    fn of<S: Rows>(&self, x: S, air: &Air<S>, speed: S) -> S;

    /// The influence quantities that it reads beside those of the speed.
    const READS: &'static [Quantity] = &[];
}

struct TimeOfFlight;

impl OfSound for TimeOfFlight {
    #[inline(always)]
    fn of<S: Rows>(&self, distance: S, _: &Air<S>, speed: S) -> S {
        echo::time_of_flight(distance, speed)
    }
}

struct Distance;

impl OfSound for Distance {
    #[inline(always)]
    fn of<S: Rows>(&self, time: S, _: &Air<S>, speed: S) -> S {
        echo::distance(time, speed)
    }
}

/// The law that the device converts with.
struct Error<L>(L);

impl<L: LawOfRows> OfSound for Error<L> {
    const READS: &'static [Quantity] = L::READS;

    #[inline(always)]
    fn of<S: Rows>(&self, distance: S, air: &Air<S>, speed: S) -> S {
        let time = echo::time_of_flight(distance, speed);
        echo::distance(time, self.0.speed_of_rows(air)) - distance
    }
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

/// Rows below which one more thread does not pay, given which inputs of [`moist`] are read.
const fn rows_of_a_thread([_, humidity, pressure, _]: [bool; 4]) -> usize {
    if humidity || pressure {
        threads::OF_A_FORMULA
    } else {
        threads::OF_A_SHORT_FORMULA
    }
}

/// Which inputs of [`moist`] are among these.
const fn read_of(reads: &[Quantity]) -> [bool; 4] {
    let mut found = [false; 4];
    let mut index = 0;
    while index < reads.len() {
        match reads[index] {
            Quantity::Temperature => found[0] = true,
            Quantity::RelativeHumidity => found[1] = true,
            Quantity::Pressure => found[2] = true,
            Quantity::Co2MoleFraction => found[3] = true,
            _ => panic!("the air has no such quantity"),
        }
        index += 1;
    }
    found
}

#[inline(always)]
fn at_frequency<S: Rows>(law: Law, air: &Air<S>, frequency: S) -> S {
    air::dispersed(law.speed_of_rows(air), air, frequency)
}

struct Speed<L>(L);

impl<L: LawOfRows> Formula<4> for Speed<L> {
    const READS: [bool; 4] = read_of(L::READS);
    const ROWS_OF_A_THREAD: usize = rows_of_a_thread(Self::READS);

    #[inline(always)]
    fn evaluate<S: Rows>(&self, air: [S; 4]) -> S {
        self.0.speed_of_rows(&moist(air))
    }
}

struct DispersedSpeed(Law);

impl Formula<5> for DispersedSpeed {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [t, h, p, c, frequency]: [S; 5]) -> S {
        at_frequency(self.0, &moist([t, h, p, c]), frequency)
    }
}

struct Echo<O, L> {
    output: O,
    law: L,
}

impl<O: OfSound, L: LawOfRows> Formula<5> for Echo<O, L> {
    const READS: [bool; 5] = {
        let (law, output) = (read_of(L::READS), read_of(O::READS));
        let mut reads = [true; 5];
        let mut index = 0;
        while index < 4 {
            reads[1 + index] = law[index] || output[index];
            index += 1;
        }
        reads
    };
    const ROWS_OF_A_THREAD: usize = {
        let [_, t, h, p, c] = Self::READS;
        rows_of_a_thread([t, h, p, c])
    };

    #[inline(always)]
    fn evaluate<S: Rows>(&self, [x, t, h, p, c]: [S; 5]) -> S {
        let air = moist([t, h, p, c]);
        self.output.of(x, &air, self.law.speed_of_rows(&air))
    }
}

/// The relaxations take most of the time: which law and which output is found out for each vector.
struct DispersedEcho {
    output: Output,
    law: Law,
}

impl Formula<6> for DispersedEcho {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [x, t, h, p, c, frequency]: [S; 6]) -> S {
        let air = moist([t, h, p, c]);
        let speed = at_frequency(self.law, &air, frequency);
        match self.output {
            Output::TimeOfFlight => TimeOfFlight.of(x, &air, speed),
            Output::Distance => Distance.of(x, &air, speed),
            Output::Error(reading) => Error(reading).of(x, &air, speed),
        }
    }
}

struct Absorption;

impl Formula<4> for Absorption {
    #[inline(always)]
    fn evaluate<S: Rows>(&self, [t, h, p, frequency]: [S; 4]) -> S {
        air::absorption(&moist([t, h, p, S::constant(0.0)]), frequency)
    }
}
