"""Methods of compensation: each learns from the log of one campaign and corrects the log of another."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import differential_evolution, least_squares

import echocal
from compensation.world import Column
from echocal.correct import correct_table

_MICRO = 1e-6
Correction = Callable[[pd.DataFrame], Column]


@dataclass(frozen=True)
class Method:
    """A way from a log to distances."""

    label: str
    learn: Callable[[pd.DataFrame, int], Correction]  # training log and seed to the correction of a log [m]


def fixed(log: pd.DataFrame) -> Column:
    """Distance at 343 m/s."""
    return 0.5 * 343.0 * _MICRO * log["echo_us"].to_numpy()


def study(log: pd.DataFrame) -> Column:
    """The study's formula: d (331.4 + 0.6 T) / 343."""
    return fixed(log) * (331.4 + 0.6 * log["temperature_C"].to_numpy()) / 343.0


def cramer(log: pd.DataFrame, damp: float | None = None) -> Column:
    """Distance by Cramer 1993, at a humidity or at that of the log; 50 % where it has none."""
    measured = log["humidity_percent"].to_numpy() / 100 if "humidity_percent" in log else 0.5
    speed = echocal.speed_of_sound(log["temperature_C"].to_numpy(), measured if damp is None else damp)
    return 0.5 * np.asarray(speed) * _MICRO * log["echo_us"].to_numpy()


def physics(log: pd.DataFrame) -> Column:
    """Compute the best distance that the log allows without training."""
    return cramer(log) if "temperature_C" in log else fixed(log)


def zeroed(log: pd.DataFrame, seed: int) -> Correction:
    """Subtract the error of the first placement."""
    one = log["stand"] == log["stand"].iloc[0]
    shift = float(np.nanmean((physics(log) - log["distance_m"])[one]))
    return lambda other: physics(other) - shift


def lined(formula: Callable[[pd.DataFrame], Column]) -> Callable[[pd.DataFrame, int], Correction]:
    """Fit a straight line through all placements to a formula."""

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        x, y = formula(log), log["distance_m"].to_numpy()
        known = np.isfinite(x)
        slope, level = np.polyfit(x[known], y[known], 1)
        return lambda other: level + slope * formula(other)

    return learn


def calibrated(log: pd.DataFrame, seed: int) -> Correction:
    """Fit the delay and the clock."""
    return _corrected(_calibrated(log))


def named(*, calibrated: bool = False, smooth: bool = False) -> Callable[[pd.DataFrame, int], Correction]:
    """Name the causes, and keep those that hold in another campaign.

    Delay and clock may be calibrated before; a smooth correction of what no cause explains may follow, where
    the diagnosis offers one.
    """

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        found = diagnosed(log, seed, calibrated)
        offered = smooth and found.smooth is not None and found.smooth.offered
        return _corrected((found.model_with_smooth if offered else found.model).transferable())

    return learn


def diagnosed(log: pd.DataFrame, seed: int, calibrated: bool = False) -> echocal.Diagnosis:
    """Diagnose a log; the last results are kept, since several methods use them."""
    key = (seed, calibrated, log.to_csv())
    if key not in _KEPT:
        if len(_KEPT) > 1:
            _KEPT.clear()
        base = _calibrated(log) if calibrated else "cramer"
        with warnings.catch_warnings(action="ignore"):
            _KEPT[key] = echocal.diagnose(log, base=base, seed=seed)
    return _KEPT[key]


_KEPT: dict[Any, echocal.Diagnosis] = {}


def _calibrated(log: pd.DataFrame) -> echocal.Model:
    fit = ["fixed_delay.delay", "clock_error.frequency_error"]
    with warnings.catch_warnings(action="ignore"):
        return echocal.calibrate(log, echocal.Model("cramer"), fit=fit, loss="soft_l1").model


def _corrected(model: echocal.Model) -> Correction:
    def correct(other: pd.DataFrame) -> Column:
        shown = other.drop(columns=["distance_m", "stand"])
        with warnings.catch_warnings(action="ignore"):
            found = correct_table(shown, model, mark_rows=False).table["corrected_distance_m"]
        return np.asarray(found, dtype=float)

    return correct


