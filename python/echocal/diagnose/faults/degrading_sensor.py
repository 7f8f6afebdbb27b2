"""A sensor that fails more and more often."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, log_expit

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.likelihood import independent
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.hold_out import HELD_OUT_ROW, NOT_HELD_OUT
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.preprocess.window import OUTSIDE
from echocal.diagnose.settings.faults import FaultSettings

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FAILURES = ("timeout", "multipath", "crosstalk", "censored_range")
"""Reasons of other faults that are failures of the sensor, each of one row."""


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


def detect(view: View, _: object, settings: FaultSettings) -> Found | None:
    """Fit a logistic trend to the failed rows, and compare it with a constant part."""
    time = view.observations.conditions["elapsed_time"]
    known = _asked_for(view, time)
    failed = _failed(view) & known
    if not failed.any() or failed.sum() == known.sum() or np.ptp(time[known]) <= 0:
        return None
    u, y = _scaled(time[known]), failed[known]
    slope, level, gain = _trend(u, y)
    if slope <= 0.0:
        return None
    first, last = float(expit(level)), float(expit(level + slope))
    rival = max((_trend(_scaled(column), y)[2] for column in _others(view, known)), default=0.0)
    part = independent(y - expit(level + slope * u))  # failures come in runs
    evidence = part * (gain - max(rival, 0.0)) - 0.5 * float(np.log(len(y)))
    half = u < 0.5
    because = (
        f"{100 * y[half].mean():.1f} % of the rows of the first half of the time have no usable reading, "
        f"and {100 * y[~half].mean():.1f} % of the second half; by the trend {100 * first:.1f} % at the "
        f"start and {100 * last:.1f} % at the end"
    )
    return Found(failed, evidence, because, (first, last, failed.sum()), view.observations)


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


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Lose readings: none at first, two of five at last."""
    time = table["time_s"] if "time_s" in table else np.arange(len(table["reading_m"]), dtype=float)
    u = (time - time[0]) / np.ptp(time)
    table["reading_m"][random.random(len(u)) < 0.4 * u**2] = np.nan


FAULT = Fault(FACTS, detect, spoil)
