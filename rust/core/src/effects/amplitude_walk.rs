//! A threshold that a fainter echo crosses later.

use super::{Effect, Facts, ParameterFacts, Role, Tried};
use crate::air::absorption;
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::{Rows, Scalar, polynomial};

/// Carrier of most rangers \[Hz\].
const FREQUENCY: f64 = 40e3;
/// Distance that the delay is stated for \[m\].
const REFERENCE: f64 = 4.0;
/// Threshold over amplitude beyond which an echo is lost in noise.
const LOST: f64 = 0.95;
/// What the air absorbs out to there and back at 20 degC, 50 % and 101.325 kPa \[Np\]: ISO 9613-1, 1.318 dB/m.
const ABSORBED: f64 = 1.214;
/// Least value under the root of two resonances: its slope stays finite.
const FAINTEST: f64 = 1e-24;
/// Decibels in a neper.
const DECIBEL_PER_NEPER: f64 = 8.685_889_638_065_035;

/// See [`AmplitudeWalk::FACTS`].
///
/// The comparator waits for a fixed voltage, which is the part `p` of the echo's amplitude `A`; `p` is
/// `threshold` at 4 m, 20 degC and 50 %. The envelope of one resonance that is driven at its own frequency
/// rises as `A (1 - exp(-s))`, where `s` is the time in units of `2 Q / w` (order 1). A transmitter and a
/// receiver of the same `Q` are two equal poles in cascade: the envelope rises as `A (1 - (1 + s) exp(-s))`
/// (order 2). Its slope is zero at first. Oppenheim and Willsky 1997, Signals and Systems, 2nd ed., 6.5, have
/// both step responses. `alpha` is the absorption of air at 40 kHz.
pub struct AmplitudeWalk;

impl Effect for AmplitudeWalk {
    const FACTS: Facts = Facts {
        id: "amplitude_walk",
        stage: Stage::Transducer,
        sentence: "A fainter echo rises more slowly and crosses the comparator's threshold later.",
        formula: "t' = t + delay s(p) / s(threshold), p = threshold (d / 4 m) exp(2 alpha d - 1.214), \
                  alpha: absorption; 1 - p = exp(-s) at order 1, (1 + s) exp(-s) at order 2, s linear between",
        source: "errors of mm to cm: Parrilla et al. 1991, IEEE Trans. Instrum. Meas. 40, 759; two poles: \
                 Oppenheim and Willsky 1997, Signals and Systems, 6.5; ISO 9613-1:1993",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
        ],
        requires: &[Quantity::Temperature],
        parameters: &[
            ParameterFacts {
                name: "delay",
                unit: "s",
                bounds: (0.0, 2e-3),
                prior_scale: 40e-6,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "threshold",
                role: Role::Shape,
                neutral: 0.3,
                bounds: (0.01, 0.9),
                prior_scale: 0.2,
                // at both orders: below 0.1 the form hardly changes
                tried: Tried::Values(&[0.1, 0.3, 0.6, 0.8, 0.88]),
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "order",
                role: Role::Shape,
                neutral: 1.0,
                bounds: (1.0, 2.0),
                prior_scale: 0.5,
                tried: Tried::Values(&[1.0, 2.0]),
                ..ParameterFacts::USUAL
            },
        ],
        bends: true,
        edges: true,
        domain: "one target; 0.1 to 6 m; without recorded humidity alpha is that of the model's assumed air",
        check: "record the echo's amplitude, or change the target's reflectivity at one distance",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        let fainter = Self::prepare(chain);
        Self::apply_prepared(chain, parameters, fainter);
    }

    const PREPARES: bool = true;

    /// How many times smaller the amplitude is than at the reference.
    #[inline(always)]
    fn prepare<S: Scalar>(chain: &Chain<S>) -> S {
        let neper =
            absorption(&chain.air, S::constant(FREQUENCY)) * S::constant(1.0 / DECIBEL_PER_NEPER);
        let absorbed = (S::constant(2.0) * neper).mul_add(chain.path, S::constant(-ABSORBED));
        chain.path * S::constant(1.0 / REFERENCE) * absorbed.exp()
    }

    #[inline(always)]
    fn apply_prepared<S: Scalar>(chain: &mut Chain<S>, parameters: &[S], fainter: S) {
        let part = (parameters[1] * fainter).min(S::constant(LOST));
        let [at, stated] = [part, parameters[1]].map(|p| crossing(p, parameters[2]));
        chain.time = (parameters[0] / stated).mul_add(at, chain.time);
    }
}

/// The time at which an envelope of an order from 1 to 2 crosses a part of its amplitude \[2 Q / w\].
#[inline(always)]
fn crossing<S: Scalar>(part: S, order: S) -> S {
    let one = one_resonance(part);
    (order - S::constant(1.0)).mul_add(two_resonances(one) - one, one)
}

