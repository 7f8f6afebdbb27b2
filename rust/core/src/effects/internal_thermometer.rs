//! A ranger that compensates its reading by a thermometer of its own.
//!
//! Only what no other effect says is here: the ranger's thermometer follows a thermometer of the table, such as
//! that of the box. Other errors of such a ranger have, to first order, the column of an effect that exists, so
//! that a second id would share its probability: warmed by a recorded sun, `temperature_radiation`; by an
//! unrecorded one, `temperature_daylight`; after power-on, `temperature_self_heating`; too late,
//! `temperature_lag`; a part of the compensation only, `temperature_gain`, or `fixed_speed` where all of it is
//! lacking; too much of it, `double_correction`.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// 0 degC \[K\].
const ZERO: f64 = 273.15;

/// See [`InternalThermometer::FACTS`].
pub struct InternalThermometer;

impl Effect for InternalThermometer {
    const FACTS: Facts = Facts {
        id: "internal_thermometer",
        stage: Stage::Firmware,
        sentence: "The ranger compensates its reading by a thermometer of its own, which is partly as warm as its box.",
        formula: "c_device' = c_device sqrt(T_i / T) in K, T_i = T + share (T_2 - T), with T_2 the thermometer of \
                  the box",
        source: "c is proportional to the root of T in an ideal gas; MaxBotix rangers compensate by a thermometer \
                 inside, and advise an external one where housing or supply warm it (general knowledge)",
        reads: &[Quantity::Temperature, Quantity::DeviceTemperature],
        requires: &[Quantity::Temperature, Quantity::DeviceTemperature],
        parameters: &[ParameterFacts {
            name: "share",
            // 0 is the air, 1 is the box; a ranger that the sun warms more than the box has more than 1
            bounds: (-0.2, 1.5),
            // nothing is known of where between them the ranger is: the rms of an even spread is 0.58
            prior_scale: 0.5,
            ..ParameterFacts::USUAL
        }],
        domain: "readings that the device compensates itself; recorded echo times do not know it",
        // a firmware that reads the echo time itself never meets it
        check: "log the ranger's own temperature, or shade it for an hour",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let recorded = chain.recorded.get(Quantity::Temperature);
        let apart = chain.recorded.get(Quantity::DeviceTemperature) - recorded;
        let warmer = parameters[0] * apart / (recorded + S::constant(ZERO));
        chain.firmware_speed = chain.firmware_speed * (warmer + S::constant(1.0)).sqrt();
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn error_of(id: &str, parameter: &str, share: f64, quantity: Quantity, box_is: f64) -> f64 {
        let at = Conditions::at(20.0).with(quantity, box_is);
        error("ideal_gas", id, &[(parameter, share)], 2.0, &at)
    }

    fn internal(share: f64, box_is: f64) -> f64 {
        let of = Quantity::DeviceTemperature;
        error_of("internal_thermometer", "share", share, of, box_is)
    }

    #[test]
    fn a_kelvin_is_0_17_percent() {
        assert!((internal(0.2, 25.0) - 2.0 * ((294.15_f64 / 293.15).sqrt() - 1.0)).abs() < 1e-12);
        assert!((internal(0.2, 25.0) / 2.0 - 0.0017).abs() < 1e-5);
    }

    #[test]
    fn a_ranger_as_warm_as_its_box_reads_too_far_by_day_and_too_near_by_night() {
        assert!(internal(1.0, 30.0) > 0.0 && internal(1.0, 10.0) < 0.0);
        assert_eq!(internal(1.0, 20.0), 0.0);
    }

    #[test]
    fn the_opposite_of_a_path_as_warm_as_the_box() {
        let of = Quantity::SecondTemperature;
        let path = error_of("thermometer_mix", "weight", 0.2, of, 25.0);
        assert!((internal(0.2, 25.0) + path).abs() < 2e-3 * path.abs());
    }
}
