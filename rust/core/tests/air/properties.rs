//! What must hold for any air in the domain.

use echocal_core::Law;
use echocal_core::air::{Air, absorption, dispersed};
use proptest::prelude::*;

/// Any air that sensors meet; the water in it may leave Cramer's domain.
fn any_air() -> impl Strategy<Value = Air<f64>> {
    (-20.0..60.0, 0.0..1.0, 60e3..110e3, 0.0..0.01).prop_map(|(t, humidity, p, co2)| Air {
        temperature: t,
        relative_humidity: humidity,
        pressure: p,
        co2_mole_fraction: co2,
    })
}

fn any_law() -> impl Strategy<Value = Law> {
    let ids: Vec<_> = Law::ALL.iter().map(|facts| facts.id).collect();
    proptest::sample::select(ids).prop_map(|id| Law::parse(id).unwrap())
}

fn law(id: &str) -> Law {
    Law::parse(id).unwrap()
}

proptest! {
    #[test]
    fn warmer_air_is_faster(law in any_law(), air in any_air(), step in 0.01..5.0) {
        let warmer = Air { temperature: air.temperature + step, ..air };
        prop_assert!(law.speed(&warmer) > law.speed(&air));
    }

    #[test]
    fn moister_air_is_faster(air in any_air(), more in 0.01..0.5) {
        let moister = Air { relative_humidity: air.relative_humidity + more, ..air };
        for id in ["ideal_gas", "virial"] {
            prop_assert!(law(id).speed(&moister) > law(id).speed(&air), "{id}");
        }
    }

    #[test]
    fn carbon_dioxide_slows(air in any_air(), more in 1e-4..5e-3) {
        let exhaled = Air { co2_mole_fraction: air.co2_mole_fraction + more, ..air };
        for id in ["ideal_gas", "cramer", "virial"] {
            prop_assert!(law(id).speed(&exhaled) < law(id).speed(&air), "{id}");
        }
    }

    #[test]
    fn without_pressure_only_the_ideal_gas_is_left(temperature in -20.0..60.0, co2 in 0.0..0.01) {
        let air = |pressure| Air {
            temperature,
            relative_humidity: 0.0,
            pressure,
            co2_mole_fraction: co2,
        };
        let [thin, thinner, ambient]: [f64; 3] = [1.0, 1e-3, 101_325.0].map(|p| law("virial").speed(&air(p)));
        prop_assert!((thin / thinner - 1.0).abs() < 1e-8);
        // real molecules matter little, and vibration below 60 degC hardly
        prop_assert!((ambient / thin - 1.0).abs() < 5e-4);
        prop_assert!((thin / law("ideal_gas").speed(&air(1.0)) - 1.0).abs() < 1.5e-3);
    }

    #[test]
    fn cramer_and_virial_agree_where_both_hold(air in any_air()) {
        let cramer = law("cramer");
        prop_assume!(cramer.examine(&air, 0.0).is_none());
        let ratio = cramer.speed(&air) / law("virial").speed(&air);
        prop_assert!((ratio - 1.0).abs() < 400e-6, "{ratio}");
    }

    #[test]
    fn higher_tones_are_faster_and_fade_sooner(
        air in any_air(),
        frequency in 1e3..100e3,
        factor in 1.1..3.0,
    ) {
        let still = 340.0;
        let [low, high] = [frequency, factor * frequency].map(|f| dispersed(still, &air, f));
        prop_assert!(still < low && low < high && high < 1.002 * still, "{low} {high}");
        let [low, high] = [frequency, factor * frequency].map(|f| absorption(&air, f));
        prop_assert!(0.0 < low && low < high, "{low} {high}");
    }

    #[test]
    fn single_precision_is_good_to_a_millionth(law in any_law(), air in any_air()) {
        #[allow(clippy::cast_possible_truncation)] // the narrower width is the point
        let narrow = Air {
            temperature: air.temperature as f32,
            relative_humidity: air.relative_humidity as f32,
            pressure: air.pressure as f32,
            co2_mole_fraction: air.co2_mole_fraction as f32,
        };
        let ratio = f64::from(law.speed_at_frequency(&narrow, 40e3_f32))
            / law.speed_at_frequency(&air, 40e3);
        prop_assert!((ratio - 1.0).abs() < 2e-6, "{ratio}");
    }

    #[test]
    fn nan_in_is_nan_out(law in any_law(), air in any_air(), which in 0..4_usize) {
        let mut values = [air.temperature, air.relative_humidity, air.pressure, air.co2_mole_fraction];
        values[which] = f64::NAN;
        let [temperature, relative_humidity, pressure, co2_mole_fraction] = values;
        let spoiled = Air { temperature, relative_humidity, pressure, co2_mole_fraction };
        let names = ["temperature", "relative_humidity", "pressure", "co2_mole_fraction"];
        let reads = law.facts().reads.iter().any(|q| q.facts().name == names[which]);
        prop_assert_eq!(law.speed(&spoiled).is_nan(), reads);
    }
}
