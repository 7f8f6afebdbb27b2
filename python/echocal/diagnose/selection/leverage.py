"""Whether a few rows carry a cause: then the other rows must speak for it, too."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.findings.sentences import rows_text
from echocal.diagnose.inference.averaged_out import averaged_out, noise_variances
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.selection.claims import Claim, without
from echocal.diagnose.settings import ClaimSettings

__all__ = ["carried_by_few"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]


def carried_by_few(case: Case, claims: Sequence[Claim], best: HypothesisFit, noise: Noise) -> dict[str, str]:
    """Find claims that the table does not support without the few rows that carry them.

    The squared error that a claim removes is summed over contiguous pieces of the rows. If few pieces have
    most of it, as the first minutes after an installation may, the hypothesis is compared with and
    without the claim on the other rows: docs/method.md, section 7, "Few rows".

    Parameters
    ----------
    case : Case
    claims : sequence of Claim
    best : HypothesisFit
        The hypothesis that they belong to.
    noise : Noise

    Returns
    -------
    dict of str to str
        Ids, each with a sentence on these rows.
    """
    settings = case.settings.claims
    rows = np.flatnonzero(case.folds.fitted)
    left = _without_levels(case, case.left(best, rows), rows)
    pieces = np.arange(len(rows)) * min(settings.leverage_pieces, len(rows)) // len(rows)
    said = {}
    for claim in claims:
        signal = _without_levels(case, case.signal(claim.variant, claim.mean)[rows], rows)
        few = _carriers(signal * (signal + 2.0 * left), pieces, settings)
        if few is None or _supported(case, best.hypothesis, claim.cause, noise, rows[few]) > 0.0:
            continue
        where = rows_text(case.table.row[rows[few]])
        said[claim.cause] = (
            f"{int(few.sum())} of {len(rows)} rows carry {claim.cause} ({where}), and the others do "
            f"not speak for it, so {claim.cause} is not named"
        )
    return said


def _without_levels(case: Case, values: Column, rows: NDArray[np.int64]) -> Column:
    """Values less their mean in each segment, where the level of each is unknown."""
    if not case.sums.flat_level:
        return values
    groups = case.table.groups[rows]
    return values - (np.bincount(groups, values) / np.maximum(np.bincount(groups), 1))[groups]


def _carriers(removed: Column, pieces: NDArray[np.int64], settings: ClaimSettings) -> Mask | None:
    """Rows of the few pieces with most of the squared error that is removed; None if they have too little."""
    each = np.bincount(pieces, removed)
    few = np.argsort(-each)[: max(1, int(settings.leverage_rows * len(each)))]
    total = float(each.sum())
    if total <= 0.0 or each[few].sum() < settings.leverage_share * total:
        return None
    return np.isin(pieces, few)


def _supported(case: Case, whole: Hypothesis, cause: str, noise: Noise, carriers: NDArray[np.int64]) -> float:
    """Log Bayes factor of a cause beside the others of a hypothesis, on the rows that do not carry it."""
    wanted = list(dict.fromkeys(whole.columns))
    columns = Columns(case.base.model(), case.residual, case.table.conditions, None)
    slow_air = case.found.slow_air
    for column in case.found.columns.at([0, *wanted, *slow_air, len(case.found.columns) - 1]):
        columns.store(column)
    labels = np.where(case.folds.fitted, 0, 1)
    labels[carriers] = 1
    sums = Sums.gather(columns, case.sums.order, labels, [noise.correlation])
    others = np.arange(len(sums.rows)) == 0
    stack = Stack.of([sums.whiten(noise, others)], sums.degrees(others))
    if noise.slow_air:
        own = range(1 + len(wanted), 1 + len(wanted) + len(slow_air))
        variance = noise_variances(stack.products, stack.degrees, case.settings.noise_models.ridge_width)
        variance = variance / noise.slow_air**2
        products, weight = averaged_out(stack.products, stack.log_weight, own, variance)
        stack = replace(stack, products=products, log_weight=weight)
    place = {column: at for at, column in enumerate(wanted, 1)}
    hypothesis = Hypothesis(tuple(_placed(variant, place) for variant in whole.variants), 1.0)
    with_it, without_it = (
        fit_hypothesis(one, stack, one_width=True).log_evidence
        for one in (hypothesis, without(hypothesis, cause))
    )
    return with_it - without_it


def _placed(variant: Variant, place: dict[int, int]) -> Variant:
    offset = None if variant.offset is None else place[variant.offset]
    return replace(variant, offset=offset, free=tuple(place[column] for column in variant.free))
