"""The decision "claim or not": docs/method.md, section 7, Eq. 25."""

from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import Claim, Ranking, claims
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.slow_noise import LeastFavorable
from echocal.diagnose.selection.unexplained_term import term_is_told
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["claim_or_not", "is_claimed", "threshold_of"]


def claim_or_not(
    case: Case,
    ranking: Ranking,
    reduced: Stack,
    shares: NoisePosterior,
    slow: LeastFavorable | None = None,
) -> tuple[HypothesisFit, list[Claim]]:
    """Find the best hypothesis, extend it while a further effect is claimed, and list its claims.

    If the best set of effects is not empty, the threshold is not tested. The hypothesis that is tried
    next is that of the best set with one effect more, or more (`Ranking.best`). The effect that it adds
    represents its class: the effect and its rivals, which the data cannot separate from it.

    Nothing is claimed if few rows do not show an effect under each single autoregression (`slow`).
    """
    best = ranking.best()
    if best is None:
        raise RuntimeError("no hypothesis was fitted")
    if slow is not None and slow.no_effect >= ranking.settings.priors.no_cause:
        return ranking.without_effects(term=term_is_told(ranking, slow)) or best, []
    threshold = threshold_of(len(case.table), ranking, shares)
    while (grown := ranking.best(beyond=best.hypothesis.effects)) is not None:
        ids = best.hypothesis.effects
        if not is_claimed(ids, *ranking.more(ids), threshold):
            break  # the class of the further effect is at most as probable as all larger sets together
        if ids:  # the empty set is extended whatever the class is
            more = _of(grown, case, ranking, reduced, ids)
            of_class = [id_ for claim in more for id_ in (claim.cause, *claim.rivals)]
            if not is_claimed(ids, *ranking.more(ids, of_class), threshold):
                break
        best = grown
    return best, _of(best, case, ranking, reduced)


def is_claimed(ids: Ids, alone: float, beside: float, threshold: float) -> bool:
    """Whether a further effect is claimed: docs/method.md, Eq. 25.

    The empty set is extended if its probability is below a threshold. It may be improbable although
    each single effect is improbable, too, because rivals share their probability. Any other set is
    extended if the whole class of the further effect is more probable than the set without it.

    Parameters
    ----------
    ids : tuple of str
        The set E of effects claimed so far.
    alone : float
        P(E), with or without an unexplained term.
    beside : float
        Probability of the larger sets that include E and an effect of the class.
    threshold : float
        The threshold t.
    """
    no_effect_is_improbable = alone < threshold
    class_is_more_probable = beside > alone
    return class_is_more_probable if ids else no_effect_is_improbable


def threshold_of(rows: int, ranking: Ranking, shares: NoisePosterior) -> float:
    """Probability of "no effect" below which an effect is claimed: t of docs/method.md, Eq. 25."""
    settings, prior = ranking.settings.claims, ranking.settings.priors.no_cause
    found = [{id_: p * q for id_, q in shares.nuisance_of(ids).items()} for ids, p in ranking.sets]
    present = (sum(one.get(noise.facts.id, 0.0) for one in found) for noise in registry.nuisances())
    if max(present, default=0.0) > PROBABLE:
        return settings.claim_below_amid_noise
    return prior if rows < settings.few_rows else settings.claim_below


def _of(fit: HypothesisFit, case: Case, ranking: Ranking, reduced: Stack, beyond: Ids = ()) -> list[Claim]:
    """Claims of a hypothesis, except those in `beyond`."""
    _, products = reduced.likeliest(fit)
    return claims(ranking, fit, case.found, Geometry(products, fit.variance), beyond)