/// `-ln(1 - p)`, by the Padé approximant of orders 3 and 3: within 1 % up to 0.85, 8 % at 0.95.
#[inline(always)]
fn one_resonance<S: Scalar>(part: S) -> S {
    let above = polynomial(part, [60.0, -60.0, 11.0]) * part;
    above / polynomial(part, [60.0, -90.0, 36.0, -3.0])
}

/// `s` of `p = 1 - (1 + s) exp(-s)`, from `l = -ln(1 - p)`: it solves `s - ln(1 + s) = l`.
///
/// `s = -1 - W(-exp(-1 - l))`, where `W` is the lower branch of Lambert's function (Corless et al. 1996, Adv.
/// Comput. Math. 5, 329). Three terms of its series about the branch point, in `x = sqrt(2 l)`: within 1 % up
/// to 0.9, 4 % at 0.95.
#[inline(always)]
fn two_resonances<S: Scalar>(logarithm: S) -> S {
    let x = (S::constant(2.0) * logarithm.max(S::constant(FAINTEST))).sqrt();
    polynomial(x, [1.0, 1.0 / 3.0, 1.0 / 36.0]) * x
}

#[cfg(test)]
mod tests {
    use super::{REFERENCE, crossing, one_resonance, two_resonances};
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(distance: f64, temperature: f64, humidity: f64) -> f64 {
        let at = Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity);
        1e3 * error(
            "linear",
            "amplitude_walk",
            &[("delay", 40e-6)],
            distance,
            &at,
        )
    }

    #[test]
    fn forty_microseconds_at_4_meters_are_7_millimeters() {
        // 1 us is 0.1717 mm at 20 degC
        assert!((millimeters(REFERENCE, 20.0, 0.5) - 40.0 * 0.1717).abs() < 1e-2);
    }

    #[test]
    fn later_in_air_that_absorbs_more() {
        // ISO 9613-1 at 40 kHz: 0.45 dB/m at 0 degC and 50 %, 1.32 dB/m at 20 degC and 50 %
        let part = 0.3 * 10_f64.powf(2.0 * 4.0 * (0.45 - 1.318) / 20.0);
        let expected = 40.0 * 0.1657 * (1.0 - part).ln() / 0.7_f64.ln();
        assert!((millimeters(REFERENCE, 0.0, 0.5) / expected - 1.0).abs() < 0.01);
    }

    #[test]
    fn grows_with_distance_and_where_air_absorbs_more() {
        let steps = [0.1, 0.5, 1.0, 2.0, 4.0, 8.0].map(|distance| millimeters(distance, 20.0, 0.5));
        assert!(steps.is_sorted() && steps[0] < 0.2);
        // half way, p is a half less what the further half absorbs: 1.32 dB/m at 20 degC and 50 %
        let half = 0.3 * 0.5 * 10_f64.powf(-1.32 * 2.0 * 2.0 / 20.0);
        let expected = 40.0 * 0.1717 * (1.0 - half).ln() / 0.7_f64.ln();
        assert!(
            (steps[3] / expected - 1.0).abs() < 0.01,
            "{} {expected}",
            steps[3]
        );
    }

    #[test]
    fn the_approximation_is_the_logarithm() {
        for (part, apart) in [
            (1e-6_f64, 1e-9),
            (0.1, 1e-6),
            (0.5, 1e-3),
            (0.85, 0.01),
            (0.95, 0.08),
        ] {
            let exact = -(-part).ln_1p();
            let found = one_resonance(part);
            assert!(
                (found / exact - 1.0).abs() < apart,
                "{part}: {found} {exact}"
            );
        }
    }

    #[test]
    fn two_resonances_reach_the_part_at_this_time() {
        for (time, apart) in [(1e-3_f64, 1e-6), (0.5, 5e-4), (1.7, 5e-3), (3.8, 0.01)] {
            let part = 1.0 - (1.0 + time) * (-time).exp();
            let found = two_resonances(one_resonance(part));
            assert!((found / time - 1.0).abs() < apart, "{part}: {found} {time}");
        }
    }

    #[test]
    fn of_two_resonances_a_part_of_a_quarter_takes_half_the_time() {
        let of_order = |order: f64| crossing(0.002, order) / crossing(0.0005, order);
        assert!((of_order(1.0) - 4.0).abs() < 0.01); // p = s to first order
        assert!((of_order(2.0) - 2.0).abs() < 0.03); // p = s^2 / 2
        assert!(of_order(1.5) > of_order(2.0) && of_order(1.5) < of_order(1.0));
    }

    #[test]
    fn no_distance_has_a_derivative() {
        use crate::dual::Dual;
        let walk: Dual<1> = crossing(Dual::variable(0.0, 0), Dual::fixed(2.0));
        assert!(walk.value.abs() < 1e-11 && walk.derivatives[0].is_finite());
    }
}
