"""Whether the size of a cause is constant over a table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.findings.sentences import parameter_text
from echocal.diagnose.inference.averaged_out import averaged_out
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.selection.claims import Claim
from echocal.diagnose.selection.shared_errors import Shared, with_shared_errors
from echocal.registry import find_effect

__all__ = ["Steadiness", "steadiness", "varied"]

_OF_ROWS = ("row", "time")

Size = tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]
"""Coefficients of a cause and their covariance."""


@dataclass(frozen=True)
class Steadiness:
    """Claims whose sizes differ between the parts of a table.

    Attributes
    ----------
    varying : dict of str to str
        Ids of claims that are not one cause, each with a sentence on the sizes found.
    between : dict of str to ndarray
        Standard deviation of the sizes between parts, where it is a part of the size that a model may have;
        in prior standard deviations.
    """

    varying: dict[str, str]
    between: dict[str, NDArray[np.float64]]


def steadiness(case: Case, claims: Sequence[Claim], noise: Noise, best: HypothesisFit) -> Steadiness:
    """Find claims whose sizes differ between parts of the table.

    A claim whose size differs much between parts is not one cause, even if it fits the whole table.
    Where the sizes of a real cause vary a little from part to part, this is a part of its uncertainty.
    In each part all claims are fitted together, because a single claim would
    also fit what the others explain. The parts are the blocks of the folds. If the blocks are
    stations and an unexplained term follows the row or the time, runs of rows are compared, too:
    they separate sessions.

    Parameters
    ----------
    case : Case
    claims : sequence of Claim
    noise : Noise
    best : HypothesisFit
        The best hypothesis. Its unexplained term is subtracted first. If it has one, a smaller
        difference makes a claim doubtful.
    """
    settings = case.settings.claims
    beside_term = any(v.cause == UNKNOWN for v in best.hypothesis.variants)
    limit = settings.unsteady_beside_term if beside_term else settings.unsteady
    families = _families(case, claims, noise, best)
    said: dict[str, str] = {}
    between: dict[str, NDArray[np.float64]] = {}
    left = list(claims)
    while left:  # the least constant first: the others change when it is taken out
        found = [
            (claim, _sizes(claim, fits))
            for fits in _fits(families, left, noise, best.variance, settings.steadiness_rows)
            for claim in left
        ]
        p_values = [_p_value(sizes) if claim.cause not in between else 1.0 for claim, sizes in found]
        worst = int(np.argmin(p_values))
        if p_values[worst] * len(families) >= limit:  # Bonferroni
            break
        claim, sizes = found[worst]
        spread, mean = _between(sizes)
        if (spread <= settings.unsteady_share_in_model * np.abs(mean)).all():
            between[claim.cause] = spread
            if (spread <= settings.unsteady_share * np.abs(mean)).all():
                continue
        else:
            left.remove(claim)
        said[claim.cause] = (
            f"the size of {claim.cause} differs between {len(sizes)} parts of the table, so "
            f"{claim.cause} is not named: {_sizes_text(claim, sizes)}"
        )
    return Steadiness(said, between)


def _between(sizes: Sequence[Size]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Standard deviation of sizes between parts, and their mean: docs/method.md, Eq. 28."""
    values = np.array([value for value, _ in sizes], dtype=np.float64)
    weights = np.array([1.0 / np.diag(covariance) for _, covariance in sizes])
    total = weights.sum(axis=0)
    mean = (weights * values).sum(axis=0) / total
    apart = (weights * (values - mean) ** 2).sum(axis=0) - (len(sizes) - 1)
    variance = np.maximum(apart, 0.0) / (total - (weights**2).sum(axis=0) / total)
    return np.sqrt(variance), mean


def varied(fit: HypothesisFit, between: Mapping[str, NDArray[np.float64]]) -> HypothesisFit:
    """Add the variance of sizes between parts of the table to that of a fit."""
    more = np.zeros(len(fit.mean))
    for variant, place in fit.hypothesis.placed:
        if variant.cause in between:
            more[place] = between[variant.cause] ** 2
    return fit._replace(covariance=fit.covariance + np.diag(more)) if more.any() else fit


@dataclass(frozen=True)
class Family:
    """Parts of a table, and the positions of the columns in their sums.

    Attributes
    ----------
    sums : Sums
    parts : tuple of ndarray of bool
        Blocks of each part.
    place : mapping of int to int
        Position of a candidate's column in these sums.
    term : mapping of int to float
        Columns of the unexplained term that is subtracted first, and their coefficients.
    shared : Shared
        Errors that the rows of a placement share.
    slow_air : tuple of int
        Columns of air that differs from the thermometer, in these sums.
    """

    sums: Sums
    parts: tuple[NDArray[np.bool_], ...]
    place: Mapping[int, int]
    term: Mapping[int, float]
    shared: Shared
    slow_air: tuple[int, ...]


def _families(case: Case, claims: Sequence[Claim], noise: Noise, best: HypothesisFit) -> list[Family]:
    blocks = np.arange(len(case.sums.rows))
    term = _term(best)
    own = {column: column for claim in claims for column in claim.variant.columns}
    parts = tuple(blocks == block for block in blocks[case.folds.fit])
    shared = Shared.of(case)
    families = [Family(case.sums, parts, own, term, shared, case.found.slow_air)]
    if best.hypothesis.term in _OF_ROWS and (np.diff(case.folds.blocks) < 0).any():
        families.append(_runs(case, list(own), noise, shared))
    return families


