"""A sensor that fails more and more often."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, log_expit

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.hold_out import HELD_OUT_ROW, NOT_HELD_OUT
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.preprocess.window import OUTSIDE
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FAILURES = ("timeout", "multipath", "crosstalk", "censored_range")
"""Reasons of other faults that are failures of the sensor, each of one row."""


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: int = threshold(12, "1", "failed rows from which on a trend is fitted; judgement")
    parts: int = threshold(20, "1", "parts of the table in which failures are counted; judgement")
    at_last: float = threshold(
        0.05, "1", "part of the rows that fail at the end, below which no user is concerned; judgement"
    )
    growth: float = threshold(2.0, "1", "odds at the end over odds at the start, at least; judgement")


FACTS = CauseFacts(
    id="degrading_sensor",
    kind="row",
    sentence="The sensor fails more and more often: a transducer corrodes, or a supply sags.",
    signature="the part of the rows without a usable reading grows with time",
    source="transducers outdoors are wear parts, replaced every 1 to 3 years (general knowledge)",
    parameters=(
        Quantity("at_first", "1", "part of the rows that fail at the start", (0.0, 1.0)),
        Quantity("at_last", "1", "part of the rows that fail at the end", (0.0, 1.0)),
        Quantity("rows", "1", "failed rows"),
    ),
    check="count the rows without a reading by weeks; replace the sensor and count again",
    prior=0.01,
    formula="ln(p / (1 - p)) grows linearly with time; p = at_first at the start and at_last at the end",
    needs=("elapsed_time",),
    repair="none: the failed rows are left out already, for their own reasons",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Fit a logistic trend to the failed rows, and compare it with a constant part."""
    time = view.observations.conditions["elapsed_time"]
    known = _asked_for(view, time)
    failed = _failed(view) & known
    count = int(failed.sum())
    if count < own.fewest or int(known.sum()) - count < own.fewest or np.ptp(time[known]) <= 0:
        return None
    u = (time[known] - time[known].min()) / np.ptp(time[known])
    y = failed[known]
    slope, level, gain = _trend(u, y)
    first, last = float(expit(level)), float(expit(level + slope))
    if slope < np.log(own.growth) or last < own.at_last:
        return None
    rival = max((_trend(_scaled(column), y)[2] for column in _others(view, known)), default=0.0)
    spread = _dispersion(u, y, expit(level + slope * u), own.parts)
    evidence = (gain - max(rival, 0.0)) / spread - 0.5 * np.log(len(y))
    half = u < 0.5
    because = (
        f"{100 * y[half].mean():.1f} % of the rows of the first half of the time have no usable reading, "
        f"and {100 * y[~half].mean():.1f} % of the second half; by the trend {100 * first:.1f} % at the "
        f"start and {100 * last:.1f} % at the end"
    )
    return Found(failed, float(evidence), because, (first, last, count), view.observations)


def _failed(view: View) -> Mask:
    """Rows that are unusable because of the reading, not because of a thermometer."""
    reasons = view.observations.unusable.astype(str)
    kinds = np.unique(reasons)
    ours = [reason for reason in kinds if reason in _FAILURES or reason.startswith(("reading", "echo"))]
    missing = ~view.observations.usable & ~np.isfinite(recorded(view))
    return np.asarray(np.isin(reasons, ours) | missing)


def _asked_for(view: View, time: Column) -> Mask:
    """Rows with a time, in the period that the user asks for, and not held out."""
    known = np.isfinite(time)
    left_out = np.isin(view.observations.unusable.astype(str), (OUTSIDE, HELD_OUT_ROW, NOT_HELD_OUT))
    if left_out.any():  # rows that are unusable for another reason, too, are known by their time alone
        inside = time[known & view.observations.usable]
        if not len(inside):
            return np.zeros_like(known)
        known &= (time >= inside.min()) & (time <= inside.max()) & ~left_out
    return known


def _others(view: View, known: Mask) -> list[Column]:
    """Other columns that failures may depend on: a far target fails without a worn sensor."""
    columns = [column[known] for column in (view.reference, view.temperature) if column is not None]
    return [column for column in columns if np.isfinite(column).all()]


def _scaled(column: Column) -> Column:
    return np.asarray((column - column.min()) / max(float(np.ptp(column)), 1e-12))


def _trend(u: Column, y: Mask) -> tuple[float, float, float]:
    """Slope and level of the log odds, and the gain in log likelihood over a constant."""
    rate = float(y.mean())

    def loss(at: Column) -> tuple[float, Column]:
        odds = at[0] + at[1] * u
        off = expit(odds) - y
        value = -float(np.where(y, log_expit(odds), log_expit(-odds)).sum())
        return value, np.array([off.sum(), (off * u).sum()])

    found = minimize(loss, np.array([np.log(rate / (1 - rate)), 0.0]), jac=True, method="BFGS")
    constant = len(y) * (rate * np.log(rate) + (1 - rate) * np.log1p(-rate))
    return float(found.x[1]), float(found.x[0]), float(-found.fun - constant)


def _dispersion(u: Column, y: Mask, expected: Column, parts: int) -> float:
    """Variance of the counts in parts over that of independent rows, at least 1: failures come in runs."""
    part = np.minimum((u * parts).astype(np.int64), parts - 1)
    variance = np.bincount(part, expected * (1 - expected), minlength=parts)
    off = np.bincount(part, y - expected, minlength=parts)
    some = variance > 0
    return max(float((off[some] ** 2 / variance[some]).sum()) / max(int(some.sum()) - 2, 1), 1.0)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Lose readings: none at first, two of five at last."""
    time = table["time_s"] if "time_s" in table else np.arange(len(table["reading_m"]), dtype=float)
    u = (time - time[0]) / np.ptp(time)
    table["reading_m"][random.random(len(u)) < 0.4 * u**2] = np.nan


FAULT = Fault(FACTS, detect, spoil, Thresholds())