_SPAN = 1800.0  # s, over which a rate is taken
_BOUNDS = ((-300.0, 300.0), (0.98, 1.02), (-3.0, 3.0), (-0.1, 0.1), (0.0, 1800.0), (-30.0, 30.0))
"""Of delay [us], scale, offset [K], gain [1/K], lag [s], and walk [us/m]: judgements."""


def _physical(values: Column, log: pd.DataFrame) -> Column:
    """Six parameters: delay, clock, offset, gain and lag of the thermometer, walk with the distance."""
    delay, scale, offset, gain, lag, walk = values
    read, at = log["temperature_C"].to_numpy(), log["time_s"].to_numpy()
    later, earlier = (np.interp(at + way * _SPAN, at, read) for way in (0.5, -0.5))
    rate = (later - earlier) / _SPAN
    warm = np.clip(read + lag * rate + offset + gain * (read - 25.0), -40.0, 60.0)
    rough = fixed(log)
    echo = scale * log["echo_us"].to_numpy() - delay - walk * rough
    return cramer(log.assign(temperature_C=warm, echo_us=echo))


def _residual(values: Column, log: pd.DataFrame) -> Column:
    left = 1e3 * (_physical(values, log) - log["distance_m"].to_numpy())
    return left[np.isfinite(left)]


def optimized(*, globally: bool) -> Callable[[pd.DataFrame, int], Correction]:
    """Search globally by differential evolution, then locally by least squares; or only the latter.

    The idea of the phased hybrid optimization that the study cites (Li et al.), on a physical model.
    """

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        thin, (low, high) = log.iloc[:: max(1, len(log) // 240)], np.array(_BOUNDS).T
        start = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])

        def cost(values: Column) -> float:
            return float(np.mean(2 * (np.sqrt(1 + 0.25 * _residual(values, thin) ** 2) - 1)))

        if globally:
            options = {"polish": False, "maxiter": 40, "popsize": 8, "tol": 1e-4}
            start = differential_evolution(cost, _BOUNDS, seed=seed, **options).x
        inside, scale = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low)), high - low
        options = {"x_scale": scale, "loss": "soft_l1", "f_scale": 2.0}
        found = least_squares(_residual, inside, bounds=(low, high), args=(log,), **options)
        return lambda other: _physical(found.x, other)

    return learn


def bare(formula: Callable[..., Column], **options: Any) -> Callable[[pd.DataFrame, int], Correction]:
    """Learn nothing."""
    return lambda log, seed: lambda other: formula(other, **options)


METHODS = {
    "fixed": Method("343 m/s", bare(fixed)),
    "study": Method("study: d (331.4 + 0.6 T) / 343", bare(study)),
    "dry": Method("Cramer 1993, dry air", bare(cramer, damp=0.0)),
    "half": Method("Cramer 1993, 50 % humidity", bare(cramer, damp=0.5)),
    "cramer": Method("Cramer 1993, measured humidity", bare(cramer)),
    "zeroed": Method("Cramer, zero at one mark", zeroed),
    "study_line": Method("study's formula, line through all marks", lined(study)),
    "dry_line": Method("Cramer, dry air, line through all marks", lined(partial(cramer, damp=0.0))),
    "half_line": Method("Cramer, 50 % humidity, line through all marks", lined(partial(cramer, damp=0.5))),
    "line": Method("Cramer, line through all marks", lined(physics)),
    "calibrated": Method("`echocal.calibrate`: delay and clock", calibrated),
    "named": Method("named causes: `echocal.diagnose`", named()),
    "smooth": Method("named causes and smooth correction", named(smooth=True)),
    "both": Method("`calibrate`, then `diagnose`", named(calibrated=True)),
    "hybrid": Method("hybrid optimizer: global, then local", optimized(globally=True)),
    "local": Method("its local search alone", optimized(globally=False)),
}