def _runs(case: Case, wanted: Sequence[int], noise: Noise, shared: Shared) -> Family:
    """Runs of equally many fitted rows; no term is subtracted, because it changes with the rows."""
    fit = case.folds.fit[case.folds.blocks]
    count = case.settings.claims.steadiness_runs
    runs = np.full(len(fit), count)
    runs[fit] = np.arange(fit.sum()) * count // fit.sum()
    last = len(case.found.columns) - 1
    chosen = [0, *wanted, *case.found.slow_air, last]  # first the column of the groups, last the residual
    columns = Columns(case.base.model(), case.residual, case.table.conditions, None)
    for column in case.found.columns.at(chosen):
        columns.store(column)
    sums = Sums.gather(columns, case.sums.order, runs, [noise.correlation])
    parts = tuple(np.arange(len(sums.rows)) == run for run in range(count))
    place = {column: at for at, column in enumerate(chosen[1:-1], 1)}
    slow_air = tuple(place[column] for column in case.found.slow_air)
    return Family(sums, parts, place, {}, replace(shared, apart=False), slow_air)


def _p_value(sizes: Sequence[Size]) -> float:
    """Probability that sizes of one cause differ at least as much by chance: docs/method.md, Eq. 28."""
    if len(sizes) < 2:
        return 1.0
    weights = [np.linalg.inv(covariance) for _, covariance in sizes]
    mean = np.linalg.solve(sum(weights), sum(w @ value for w, (value, _) in zip(weights, sizes, strict=True)))
    apart = sum((value - mean) @ w @ (value - mean) for w, (value, _) in zip(weights, sizes, strict=True))
    return float(chdtrc((len(sizes) - 1) * len(mean), apart))


def _sizes_text(claim: Claim, sizes: Sequence[Size]) -> str:
    texts = []
    for i, (name, scale) in enumerate(zip(claim.variant.names, claim.variant.scales, strict=True)):
        unit = next(p.unit for p in find_effect(claim.cause).parameters if p.name == name)
        at = claim.variant.at.get(name, 0.0)
        parts = [
            parameter_text(name, at + scale * value[i], scale * float(np.sqrt(covariance[i, i])), unit)
            for value, covariance in sizes
        ]
        texts.append(f"{name} is {', '.join(part.partition(' = ')[2] for part in parts)}")
    return "; ".join(texts)


def _term(best: HypothesisFit) -> dict[int, float]:
    """Columns of the unexplained term, and their coefficients."""
    terms = ((v, place) for v, place in best.hypothesis.placed if v.cause == UNKNOWN)
    return {
        column: float(size)
        for variant, place in terms
        for column, size in zip(variant.free, best.mean[place], strict=True)
    }


def _fits(
    families: Sequence[Family], claims: Sequence[Claim], noise: Noise, variance: float, fewest: int
) -> list[list[HypothesisFit]]:
    """All claims, fitted to each part alone; the unexplained term is that of the whole table.

    `variance` is that of the innovations in the whole table [m^2].
    """
    found = []
    for family in families:
        together = Hypothesis(tuple(_placed(claim.variant, family.place) for claim in claims), 1.0)
        fits = []
        for use in family.parts:
            degrees = family.sums.degrees(use)
            if degrees >= fewest:
                whitened = family.sums.whiten(noise, use)
                less = _less(whitened.products, family.term)[None]
                weight = np.array([whitened.log_weight])
                if noise.slow_air:
                    known = variance / noise.slow_air**2
                    less, weight = averaged_out(less, weight, family.slow_air, known)
                fit = fit_hypothesis(together, Stack(less, weight, degrees, (noise,)), one_width=True)
                more = noise.station_ratio * max(variance - fit.variance, 0.0)  # the tape errs in each part
                columns = [column for claim in claims for column in claim.variant.free]
                fits.append(with_shared_errors(fit, family.shared, columns, use[family.sums.blocks], more))
        found.append(fits)
    return found


def _placed(variant: Variant, place: Mapping[int, int]) -> Variant:
    offset = None if variant.offset is None else place[variant.offset]
    return replace(variant, offset=offset, free=tuple(place[column] for column in variant.free))


def _less(products: NDArray[np.float64], term: Mapping[int, float]) -> NDArray[np.float64]:
    """Products after a combination of columns is subtracted from the last one."""
    taken, sizes = list(term), np.array(list(term.values()))
    less = products.copy()
    less[-1] -= sizes @ less[taken]
    less[:, -1] -= less[:, taken] @ sizes
    return less


def _sizes(claim: Claim, fits: Sequence[HypothesisFit]) -> list[Size]:
    """Size of one claim beside the others in each part that can show it."""
    if not claim.variant.free or claim.variant.offset is not None:
        return []
    sizes = []
    for fit in fits:
        (own,) = (place for v, place in fit.hypothesis.placed if v.cause == claim.cause)
        covariance = fit.covariance[own, own]
        if np.diag(covariance).max() < 1.0:  # of the prior variance: the part is informative
            sizes.append((fit.mean[own], covariance))
    return sizes
