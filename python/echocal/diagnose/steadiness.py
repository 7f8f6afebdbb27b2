"""Whether the size of a cause is one and the same all through a table."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim
from echocal.diagnose.evidence import Hypothesis, Stack, weigh
from echocal.diagnose.noise import Noise
from echocal.diagnose.sentences import parameter_text
from echocal.registry import find_effect

__all__ = ["unsteady"]

_CHANCE = 1e-4  # that parts of a table with one size differ as much


def unsteady(case: Case, claims: Sequence[Claim], noise: Noise) -> dict[str, str]:
    """Find claims whose size, fitted to each part of the table alone, is not one size.

    A cause of the mean has one size: what grows in one week and shrinks in another is not it,
    however well it fits on the whole.

    Returns
    -------
    dict of str to str
        Id, and the sizes found in a sentence.
    """
    said = {}
    for claim in claims:
        sizes = _sizes(case, claim, noise)
        if len(sizes) < 2:
            continue
        value, error = np.array(sizes).T
        mean = (value / error**2).sum() / (1 / error**2).sum()
        if (((value - mean) / error) ** 2).sum() > chi2.isf(_CHANCE, len(value) - 1):
            said[claim.cause] = (
                f"{claim.cause} has no one size: {_parts(claim, sizes)} in {len(sizes)} parts of the table"
            )
    return said


def _parts(claim: Claim, sizes: Sequence[tuple[float, float]]) -> str:
    name, scale = claim.variant.names[0], claim.variant.scales[0]
    unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
    parts = [parameter_text(name, scale * v, scale * e, unit).partition(" = ")[2] for v, e in sizes]
    return f"{name} is {', '.join(parts)}"


def _sizes(case: Case, claim: Claim, noise: Noise) -> list[tuple[float, float]]:
    """Size of one claim in each block alone, where that block can show it."""
    variant = claim.variant
    if len(variant.free) != 1 or variant.offset is not None:
        return []
    blocks = np.arange(len(case.sums.rows))
    sizes = []
    for block in blocks[case.folds.fit]:
        use = blocks == block
        if case.sums.degrees(use) < 2:
            continue
        stack = Stack.of([case.sums.whiten(noise, use)], case.sums.degrees(use))
        weighed = weigh(Hypothesis((variant,), 1.0), stack)
        error = float(np.sqrt(weighed.covariance[0, 0]))
        if error < 1.0:  # of a prior standard deviation: the block has something to say
            sizes.append((float(weighed.mean[0]), error))
    return sizes
