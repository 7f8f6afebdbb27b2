"""How visible a cause is in a table: its signal against what one reading and one placement scatter."""

from dataclasses import dataclass

import numpy as np

from hidden_effects.bench.truth import NOISES
from hidden_effects.bench.world import Case, Column, error, signal_of

DETECTABLE = 5.0
"""Strength below which a cause is marginal, and judged apart: the least at which power is asked for."""


@dataclass(frozen=True)
class Strength:
    """Signal and noise of one cause in one table.

    Attributes
    ----------
    rms : float
        Of the signal [m].
    scatter : float
        Standard deviation of single readings at one placement [m], with the detector of the table.
    placement : float
        The same of the mean of a placement [m], with the ideal detector: the tape, the hand, slow air.
    strength : float
        snr sqrt(N) with both: sqrt(s' V^-1 s) of the signal s, with V the covariance of readings that share
        the error of their placement. For a noise snr^2 sqrt(N/2), which is the same for a variance.
    """

    rms: float
    scatter: float
    placement: float
    strength: float

    @property
    def snr(self) -> float:
        """Root mean square of the signal over the scatter of single readings."""
        return self.rms / self.scatter


def strengths(case: Case) -> dict[str, Strength]:
    """Strength of each cause of a case."""
    return {id_: strength(case, id_) for id_ in case.spec.causes}


def strength(case: Case, id_: str) -> Strength:
    """Strength of one cause of a case."""
    added = signal_of(case, id_)
    seen = np.isfinite(added)
    added = np.where(seen, added, 0.0)
    groups = _groups(case)
    scatter, placement = _noise(case, groups)
    rms = float(np.sqrt(np.mean(added[seen] ** 2))) if seen.any() else 0.0
    if id_ in NOISES:
        strong = (rms / scatter) ** 2 * np.sqrt(seen.sum() / 2)
    else:
        added = added if "distance_m" in case.made.table else added - added[seen].mean()
        count, total = np.bincount(groups), np.bincount(groups, added)
        shared = placement**2 / (scatter**2 + count * placement**2) * total**2
        strong = np.sqrt(max(0.0, float(np.sum(added**2) - np.sum(shared)))) / scatter
    return Strength(rms, scatter, placement, float(strong))


def _groups(case: Case) -> np.ndarray:
    """Placement of each row; one for all where every row is a placement of its own, as in a log."""
    placement = case.made.campaign.placement
    return placement if np.bincount(placement).max() > 1 else np.zeros_like(placement)


def _noise(case: Case, groups: np.ndarray) -> tuple[float, float]:
    """Scatter of readings, and of placements [m], of the pair without the causes."""
    ideal = error(case.ideal)
    scatter = max(_within(ideal, groups), _successive(error(case.without), groups))
    if groups.max() == 0:
        return scatter, 0.0
    count = np.maximum(np.bincount(groups, np.isfinite(ideal)), 1)
    means = np.bincount(groups, np.nan_to_num(ideal)) / count
    between = float(np.var(means, ddof=1) - _within(ideal, groups) ** 2 / np.mean(count))
    return scatter, float(np.sqrt(max(0.0, between)))


def _within(values: Column, groups: np.ndarray) -> float:
    """Pooled standard deviation inside groups [m]."""
    seen = np.isfinite(values)
    values, groups = values[seen], groups[seen]
    count = np.bincount(groups)
    mean = np.bincount(groups, values) / np.maximum(count, 1)
    freedom = max(1, len(values) - int((count > 0).sum()))
    return float(np.sqrt(np.sum((values - mean[groups]) ** 2) / freedom))


def _successive(values: Column, groups: np.ndarray) -> float:
    """Scatter of readings from successive differences inside groups [m]: what a trend does not enlarge."""
    order = np.argsort(groups, kind="stable")
    steps = np.diff(values[order])[np.diff(groups[order]) == 0]
    return float(np.sqrt(np.nanmean(steps**2) / 2))
