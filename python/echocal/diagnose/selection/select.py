"""The claims before the validation: the decision, then its checks."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import Claim, Ranking, beside_a_term, resized, without
from echocal.diagnose.selection.decision import claim_or_not
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.plausibility import implausible
from echocal.diagnose.selection.slow_noise import LeastFavorable, least_favorable
from echocal.diagnose.selection.steadiness import steadiness, varied
from echocal.diagnose.selection.unexplained_term import sized_apart, unexplained

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
    effects : tuple of str
        The set that was chosen, before any of its claims was left out.
    varying : mapping of str to str
        Claims whose size is not constant, each with a sentence on its sizes.
    implausible : mapping of str to str
        Claims whose size is far beyond the prior, each with a sentence on it.
    unusual : mapping of str to str
        Claims whose size is so large that the log density under the noise is no proof of their gain, each
        with a sentence on it.
    later : mapping of str to str
        Claims of a set that is not the most probable one, each with a sentence on that.
    between : mapping of str to ndarray
        Standard deviation of the sizes of claims between parts of the table, in prior standard deviations.
    carried : mapping of str to str
        Claims that a few rows carry, each with a sentence on these rows.
    unconfirmed : mapping of str to str
        Claims that the rows which judge the model do not show beside the others, each with a sentence.
    misstated : mapping of str to str
        Claims that another reading speed than the stated one explains as well, each with a sentence.
    slow : LeastFavorable or None
        What few rows show under each single autoregression; None if there are rows enough.
    """

    best: HypothesisFit
    every_claim: Sequence[Claim]
    claims: Sequence[Claim]
    noise: Noise
    term: Unexplained | None
    effects: Ids
    varying: Mapping[str, str] = field(default_factory=dict)
    implausible: Mapping[str, str] = field(default_factory=dict)
    unusual: Mapping[str, str] = field(default_factory=dict)
    later: Mapping[str, str] = field(default_factory=dict)
    between: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    carried: Mapping[str, str] = field(default_factory=dict)
    unconfirmed: Mapping[str, str] = field(default_factory=dict)
    misstated: Mapping[str, str] = field(default_factory=dict)
    slow: LeastFavorable | None = None

    @property
    def doubts(self) -> dict[str, str]:
        """Why a claim is not named, whatever its probability is."""
        return {**self.unconfirmed, **self.doubts_of_size, **self.misstated}

    @property
    def doubts_of_size(self) -> dict[str, str]:
        """Those that speak against a claim; a table that is too small to show it does not."""
        return {**self.later, **self.implausible, **self.varying, **self.carried}

    @property
    def doubts_among_tables(self) -> dict[str, str]:
        """The same without sizes that vary so little that a model may have them: as between tables."""
        much = {cause: why for cause, why in self.varying.items() if cause not in self.between}
        return {**self.later, **self.implausible, **much, **self.carried}


def select(
    case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack, *, doubt: bool = True
) -> Selection:
    """Claim the causes of the best hypothesis, then check the claims.

    Without `doubt`, only the checks are made that decide which causes the model has: nobody asks
    whether a fold names them.
    """
    settings = case.settings.claims
    slow = least_favorable(case, ranking, reduced)
    best, every_claim = claim_or_not(case, ranking, reduced, shares, slow)
    whole = best
    noise, _ = reduced.likeliest(best)
    term = unexplained(case, ranking, slow)
    if term is not None:
        against = term.against
        every_claim = beside_a_term(every_claim, case.found, reduced, against, term.rms_m, settings)
        best, every_claim = sized_apart(best, every_claim, reduced, settings.blurred)
    likely = [c for c in every_claim if c.probability >= settings.modeled_from] or [
        c for c in every_claim if c.probability >= settings.modeled_at_all
    ]
    effects = whole.hypothesis.effects
    if term is None and not doubt:
        large = implausible(likely, ranking, settings.implausible)
        return Selection(best, every_claim, likely, noise, term, effects, implausible=large, slow=slow)
    steady = steadiness(case, likely, noise, whole)
    varying = steady.varying
    if term is not None:  # a cause whose size varies fits a part of the unexplained term
        best, likely = _left_out(best, likely, varying.keys() - steady.between.keys(), reduced)
    large = implausible(likely, ranking, settings.implausible)
    unusual = implausible(likely, ranking, settings.unusual)
    likely = resized(likely, varied(best, steady.between)) if steady.between else likely
    given = best, every_claim, likely, noise, term, effects, varying, large, unusual
    return Selection(*given, between=steady.between, slow=slow)


def _left_out(
    best: HypothesisFit, claimed: Sequence[Claim], left_out: Container[str], reduced: Stack
) -> tuple[HypothesisFit, list[Claim]]:
    """Leave out some claims and fit the sizes of the others again, without them."""
    hypothesis = best.hypothesis
    for claim in claimed:
        if claim.cause in left_out:
            hypothesis = without(hypothesis, claim.cause)
    if hypothesis is best.hypothesis:
        return best, list(claimed)
    best = fit_hypothesis(hypothesis, reduced)
    return best, resized([claim for claim in claimed if claim.cause not in left_out], best)
