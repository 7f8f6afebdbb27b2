//! The laws against two independent formulations of moist air, from a stored table.

use crate::table::{air, number, published};
use echocal_core::Law;
use echocal_core::air::Departure;
use echocal_core::air::composition::water_vapor_mole_fraction;

const REFERENCES: [&str; 2] = ["speed_hapropssi_m_per_s", "speed_iapws_m_per_s"];

/// Largest deviation from a reference in ppm: up to 6 % of water, and above.
fn largest(law: &str, reference: &str) -> (f64, f64) {
    let law = Law::parse(law).unwrap();
    let mut largest = (0.0_f64, 0.0_f64);
    for row in published("moist_air_reference") {
        let speed = law.speed(&air(&row));
        let ppm = 1e6 * (speed / number(&row, reference) - 1.0).abs();
        if number(&row, "water_vapor_mole_fraction") <= 0.06 {
            largest.0 = largest.0.max(ppm);
        } else {
            largest.1 = largest.1.max(ppm);
        }
    }
    largest
}

#[test]
fn virial_is_within_100_ppm_and_350_ppm_where_it_is_wet() {
    for reference in REFERENCES {
        let (moist, wet) = largest("virial", reference);
        assert!(moist <= 100.0 && wet <= 350.0, "{reference}: {moist} {wet}");
    }
}

#[test]
fn cramer_keeps_its_300_ppm_up_to_six_percent_of_water_and_not_beyond() {
    for reference in REFERENCES {
        let (moist, wet) = largest("cramer", reference);
        assert!(moist <= 300.0, "{reference}: {moist}");
        assert!(
            wet > 1000.0,
            "{reference}: the guard on water would be idle: {wet}"
        );
    }
}

#[test]
fn the_domain_of_cramer_ends_where_the_table_says() {
    let cramer = Law::parse("cramer").unwrap();
    for row in published("moist_air_reference") {
        let air = air(&row);
        let water = number(&row, "water_vapor_mole_fraction");
        assert!((water_vapor_mole_fraction(&air) - water).abs() < 1e-12);
        let found = cramer.examine(&air, 0.0).map(|finding| finding.departure);
        let expected = (water > 0.06).then_some(Departure::WaterVaporMoleFraction);
        assert_eq!(found, expected, "{row:?}");
    }
}
