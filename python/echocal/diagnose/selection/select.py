"""The claims before the validation."""

from collections.abc import Sequence
from dataclasses import dataclass

from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import Claim, Ranking
from echocal.diagnose.selection.decision import claim_or_not
from echocal.diagnose.selection.slow_noise import LeastFavorable, least_favorable
from echocal.diagnose.selection.unexplained_term import beside_a_term, unexplained

__all__ = ["Selection", "select"]


@dataclass(frozen=True)
class Selection:
    """The claims before the validation.

    Attributes
    ----------
    best : HypothesisFit
        The hypothesis whose causes are claimed, with the sizes that the model has.
    claims : sequence of Claim
    noise : Noise
        The most likely noise beside the best hypothesis.
    term : Unexplained or None
        The unexplained term.
    slow : LeastFavorable or None
        What few rows show under each single autoregression; None if there are rows enough.
    """

    best: HypothesisFit
    claims: Sequence[Claim]
    noise: Noise
    term: Unexplained | None
    slow: LeastFavorable | None = None


def select(case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack) -> Selection:
    """Claim the causes of the best hypothesis."""
    slow = least_favorable(case, ranking, reduced)
    best, made = claim_or_not(case, ranking, reduced, shares, slow)
    noise, _ = reduced.likeliest(best)
    term = unexplained(case, ranking, slow)
    if term is not None:
        made = beside_a_term(made, case.found, reduced, term)
    return Selection(best, made, noise, term, slow)
