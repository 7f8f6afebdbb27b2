//! Something nearer at the edge of the beam.

use super::facts::EVENLY;
use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`BeamEdge::FACTS`].
pub struct BeamEdge;

impl Effect for BeamEdge {
    const FACTS: Facts = Facts {
        id: "beam_edge",
        stage: Stage::Path,
        sentence: "Beyond a distance the first echo comes from something nearer at the beam's edge.",
        formula: "d' = d - max(0, min((d - edge) / 2, lead + growth (d - edge)))",
        source: "geometry of a cone with a side wall, a table top or the target's own frame in it",
        parameters: &[
            ParameterFacts {
                name: "lead",
                unit: "m",
                bounds: (0.0, 1.0),
                prior_scale: 0.02,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "growth",
                bounds: (0.0, 0.4),
                prior_scale: 0.02,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "edge",
                unit: "m",
                role: Role::Shape,
                neutral: 1.0,
                // a cone of 15 degrees to each side is wider than a module of 45 mm from 84 mm on
                bounds: (0.084, 100.0),
                prior_scale: 1.0,
                tried: Tried::DistanceQuantiles(EVENLY),
                ..ParameterFacts::USUAL
            },
        ],
        bends: true,
        edges: true,
        domain: "one thing at the edge, that always answers; where it answers now and then, rows scatter in two heaps",
        check: "cover the edge with an absorber, take a wider target, or move sideways",
        firmware: Firmware::Refused(
            "clear the beam: what stands at its edge differs from place to place",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let beyond = chain.path - parameters[2];
        let nearer = parameters[1].mul_add(beyond, parameters[0]);
        // the lead builds up over twice its length, so that no two distances share an echo
        let nearer = nearer.min(S::constant(0.5) * beyond).max(S::constant(0.0));
        chain.path = chain.path - nearer;
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    const EDGE: &[(&str, f64)] = &[("lead", 8e-3), ("growth", 8e-3), ("edge", 1.0)];

    #[test]
    fn eight_millimeters_beyond_the_edge_and_eight_more_a_meter_on() {
        let at = |distance| error("linear", "beam_edge", EDGE, distance, &Conditions::at(20.0));
        assert!(at(0.9).abs() < 1e-15);
        assert!((at(1.02) - -8.16e-3).abs() < 1e-12);
        assert!((at(2.0) - -16e-3).abs() < 1e-12);
    }

    #[test]
    fn every_echo_has_one_distance() {
        let (model, at) = (model("cramer", "beam_edge", EDGE), Conditions::at(10.0));
        let near = (0..400).map(|step| 0.98 + 1e-4 * f64::from(step));
        let indications: Vec<f64> = near.map(|distance| model.indicate(distance, &at)).collect();
        assert!(indications.is_sorted());
    }
}
