"""Whether the size of a cause is one and the same all through a table."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates import UNKNOWN
from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.noise import Noise
from echocal.diagnose.sentences import parameter_text
from echocal.registry import find_effect

__all__ = ["unsteady"]

_CHANCE = 1e-4  # that parts of a table with one size differ as much
_BESIDE_A_REMAINDER = 1e-2  # where something is at work already that may well be taken for the cause
_FEWEST = 2  # rows


def unsteady(case: Case, claims: Sequence[Claim], noise: Noise, best: Weighed) -> dict[str, str]:
    """Find claims whose size, fitted to each part of the table alone, is not one size.

    A cause of the mean has one size: what grows in one week and shrinks in another is not it,
    however well it fits on the whole. Each part sizes all claims together, for alone one would
    take up what the others do there.

    Parameters
    ----------
    case : Case
    claims : sequence of Claim
    noise : Noise
    best : Weighed
        The best hypothesis. The shape in it that no cause explains is taken off beforehand; where
        there is one, less makes a claim doubtful.

    Returns
    -------
    dict of str to str
        Id, and the sizes found in a sentence.
    """
    shape = _shape(best)
    chance = _BESIDE_A_REMAINDER if shape else _CHANCE
    said: dict[str, str] = {}
    left = list(claims)
    while left:  # the least steady first: beside it the others are not what they are without
        parts = _fits(case, left, noise, shape)
        sizes = [_sizes(claim, parts) for claim in left]
        chances = [_chance(of_one) for of_one in sizes]
        worst = int(np.argmin(chances))
        if chances[worst] >= chance:
            break
        claim = left.pop(worst)
        said[claim.cause] = (
            f"{claim.cause} has no one size, so it is not named: {_parts(claim, sizes[worst])} in "
            f"{len(sizes[worst])} parts of the table"
        )
    return said


def _chance(sizes: Sequence[tuple[float, float]]) -> float:
    """Probability that sizes of one cause differ as much."""
    if len(sizes) < 2:
        return 1.0
    from scipy.special import chdtrc  # takes long to import

    value, error = np.array(sizes).T
    mean = (value / error**2).sum() / (1 / error**2).sum()
    return float(chdtrc(len(value) - 1, (((value - mean) / error) ** 2).sum()))


def _parts(claim: Claim, sizes: Sequence[tuple[float, float]]) -> str:
    name, scale = claim.variant.names[0], claim.variant.scales[0]
    unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
    parts = [parameter_text(name, scale * v, scale * e, unit).partition(" = ")[2] for v, e in sizes]
    return f"{name} is {', '.join(parts)}"


def _shape(best: Weighed) -> dict[int, float]:
    """Columns of the shape without a cause, and their coefficients."""
    columns = [column for variant in best.hypothesis.variants for column in variant.free]
    unknown = [v.cause == UNKNOWN for v in best.hypothesis.variants for _ in v.free]
    return {c: float(m) for c, m, is_shape in zip(columns, best.mean, unknown, strict=True) if is_shape}


def _fits(case: Case, claims: Sequence[Claim], noise: Noise, shape: Mapping[int, float]) -> list[Weighed]:
    """All claims, fitted to each block alone, beside the shape as it is on the whole."""
    together = Hypothesis(tuple(claim.variant for claim in claims), 1.0)
    blocks = np.arange(len(case.sums.rows))
    fits = []
    for block in blocks[case.folds.fit]:
        use = blocks == block
        if case.sums.degrees(use) >= _FEWEST:
            whitened = case.sums.whiten(noise, use, (*together.columns, *shape))
            whitened = replace(whitened, products=_less(whitened.products, shape))
            fits.append(weigh(together, Stack.of([whitened], case.sums.degrees(use)), one_width=True))
    return fits


def _less(products: NDArray[np.float64], shape: Mapping[int, float]) -> NDArray[np.float64]:
    """Products with a combination of columns taken off the last one."""
    taken, sizes = list(shape), np.array(list(shape.values()))
    less = products.copy()
    less[-1] -= sizes @ less[taken]
    less[:, -1] -= less[:, taken] @ sizes
    return less


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
