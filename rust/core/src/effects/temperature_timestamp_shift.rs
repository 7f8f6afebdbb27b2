//! Temperatures that were stamped too late.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// Temperatures of the next rows, in their order.
const LATER: [Quantity; 5] = [
    Quantity::TemperatureLater1,
    Quantity::TemperatureLater2,
    Quantity::TemperatureLater3,
    Quantity::TemperatureLater4,
    Quantity::TemperatureLater5,
];

/// See [`TemperatureTimestampShift::FACTS`].
pub struct TemperatureTimestampShift;

impl Effect for TemperatureTimestampShift {
    const FACTS: Facts = Facts {
        id: "temperature_timestamp_shift",
        stage: Stage::Air,
        sentence: "Each row holds the temperature of some rows earlier: the right one stands further down the table.",
        formula: "T' = T + weight (T(rows later) - T), between whole rows on a straight line; weight 1 is the shift",
        source: "a DS18B20 read before its new conversion is one row late; running means are several",
        reads: &[
            Quantity::Temperature,
            Quantity::TemperatureLater1,
            Quantity::TemperatureLater2,
            Quantity::TemperatureLater3,
            Quantity::TemperatureLater4,
            Quantity::TemperatureLater5,
        ],
        requires: &[
            Quantity::Temperature,
            Quantity::TemperatureLater1,
            Quantity::TemperatureLater2,
            Quantity::TemperatureLater3,
            Quantity::TemperatureLater4,
            Quantity::TemperatureLater5,
        ],
        parameters: &[
            ParameterFacts {
                name: "weight",
                bounds: (-1.0, 2.0), // room on both sides of 0 and 1 for a free fit
                known: &[1.0],
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "rows",
                role: Role::Shape,
                neutral: 1.0,
                bounds: (0.0, 5.0),
                prior_scale: 2.0,
                known: &[1.0, 2.0, 3.0, 4.0, 5.0],
                ..ParameterFacts::USUAL
            },
        ],
        edges: true,
        domain: "tables in the order of time, up to 5 rows late",
        check: "a fast step of temperature; read the logger's code",
        firmware: Firmware::Refused(
            "it asks for temperatures that are not there yet: read the thermometer first",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let (weight, rows) = (parameters[0], parameters[1]);
        let mut earlier = chain.recorded.get(Quantity::Temperature);
        let mut shift = S::constant(0.0);
        for (whole, quantity) in LATER.into_iter().enumerate() {
            let later = chain.recorded.get(quantity);
            let part = (rows - S::constant(whole as f64))
                .max(S::constant(0.0))
                .min(S::constant(1.0));
            shift = part.mul_add(later - earlier, shift);
            earlier = later;
        }
        chain.air.temperature = weight.mul_add(shift, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use super::LATER;
    use crate::effects::testing::model;
    use crate::{Conditions, Quantity};

    /// Recorded temperatures 20, 21, 23, 26, 30, 35 degC from this row on.
    fn ladder() -> Conditions<f64> {
        let pairs = LATER.into_iter().zip([21.0, 23.0, 26.0, 30.0, 35.0]);
        pairs.fold(Conditions::at(20.0), |at, (quantity, value)| {
            at.with(quantity, value)
        })
    }

    fn temperature(rows: f64) -> f64 {
        let shift = &[("weight", 1.0), ("rows", rows)];
        let speed =
            model("linear", "temperature_timestamp_shift", shift).speed_of_sound(2.0, &ladder());
        (speed - 331.4) / 0.6
    }

    #[test]
    fn takes_the_temperature_of_as_many_rows_later() {
        let found = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(temperature);
        for (found, expected) in found.into_iter().zip([20.0, 21.0, 23.0, 26.0, 30.0, 35.0]) {
            assert!((found - expected).abs() < 1e-11);
        }
        assert!((temperature(3.5) - 28.0).abs() < 1e-11);
    }

    #[test]
    fn is_nothing_where_the_temperature_stands_still() {
        let still = LATER
            .into_iter()
            .fold(Conditions::at(20.0), |at, q| at.with(q, 20.0));
        assert_eq!(still.get(Quantity::Temperature), 20.0);
        let shift = &[("weight", 1.0), ("rows", 4.0)];
        let model = model("cramer", "temperature_timestamp_shift", shift);
        assert!((model.indicate(2.0, &still) - 2.0).abs() < 1e-15);
    }
}
