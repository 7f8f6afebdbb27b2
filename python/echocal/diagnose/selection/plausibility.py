"""Whether the size of a cause is one that such devices have: docs/method/checks.md, Eq. 46 and 46a."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.selection.claims import Claim, Ranking

__all__ = ["implausible"]


def implausible(claims: Sequence[Claim], ranking: Ranking) -> dict[str, str]:
    """Find claims whose sizes are far beyond the prior, or that may be what all rows share.

    Beyond the prior something else may act that looks alike. A claim is plausible if one of the causes that
    the data cannot separate from it is, beside the other claims.

    Returns
    -------
    dict of str to str
        Ids, each with a sentence on the size.
    """
    most, least = ranking.settings.claims.implausible, ranking.settings.claims.beyond_shared
    said = {}
    everything = {claim.cause for claim in claims}
    for claim in claims:
        times, others = _largest(claim.variant, claim.mean), everything - {claim.cause}
        if times > most and all(_size_beside(rival, others, ranking) > most for rival in claim.rivals):
            said[claim.cause] = (
                f"the size of {claim.cause} is {times:.2g} times the usual one, so {claim.cause} is not "
                "named: something else may act that looks the same"
            )
        elif claim.beyond_shared < least:
            said[claim.cause] = (
                "the law of the air, the tape and the moment of arrival may err by as much in all rows, so "
                f"{claim.cause} is not named"
            )
    return said


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
