//! Log evidence and posterior against plain computations, one number at a time.

#![allow(clippy::suboptimal_flops)] // expected values are stated plainly

use echocal_infer::search::{Prior, SearchOptions, posterior};
use echocal_infer::solve::{Variant, WIDTHS, WhitenedStack, log_evidence};

const DEGREES: f64 = 40.0;
const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn cause(cause: usize, column: usize) -> Variant {
    Variant {
        cause,
        is_unexplained: false,
        offsets: Vec::new(),
        free: vec![column],
        bounds: vec![NONE],
        weight: 1.0,
    }
}

/// Products of three columns and of what they explain, under two noises.
fn products() -> Vec<f64> {
    let one = [
        [30.0, 4.0, 3.0, 31.0],
        [4.0, 25.0, 1.0, 6.0],
        [3.0, 1.0, 20.0, 14.0],
        [31.0, 6.0, 14.0, 90.0],
    ];
    let other = one.map(|line| line.map(|value| 0.8 * value));
    [one.concat(), other.concat()].concat()
}

const LOG_WEIGHT: [f64; 2] = [-1.0, -5.0];

fn stack(products: &[f64]) -> WhitenedStack<'_> {
    WhitenedStack {
        products,
        log_weight: &LOG_WEIGHT,
        width: 4,
        degrees: DEGREES,
        variance_floor: 1e-18,
    }
}

/// One column with a normal prior of a width, scaled by the variance over what least squares leave: the
/// coefficient and the variance are integrated out.
fn by_hand(square: f64, along: f64, total: f64, width: f64) -> f64 {
    let variance = (total - along * along / square) / DEGREES;
    let precision = variance / (width * width);
    let left = total - along * along / (square + precision);
    -0.5 * (DEGREES * left.ln() + ((square + precision) / precision).ln())
}

fn log_mean(scores: &[f64]) -> f64 {
    let sum: f64 = scores.iter().map(|score| score.exp()).sum();
    (sum / scores.len() as f64).ln()
}

#[test]
fn evidence_of_no_cause_and_of_one_by_hand() {
    let products = products();
    let found = log_evidence(&stack(&products), &[vec![], vec![cause(0, 0)]], false, 1);
    let noises = [1.0, 0.8].into_iter().zip(LOG_WEIGHT);
    let (mut none, mut one) = (0.0, 0.0);
    for (scale, weight) in noises {
        none += (weight - 0.5 * DEGREES * f64::ln(scale * 90.0)).exp();
        let widths = WIDTHS.map(|width| by_hand(scale * 30.0, scale * 31.0, scale * 90.0, width));
        one += (weight + log_mean(&widths)).exp();
    }
    assert!((found[0].log_evidence - none.ln()).abs() < 1e-6);
    assert!((found[1].log_evidence - one.ln()).abs() < 1e-6);
    let likelier = LOG_WEIGHT[1] - LOG_WEIGHT[0] - 0.5 * DEGREES * 0.8_f64.ln();
    let ratio = found[0].noise[1] / found[0].noise[0];
    assert!(
        (ratio.ln() - likelier).abs() < 1e-9,
        "the noises' probabilities"
    );
}

fn options(pruning_log_odds: f64) -> SearchOptions {
    SearchOptions {
        pruning_log_odds,
        form_preference: 1.5,
        unlisted: 0.0,
    }
}

/// Where nothing is pruned, the search has every set of causes with its prior and its evidence.
#[test]
fn a_posterior_without_pruning_has_every_set() {
    let products = products();
    let stack = stack(&products);
    let variants = [cause(0, 0), cause(1, 1), cause(2, 2)];
    let prior = Prior {
        causes: [0.4, 0.3, 0.2, 0.1],
        unexplained: 0.1,
    };
    let found = posterior(&stack, &variants, &prior, &options(f64::INFINITY), 1);
    let order: Vec<f64> = found
        .outcomes
        .iter()
        .map(|o| o.fit.log_evidence + o.prior.ln())
        .collect();
    assert!(order.is_sorted_by(|a, b| a >= b), "most probable first");
    for outcome in &found.outcomes {
        let own: Vec<Variant> = outcome
            .variants
            .iter()
            .map(|&v| variants[v].clone())
            .collect();
        let expected = [0.4, 0.3 / 3.0, 0.2 / 3.0, 0.1][own.len()];
        assert!((outcome.prior - expected).abs() < 1e-15);
        let alone = &log_evidence(&stack, &[own], false, 1)[0];
        let error = outcome.fit.log_evidence - alone.log_evidence;
        assert!(error.abs() < 1e-3, "{:?}: {error}", outcome.variants);
    }
    let best = &found.outcomes[0].variants;
    assert!(best.contains(&0) && best.contains(&2), "{best:?}");
    assert!(found.outcomes.iter().any(|o| o.variants.is_empty()));
}

/// Pruning loses no hypothesis that is reported.
#[test]
fn pruned_and_whole_posteriors_agree() {
    let products = products();
    let stack = stack(&products);
    let variants = [cause(0, 0), cause(1, 1), cause(2, 2)];
    let [whole, pruned] = [f64::INFINITY, 25.0].map(|pruning_log_odds| {
        let prior = Prior {
            causes: [0.4, 0.3, 0.2, 0.1],
            unexplained: 0.1,
        };
        posterior(&stack, &variants, &prior, &options(pruning_log_odds), 1)
    });
    for (whole, pruned) in whole.outcomes.iter().zip(&pruned.outcomes) {
        assert_eq!(whole.variants, pruned.variants);
        assert!((whole.fit.log_evidence - pruned.fit.log_evidence).abs() < 1e-9);
    }
}
