//! Effects: deviations of a real sensor from its simulation, one file each.
//!
//! An effect is exactly the identity at its neutral parameters. Everything else (simulator,
//! Jacobian, compensation, fitter, diagnosis, documentation, conformance tests) iterates this
//! registry; to add an effect, write its file and add one line to `registry!` below.

mod facts;
#[cfg(test)]
mod testing;

pub use facts::{Facts, Firmware, ParameterFacts, Role, Tried};

use crate::chain::Chain;
use crate::scalar::Rows;

/// A deviation that acts on the mean of the indication.
pub trait Effect {
    /// What is known about the effect.
    const FACTS: Facts;

    /// Changes the variable of the effect's stage.
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]);

    /// Whether [`Effect::prepare`] finds anything.
    const PREPARES: bool = false;

    /// What [`Effect::apply`] makes of the chain whatever its parameters are, where that takes long.
    #[inline(always)]
    fn prepare<S: Rows>(_chain: &Chain<S>) -> S {
        S::constant(0.0)
    }

    /// [`Effect::apply`] with what [`Effect::prepare`] found.
    #[inline(always)]
    fn apply_prepared<S: Rows>(chain: &mut Chain<S>, parameters: &[S], _prepared: S) {
        Self::apply(chain, parameters);
    }
}

/// What is to be done with an effect whose type is known when it is compiled.
pub(crate) trait Visitor {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<E: Effect>(self) -> Self::Output;
}

macro_rules! registry {
    ($($module:ident :: $effect:ident),+ $(,)?) => {
        $(mod $module;)+

        /// Every effect, in the order of the registry.
        pub static ALL: &[&Facts] = &[$(&$module::$effect::FACTS),+];

        #[cfg(test)]
        const MODULES: &[&str] = &[$(stringify!($module)),+];

        /// Applies the effect with this index in [`ALL`].
        pub fn apply<S: Rows>(index: usize, chain: &mut Chain<S>, parameters: &[S]) {
            let mut position = 0;
            $(
                if index == position {
                    return $module::$effect::apply(chain, parameters);
                }
                position += 1;
            )+
            debug_assert!(index < position, "no effect has index {index}");
        }

        /// Does something with the effect with this index in [`ALL`]: each in a function of its own.
        pub(crate) fn visit<V: Visitor>(index: usize, visitor: V) -> V::Output {
            let mut position = 0;
            $(
                if index == position {
                    return visitor.visit::<$module::$effect>();
                }
                position += 1;
            )+
            unreachable!("{index} of {position} effects")
        }
    };
}

registry!(
    // air
    temperature_offset::TemperatureOffset,
    temperature_gain::TemperatureGain,
    temperature_lag::TemperatureLag,
    temperature_timestamp_shift::TemperatureTimestampShift,
    temperature_self_heating::TemperatureSelfHeating,
    temperature_daylight::TemperatureDaylight,
    temperature_radiation::TemperatureRadiation,
    temperature_gradient::TemperatureGradient,
    thermometer_mix::ThermometerMix,
    // speed
    linear_speed_law::LinearSpeedLaw,
    speed_intercept::SpeedIntercept,
    speed_slope::SpeedSlope,
    humidity::Humidity,
    unrecorded_humidity::UnrecordedHumidity,
    carbon_dioxide::CarbonDioxide,
    gas_composition::GasComposition,
    pressure::Pressure,
    dispersion::Dispersion,
    // path
    reference_scale::ReferenceScale,
    oblique_target::ObliqueTarget,
    recorded_angle::RecordedAngle,
    slant_range::SlantRange,
    beam_edge::BeamEdge,
    zero_error::ZeroError,
    drift::Drift,
    step_change::StepChange,
    thermal_expansion::ThermalExpansion,
    transducer_spacing::TransducerSpacing,
    // flight
    wind_along::WindAlong,
    wind_across::WindAcross,
    // transducer
    fixed_delay::FixedDelay,
    amplitude_walk::AmplitudeWalk,
    receiver_recovery::ReceiverRecovery,
    recorded_amplitude::RecordedAmplitude,
    echo_quality::EchoQuality,
    resonance_drift::ResonanceDrift,
    supply_voltage::SupplyVoltage,
    first_ping::FirstPing,
    // timer
    clock_error::ClockError,
    clock_temperature_coefficient::ClockTemperatureCoefficient,
    interrupt_loss::InterruptLoss,
    // firmware
    fixed_speed::FixedSpeed,
    double_correction::DoubleCorrection,
    pressure_sqrt_law::PressureSqrtLaw,
    internal_thermometer::InternalThermometer,
);

