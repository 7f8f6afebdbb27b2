"""Two causes that only act together: neither alone is the way to the pair."""

import numpy as np

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.settings import Settings

RIVALS = ("fixed_delay", "zero_error", "clock_error", "speed_intercept")


def ranking(probability: dict[tuple[str, ...], float]) -> Ranking:
    """Sets of effects with these probabilities."""
    total, fits = sum(probability.values()), []
    for ids in probability:
        variants = tuple(Variant(id_, {}, free=(at,)) for at, id_ in enumerate(ids))
        size = np.zeros(len(ids)), np.eye(len(ids))
        fits.append(HypothesisFit(Hypothesis(variants, 1.0), 0.0, *size, np.ones(1), 1e-6))
    shares = np.array([p / total for p in probability.values()])
    sets = [(tuple(sorted(ids)), p / total) for ids, p in probability.items()]
    return Ranking(fits, shares, sorted(sets, key=lambda one: -one[1]), Settings())


def test_pairs_are_tried_where_no_single_cause_is_probable(random: np.random.Generator) -> None:
    """The pairs share their probability, so that no set has more than the empty one."""
    pairs = {(other, "temperature_gain"): random.uniform(0.1, 0.2) for other in RIVALS}
    single = {("thermal_expansion",): 10 ** random.uniform(-9.0, -4.0)}
    chosen = ranking({(): 0.22, **pairs, **single}).best(beyond=())
    assert chosen is not None
    assert chosen.hypothesis.ids == tuple(sorted(max(pairs, key=lambda ids: pairs[ids])))


def test_one_cause_is_tried_first_where_it_may_act(random: np.random.Generator) -> None:
    pairs = {(other, "temperature_gain"): random.uniform(0.1, 0.2) for other in RIVALS}
    single = {("thermal_expansion",): random.uniform(0.06, 0.1)}
    chosen = ranking({(): 0.22, **pairs, **single}).best(beyond=())
    assert chosen is not None
    assert chosen.hypothesis.ids == ("thermal_expansion",)
