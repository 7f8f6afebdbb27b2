"""Whether the size of a cause is one that such devices and such air have: docs/method.md, Eq. 46."""

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.findings.sentences import parameter_text
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.selection.claims import Claim, Ranking, parameters
from echocal.registry import find_effect

__all__ = ["NO_PROOF", "beyond_a_bound", "implausible"]

NO_PROOF = "Then a gain is no proof"


def implausible(claims: Sequence[Claim], ranking: Ranking, most: float) -> dict[str, str]:
    """Find claims whose sizes are far beyond the prior: something else may act that looks alike.

    A claim is plausible if one of the causes that the data cannot separate from it is, beside the other
    claims.

    Parameters
    ----------
    claims : sequence of Claim
    ranking : Ranking
    most : float
        Prior standard deviations that a size may have.

    Returns
    -------
    dict of str to str
        Ids, each with a sentence on the size.
    """
    said = {}
    everything = {claim.cause for claim in claims}
    for claim in claims:
        others = everything - {claim.cause}
        if _largest(claim.variant, claim.mean) <= most or any(
            _size_beside(rival, others, ranking) <= most for rival in claim.rivals
        ):
            continue
        said[claim.cause] = _sentence(claim)
    return said


def beyond_a_bound(causes: Collection[str], fit: HypothesisFit) -> bool:
    """Whether the rows ask for a size that a cause cannot have, so that the model has the bound instead."""
    for variant, place in fit.hypothesis.placed:
        named = zip(fit.mean[place][: len(variant.names)].tolist(), variant.bounds, strict=False)
        if variant.cause in causes and any(not low <= size <= high for size, (low, high) in named):
            return True
    return False


def _largest(variant: Variant, mean: NDArray[np.floating[Any]]) -> float:
    """Largest of the named sizes of a cause, in prior standard deviations."""
    return float(np.abs(mean[: len(variant.names)]).max(initial=0.0))


def _size_beside(cause: str, others: set[str], ranking: Ranking) -> float:
    """The same of another cause in place of a claim; infinite where no such hypothesis is listed."""
    wanted = tuple(sorted({cause, *others}))
    fit = next((fit for fit in ranking.fits if fit.hypothesis.effects == wanted), None)
    if fit is None:
        return float("inf")
    return next(_largest(v, fit.mean[place]) for v, place in fit.hypothesis.placed if v.cause == cause)


def _sentence(claim: Claim) -> str:
    variant = claim.variant
    place = int(np.abs(claim.mean[: len(variant.names)]).argmax())
    name, scale = variant.names[place], variant.scales[place]
    unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
    value, usual = (
        parameter_text(name, size, 0.0, unit) for size in (parameters(variant, claim.mean)[name], scale)
    )
    times = abs(float(claim.mean[place]))
    return (
        f"the size of {claim.cause} is {times:.2g} times the usual one, so {claim.cause} is not named: "
        f"{value}, where {usual} is usual"
    )
