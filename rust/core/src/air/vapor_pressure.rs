//! Saturation pressure of water vapor.

use crate::scalar::{Scalar, polynomial};

/// 0 degC \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;

/// Temperature below which the pressure is 0 in any number \[K\].
const LEAST_KELVIN: f64 = 1e-3;

/// CIPM vapor pressure, `exp(A T^2 + B T + C + D/T)` with T in K; `tail` is `[C, B, A]`.
#[inline(always)]
fn vapor_pressure<S: Scalar>(temperature: S, tail: [f64; 3], over_kelvin: f64) -> S {
    let kelvin = temperature + S::constant(ZERO_CELSIUS);
    // at absolute zero, where the pressure is 0, the slope of 1/T has no end, and no product with 0
    let least = S::constant(LEAST_KELVIN);
    let divisor = S::select(kelvin.abs() - least, kelvin, least);
    (S::constant(over_kelvin) / divisor + polynomial(kelvin, tail)).exp()
}

/// Saturation pressure of water vapor over liquid water, also supercooled \[Pa\]; t in degC.
///
/// Davis 1992 (CIPM-81/91), Metrologia 29, 67, eq. (A1.1), doi:10.1088/0026-1394/29/1/008.
#[inline(always)]
pub fn saturation_pressure<S: Scalar>(temperature: S) -> S {
    const TAIL: [f64; 3] = [33.937_110_47, -1.912_131_6e-2, 1.237_884_7e-5];
    vapor_pressure(temperature, TAIL, -6_343.164_5)
}

/// Saturation pressure \[Pa\] of the older CIPM-81, which Cramer's appendix (eq. A3) prints.
///
/// Giacomo 1982, Metrologia 18, 33, doi:10.1088/0026-1394/18/1/006. Not used by any law here:
/// tables older than 1992 were computed with it.
#[inline(always)]
pub fn saturation_pressure_giacomo<S: Scalar>(temperature: S) -> S {
    const TAIL: [f64; 3] = [34.049_260_34, -1.950_987_4e-2, 1.281_180_5e-5];
    vapor_pressure(temperature, TAIL, -6_353.631_1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    /// The slope was not a number, and with it every derivative of a model.
    #[test]
    fn at_absolute_zero_there_is_no_vapor_and_the_slope_is_a_number() {
        let pressure = saturation_pressure(Dual::<1>::variable(-ZERO_CELSIUS, 0));
        assert_eq!((pressure.value, pressure.derivatives), (0.0, [0.0]));
        assert_eq!(saturation_pressure(-ZERO_CELSIUS), 0.0);
        let above = saturation_pressure(Dual::<1>::variable(2.0 - ZERO_CELSIUS, 0));
        assert_eq!(above.value, 0.0, "as without the bound");
    }

    /// Davis 1992 is a fit to the tables of vapor pressure: 2339 Pa at 20 degC and 611 Pa at 0 degC,
    /// which they print to a pascal; the older formula differs by less than a part in a thousand.
    #[test]
    fn pressures_as_tables_print_them() {
        for (temperature, printed) in [(0.0_f64, 611.0), (20.0, 2339.0)] {
            let pressure = saturation_pressure(temperature);
            assert!((pressure - printed).abs() < 1.0, "{pressure}");
            let older = saturation_pressure_giacomo(temperature);
            assert!((older / pressure - 1.0).abs() < 1e-3, "{older}");
        }
    }
}
