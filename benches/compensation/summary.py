"""From the errors of each device to the figures of the page: means, intervals, wins, named causes."""

from collections import Counter

import numpy as np

from compensation import campaign
from compensation.campaign import Record, Setting

_RESAMPLED = 4000
_BASELINE = Setting(campaign.BEST, method="line").key
_FITTED = {"fixed_delay", "clock_error"}  # by `calibrate`, before the diagnosis
Answer = tuple[int, Record, Record, Record]


def summarize(found: list[Answer]) -> Record:
    """Means over devices with bootstrap intervals, wins against a line through all marks, named causes."""
    devices: dict[int, Record] = {}
    causes: dict[str, Counter[str]] = {}
    warmth = list({seed: warm for seed, *_, warm in found if warm}.values())
    for seed, record, named, _ in found:
        devices.setdefault(seed, {}).update(record)
        for key, effects in named.items():
            added = set(effects) - (_FITTED if "/both/" in key else set())
            causes.setdefault(key, Counter()).update(added or [campaign.NOTHING])
    runs = [devices[seed] for seed in sorted(devices)]
    keys = sorted(runs[0])
    return {
        "devices": len(runs),
        "figures": {key: _figures([run[key] for run in runs]) for key in keys},
        "wins": {key: sum(_elsewhere(run[key]) < _elsewhere(run[_BASELINE]) for run in runs) for key in keys},
        "each": {key: sorted(short(_elsewhere(run[key])) for run in runs) for key in keys},
        "causes": {key: dict(sorted(causes[key].items())) for key in sorted(causes)},
        "kelvin": {
            name: {test: short(np.mean([one[name][test] for one in warmth]) ** 0.5) for test in own}
            for name, own in warmth[0].items()
        },
    }


def short(number: float) -> float:
    """Round to four digits."""
    return float(f"{number:.4g}")


def _elsewhere(run: Record) -> float:
    """RMS in other weather [mm]."""
    return float((run["summer"]["all"]["mean_square"] + run["winter"]["all"]["mean_square"]) / 2) ** 0.5


def _figures(runs: list[Record]) -> Record:
    """Figures of a configuration in each test, and in summer and winter together."""
    tests = {name: [run[name] for run in runs] for name in campaign.TESTED}
    tests["other"] = [_both(run["summer"], run["winter"]) for run in runs]
    return {name: _bands(own) for name, own in tests.items()}


def _both(one: Record, other: Record) -> Record:
    return {band: {name: (one[band][name] + other[band][name]) / 2 for name in one[band]} for band in one}


def _bands(runs: list[Record]) -> Record:
    """RMS [mm] and 95 % quantile [mm] with intervals of 95 %; shares, also of each band."""

    def each(band: str, name: str) -> list[float]:
        return [run[band][name] for run in runs]

    found: Record = {band: {"within": short(np.mean(each(band, "within")))} for band in runs[0]}
    found["settled"] = {"rms": _interval(each("settled", "mean_square"), 0.5)}
    found["all"]["missing"] = short(np.mean(each("all", "missing")))
    found["all"]["rms"] = _interval(each("all", "mean_square"), 0.5)
    found["all"]["high"] = _interval(each("all", "high"), 1.0)
    return found


def _interval(values: list[float], power: float) -> list[float]:
    """Mean and its interval over the devices, both raised to a power: a root for mean squares."""
    own = np.array(values)
    rows = np.random.default_rng(0).integers(0, len(own), (_RESAMPLED, len(own)))
    drawn = np.quantile(own[rows].mean(axis=1), [0.025, 0.975])
    return [short(number**power) for number in (own.mean(), *drawn)]
