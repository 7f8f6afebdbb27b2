//! The facts are complete, named alike and consistent.

use echocal_core::Law;
use echocal_core::effects::{ALL, Facts, Firmware, Role};
use std::collections::HashSet;

/// Symbols that units are made of, as in `K m^2/W`.
const SYMBOLS: &[&str] = &[
    "1", "A", "Hz", "J", "K", "N", "Pa", "V", "W", "kg", "m", "mol", "rad", "s",
];

/// Whether a unit is a product of powers of symbols, with one quotient at most.
fn is_unit(unit: &str) -> bool {
    let symbol = |factor: &str| {
        let (symbol, power) = factor.split_once('^').unwrap_or((factor, "1"));
        SYMBOLS.contains(&symbol) && power.parse::<u8>().is_ok()
    };
    let (over, under) = unit.split_once('/').unwrap_or((unit, "1"));
    let inner = under
        .strip_prefix('(')
        .and_then(|rest| rest.strip_suffix(')'));
    over.split(' ').all(symbol) && inner.unwrap_or(under).split(' ').all(symbol)
}

fn snake_case(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(plain)
}

#[test]
fn names_are_snake_case_and_unique() {
    let mut ids = HashSet::new();
    for facts in ALL {
        assert!(snake_case(facts.id) && ids.insert(facts.id), "{}", facts.id);
        let mut names = HashSet::new();
        for parameter in facts.parameters {
            let name = parameter.name;
            assert!(
                snake_case(name) && names.insert(name),
                "{}.{name}",
                facts.id
            );
        }
    }
}

#[test]
fn texts_are_there_and_the_formula_names_every_parameter() {
    for facts in ALL {
        let id = facts.id;
        let texts = [facts.formula, facts.source, facts.domain, facts.check];
        assert!(texts.iter().all(|text| !text.trim().is_empty()), "{id}");
        assert!(
            facts.sentence.len() > 20 && facts.sentence.ends_with('.'),
            "{id}"
        );
        for parameter in facts.parameters {
            let name = parameter.name;
            assert!(
                facts.formula.contains(name),
                "{id}: no '{name}' in the formula"
            );
        }
        if let Firmware::Refused(reason) = facts.firmware {
            assert!(!reason.is_empty(), "{id}");
        }
    }
}

#[test]
fn parameters_have_known_units_and_values_within_bounds() {
    for (facts, parameter) in ALL
        .iter()
        .flat_map(|f| f.parameters.iter().map(move |p| (f, p)))
    {
        let name = format!("{}.{}", facts.id, parameter.name);
        assert!(is_unit(parameter.unit), "{name} in '{}'", parameter.unit);
        let (low, high) = parameter.bounds;
        assert!(low.is_finite() && high.is_finite() && low < high, "{name}");
        assert!((low..=high).contains(&parameter.neutral), "{name}");
        assert!(
            parameter.known.iter().all(|v| (low..=high).contains(v)),
            "{name}"
        );
        assert!(
            parameter.prior_scale > 0.0 && parameter.prior_scale <= high - low,
            "{name}"
        );
    }
}

#[test]
fn every_effect_has_a_size_and_no_contradiction_in_itself() {
    for facts in ALL {
        assert!(
            facts.parameters.iter().any(|p| p.role == Role::Size),
            "{}",
            facts.id
        );
        assert_eq!(facts.contradiction(facts), None, "{}", facts.id);
    }
}

#[test]
fn laws_that_effects_use_exist() {
    let laws = Law::names();
    for facts in ALL {
        assert!(
            facts
                .calls
                .iter()
                .chain(facts.extends)
                .all(|law| laws.contains(law)),
            "{}",
            facts.id
        );
    }
}

#[test]
fn what_the_device_needs_was_recorded() {
    let needs = |facts: &Facts| match facts.firmware {
        Firmware::Needs(quantity) => Some(quantity),
        _ => None,
    };
    for facts in ALL {
        if let Some(quantity) = needs(facts) {
            assert!(facts.requires.contains(&quantity), "{}", facts.id);
        }
    }
}