/// The ids of all effects.
#[must_use]
pub fn ids() -> Vec<&'static str> {
    ALL.iter().map(|facts| facts.id).collect()
}

/// The position in [`ALL`] of the effect of this id.
#[must_use]
pub fn index_of(id: &str) -> Option<usize> {
    ALL.iter().position(|facts| facts.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Stage;
    use crate::{Conditions, Quantity};

    /// The air and the two speeds that an effect makes, at a distance.
    fn made(index: usize, distance: f64) -> [f64; 6] {
        let mut recorded = Conditions::new([0.4; Quantity::COUNT]);
        recorded = recorded.with(Quantity::Temperature, 25.0);
        let mut chain = Chain::start(distance, &recorded);
        (chain.speed, chain.firmware_speed) = (346.0, 343.0);
        (chain.path, chain.time) = (distance, distance / 173.0);
        let facts = ALL[index].parameters.iter();
        let parameters: Vec<f64> = facts.map(|p| p.neutral + p.prior_scale).collect();
        apply(index, &mut chain, &parameters);
        let air = chain.air;
        let quantities = [
            air.temperature,
            air.relative_humidity,
            air.pressure,
            air.co2_mole_fraction,
        ];
        let [t, h, p, c] = quantities;
        [t, h, p, c, chain.speed, chain.firmware_speed]
    }

    #[test]
    fn what_depends_on_the_distance_says_so() {
        for (index, facts) in ALL.iter().enumerate() {
            if matches!(facts.stage, Stage::Air | Stage::Speed | Stage::Firmware) {
                let bits = |distance| made(index, distance).map(f64::to_bits);
                assert_eq!(bits(0.5) != bits(3.0), facts.of_distance, "{}", facts.id);
            }
        }
    }

    /// What an effect of usual sizes indicates where a quantity is at a value and a parameter at
    /// another, in bits.
    fn indicated(
        index: usize,
        (quantity, at): (Quantity, f64),
        (parameter, place): (usize, f64),
    ) -> u64 {
        let mut recorded = Conditions::new([0.4; Quantity::COUNT]);
        recorded = recorded
            .with(Quantity::Temperature, 25.0)
            .with(quantity, at);
        let facts = ALL[index].parameters.iter();
        let mut values: Vec<_> = facts.map(|p| (p.name, p.neutral + p.prior_scale)).collect();
        values[parameter].1 = place;
        testing::error("linear", ALL[index].id, &values, 2.0, &recorded).to_bits()
    }

    #[test]
    fn what_divides_a_quantity_has_two_values() {
        for (index, facts) in ALL.iter().enumerate() {
            for (at, parameter) in facts.parameters.iter().enumerate() {
                let Some(quantity) = parameter.divides else {
                    continue;
                };
                let reached = |row: f64, place: f64| indicated(index, (quantity, row), (at, place));
                let (before, after) = (reached(100.0, 100.0), reached(100.0, 99.0));
                assert_ne!(before, after, "{}", facts.id);
                for place in [0.0, 3.0, 50.0, 99.9] {
                    assert_eq!(reached(100.0, place), after, "{}", facts.id);
                    assert_eq!(reached(place, 100.0), before, "{}", facts.id);
                }
            }
        }
    }

    #[test]
    fn the_file_is_named_as_the_effect() {
        assert_eq!(super::ids(), super::MODULES);
    }
}
