"""Whether the size of a cause is one and the same all through a table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.findings.sentences import parameter_text
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.selection.claims import Claim
from echocal.registry import find_effect

__all__ = ["unsteady"]

_OF_ROWS = ("row", "time")

Size = tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]
"""Coefficients of a cause and their covariance."""


def unsteady(case: Case, claims: Sequence[Claim], noise: Noise, best: Weighed) -> dict[str, str]:
    """Find claims whose size, fitted to each part of the table alone, is not one size.

    A cause of the mean has one size: what grows in one week and shrinks in another is not it,
    however well it fits on the whole. Each part sizes all claims together, for alone one would
    take up what the others do there. Parts are the blocks that folds hold out. Where those are
    stands and something unexplained follows the rows, they are runs of rows, too: sessions that
    differ follow each other.

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
    settings = case.settings.claims
    beside_term = any(v.cause == UNKNOWN for v in best.hypothesis.variants)
    chance = settings.unsteady_beside_term if beside_term else settings.unsteady
    families = _families(case, claims, noise, best)
    said: dict[str, str] = {}
    left = list(claims)
    while left:  # the least steady first: beside it the others are not what they are without
        looks = [
            _sizes(claim, fits)
            for fits in _fits(families, left, noise, settings.steadiness_rows)
            for claim in left
        ]
        chances = [_chance(sizes) for sizes in looks]
        worst = int(np.argmin(chances))
        if chances[worst] * len(families) >= chance:  # looked at more than once
            break
        claim = left.pop(worst % len(left))
        said[claim.cause] = (
            f"the size of {claim.cause} differs between {len(looks[worst])} parts of the table, so "
            f"{claim.cause} is not named: {_sizes_text(claim, looks[worst])}"
        )
    return said


@dataclass(frozen=True)
class Family:
    """Parts of a table, and where the columns stand in their sums.

    Attributes
    ----------
    sums : Sums
    parts : tuple of ndarray of bool
        Blocks of each part.
    place : mapping of int to int
        Position of a candidate's column in these sums.
    shape : mapping of int to float
        Columns of the shape that is taken off beforehand, in these sums, and their coefficients.
    """

    sums: Sums
    parts: tuple[NDArray[np.bool_], ...]
    place: Mapping[int, int]
    shape: Mapping[int, float]


def _families(case: Case, claims: Sequence[Claim], noise: Noise, best: Weighed) -> list[Family]:
    blocks = np.arange(len(case.sums.rows))
    shape = _shape(best)
    own = {column: column for claim in claims for column in claim.variant.columns}
    parts = tuple(blocks == block for block in blocks[case.folds.fit])
    families = [Family(case.sums, parts, own, shape)]
    if best.hypothesis.shape in _OF_ROWS and (np.diff(case.folds.blocks) < 0).any():
        families.append(_runs(case, list(own), noise))
    return families


def _runs(case: Case, wanted: Sequence[int], noise: Noise) -> Family:
    """Runs of the rows that a fit may see, as many in each; nothing is taken off that changes with them."""
    fit = case.folds.fit[case.folds.blocks]
    count = case.settings.claims.steadiness_runs
    runs = np.full(len(fit), count)
    runs[fit] = np.arange(fit.sum()) * count // fit.sum()
    chosen = [0, *wanted, len(case.found.columns) - 1]  # a group's own first, the residual last
    columns = Columns(case.base.model(), case.residual, case.table.conditions, None)
    for column in case.found.columns.at(chosen):
        columns.store(column)
    sums = Sums.gather(columns, case.sums.order, runs, [noise.remembers])
    parts = tuple(np.arange(len(sums.rows)) == run for run in range(count))
    place = {column: at for at, column in enumerate(chosen[1:-1], 1)}
    return Family(sums, parts, place, {})


def _chance(sizes: Sequence[Size]) -> float:
    """Probability that sizes of one cause differ as much."""
    if len(sizes) < 2:
        return 1.0
    from scipy.stats import chi2  # takes long to import

    weights = [np.linalg.inv(covariance) for _, covariance in sizes]
    mean = np.linalg.solve(sum(weights), sum(w @ value for w, (value, _) in zip(weights, sizes, strict=True)))
    apart = sum((value - mean) @ w @ (value - mean) for w, (value, _) in zip(weights, sizes, strict=True))
    return float(chi2.sf(apart, (len(sizes) - 1) * len(mean)))


def _sizes_text(claim: Claim, sizes: Sequence[Size]) -> str:
    texts = []
    for i, (name, scale) in enumerate(zip(claim.variant.names, claim.variant.scales, strict=True)):
        unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
        parts = [
            parameter_text(name, scale * value[i], scale * float(np.sqrt(covariance[i, i])), unit)
            for value, covariance in sizes
        ]
        texts.append(f"{name} is {', '.join(part.partition(' = ')[2] for part in parts)}")
    return "; ".join(texts)


def _shape(best: Weighed) -> dict[int, float]:
    """Columns of the shape without a cause, and their coefficients."""
    shapes = ((v, place) for v, place in best.hypothesis.placed if v.cause == UNKNOWN)
    return {
        column: float(size)
        for variant, place in shapes
        for column, size in zip(variant.free, best.mean[place], strict=True)
    }


def _fits(
    families: Sequence[Family], claims: Sequence[Claim], noise: Noise, fewest: int
) -> list[list[Weighed]]:
    """All claims, fitted to each part alone, beside the shape as it is on the whole."""
    found = []
    for family in families:
        together = Hypothesis(tuple(_placed(claim.variant, family.place) for claim in claims), 1.0)
        fits = []
        for use in family.parts:
            degrees = family.sums.degrees(use)
            if degrees >= fewest:
                whitened = family.sums.whiten(noise, use)
                whitened = replace(whitened, products=_less(whitened.products, family.shape))
                fits.append(weigh(together, Stack.of([whitened], degrees), one_width=True))
        found.append(fits)
    return found


def _placed(variant: Variant, place: Mapping[int, int]) -> Variant:
    offset = None if variant.offset is None else place[variant.offset]
    return replace(variant, offset=offset, free=tuple(place[column] for column in variant.free))


def _less(products: NDArray[np.float64], shape: Mapping[int, float]) -> NDArray[np.float64]:
    """Products with a combination of columns taken off the last one."""
    taken, sizes = list(shape), np.array(list(shape.values()))
    less = products.copy()
    less[-1] -= sizes @ less[taken]
    less[:, -1] -= less[:, taken] @ sizes
    return less


def _sizes(claim: Claim, fits: Sequence[Weighed]) -> list[Size]:
    """Size of one claim beside the others in each part that can show it."""
    if not claim.variant.free or claim.variant.offset is not None:
        return []
    sizes = []
    for weighed in fits:
        (own,) = (place for v, place in weighed.hypothesis.placed if v.cause == claim.cause)
        covariance = weighed.covariance[own, own]
        if np.diag(covariance).max() < 1.0:  # of a prior standard deviation: it has something to say
            sizes.append((weighed.mean[own], covariance))
    return sizes
