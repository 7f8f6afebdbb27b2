"""Whether the size of a cause is one and the same all through a table."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.noise import Noise
from echocal.diagnose.sentences import parameter_text
from echocal.registry import find_effect

__all__ = ["unsteady"]

_CHANCE = 1e-4  # that parts of a table with one size differ as much
_FEWEST = 2  # rows


def unsteady(case: Case, claims: Sequence[Claim], noise: Noise) -> dict[str, str]:
    """Find claims whose size, fitted to each part of the table alone, is not one size.

    A cause of the mean has one size: what grows in one week and shrinks in another is not it,
    however well it fits on the whole. Each part sizes all claims together, for alone one would
    take up what the others do there.

    Returns
    -------
    dict of str to str
        Id, and the sizes found in a sentence.
    """
    said = {}
    parts = _fits(case, claims, noise)
    for claim in claims:
        sizes = _sizes(claim, parts)
        if len(sizes) < 2:
            continue
        value, error = np.array(sizes).T
        mean = (value / error**2).sum() / (1 / error**2).sum()
        if (((value - mean) / error) ** 2).sum() > chi2.isf(_CHANCE, len(value) - 1):
            said[claim.cause] = (
                f"{claim.cause} has no one size, so it is not named: {_parts(claim, sizes)} in "
                f"{len(sizes)} parts of the table"
            )
    return said


def _parts(claim: Claim, sizes: Sequence[tuple[float, float]]) -> str:
    name, scale = claim.variant.names[0], claim.variant.scales[0]
    unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
    parts = [parameter_text(name, scale * v, scale * e, unit).partition(" = ")[2] for v, e in sizes]
    return f"{name} is {', '.join(parts)}"


def _fits(case: Case, claims: Sequence[Claim], noise: Noise) -> list[Weighed]:
    """All claims, fitted to each block alone."""
    together = Hypothesis(tuple(claim.variant for claim in claims), 1.0)
    blocks = np.arange(len(case.sums.rows))
    fits = []
    for block in blocks[case.folds.fit]:
        use = blocks == block
        if case.sums.degrees(use) >= _FEWEST:
            stack = Stack.of([case.sums.whiten(noise, use)], case.sums.degrees(use))
            fits.append(weigh(together, stack, one_width=True))
    return fits


def _sizes(claim: Claim, fits: Sequence[Weighed]) -> list[tuple[float, float]]:
    """Size of one claim beside the others in each block that can show it."""
    if len(claim.variant.free) != 1 or claim.variant.offset is not None:
        return []
    sizes = []
    for weighed in fits:
        variants = weighed.hypothesis.variants
        place = sum(len(v.free) for v in variants[: variants.index(claim.variant)])
        error = float(np.sqrt(weighed.covariance[place, place]))
        if error < 1.0:  # of a prior standard deviation: the block has something to say
            sizes.append((float(weighed.mean[place]), error))
    return sizes
