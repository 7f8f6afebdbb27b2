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
    every_claim : sequence of Claim
        All claims.
    claims : sequence of Claim
        Those that may enter the model.
    noise : Noise
        The most likely noise beside the best hypothesis.
    term : Unexplained or None
        The unexplained term.
    slow : LeastFavorable or None
        What few rows show under each single autoregression; None if there are rows enough.
    """

    best: HypothesisFit
    every_claim: Sequence[Claim]
    claims: Sequence[Claim]
    noise: Noise
    term: Unexplained | None
    slow: LeastFavorable | None = None


def select(case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack) -> Selection:
    """Claim the causes of the best hypothesis."""
    settings = case.settings.claims
    slow = least_favorable(case, ranking, reduced)
    best, every_claim = claim_or_not(case, ranking, reduced, shares, slow)
    noise, _ = reduced.likeliest(best)
    term = unexplained(case, ranking, slow)
    if term is not None:
        every_claim = beside_a_term(every_claim, case.found, reduced, term, settings)
    likely = [claim for claim in every_claim if claim.probability >= settings.modeled_at_all]
    return Selection(best, every_claim, likely, noise, term, slow)
