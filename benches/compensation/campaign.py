"""One drawn device: trained in spring or in a room, judged elsewhere; errors of every configuration."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from compensation import world
from compensation.filters import FILTERS, made
from compensation.hardware import FIRMWARE, THERMOMETERS, Device
from compensation.learners import LEARNERS
from compensation.methods import METHODS, Correction, Method, diagnosed
from compensation.world import Column, Truth
from echocal.virtual_bench.campaign.campaign import Random

TRAINED = {"spring": "five days in spring, 20 placements", "room": "an evening in a room, 16 placements"}
TESTED = {
    "nominal": "a room at 20 °C",
    "spring": "another week in spring",
    "summer": "summer",
    "winter": "winter",
}
BANDS = {"all": (0.2, 4.0), "to_1_m": (0.2, 1.0), "to_2_m": (1.0, 2.0), "to_4_m": (2.0, 4.0)}
LIMIT = 3.0  # mm: the data sheet of the HC-SR04
BEST = "shield"
NOTHING = "no effect"
ALL: dict[str, Method] = METHODS | LEARNERS
_DAYS = 6.0
_SHORT = ("fixed", "cramer", "zeroed", "line", "named")
_REACH, _LEARNED = (0.2, 1.0, 2.0, 4.0), (0.3, 1.0, 2.0, 3.5)
Record = dict[str, Any]


@dataclass(frozen=True)
class Drawn:
    """A device, and all campaigns in which it is."""

    device: Device
    trained: Truth
    tested: dict[str, Truth]
    seed: int


@dataclass(frozen=True)
class Setting:
    """One configuration: what is bought, what runs on the board, how it is compensated, and an oracle."""

    thermometer: str
    firmware: str = "capture"
    method: str = "line"
    trained: str = "spring"
    filter: str = "median"
    oracle: str = ""

    @property
    def key(self) -> str:
        """Return its name in the results."""
        return "/".join(v for v in vars(self).values() if v)


def draw(seed: int, trained: str) -> Drawn:
    """Draw a device, its training and its tests."""
    random = Random(seed)
    unit = world.draw_unit(random("unit"))
    if trained == "room":
        first = world.bench("bench", unit, random)
    else:
        first = world.outdoors("training", world.SEASONS[trained], unit, random, 5.0, 6.0, _LEARNED)
    tested = {"nominal": world.nominal("nominal", unit, random, _REACH)}
    for name, season in world.SEASONS.items():
        tested[name] = world.outdoors(name, season, unit, random, _DAYS, 3.0, _REACH)
    return Drawn(Device(unit, random, first), first, tested, seed)


def settings() -> list[Setting]:
    """List what is compared."""
    return list(dict.fromkeys(_settings()))


def _settings() -> Iterator[Setting]:
    for name, own in THERMOMETERS.items():
        bare = ("fixed",) if own.kind == "none" else ("study", "cramer", "named", "boosting_left")
        yield from (Setting(name, method=method) for method in (*bare, "zeroed", "line"))
    for trained in TRAINED:
        yield from (Setting(BEST, method=method, trained=trained) for method in ALL)
    for firmware in FIRMWARE:
        yield from (Setting(BEST, firmware, method) for method in _SHORT)
    for firmware in ("capture", "whole_cm"):
        yield from (Setting(BEST, firmware, filter=name) for name in FILTERS)
    for oracle in ("air", "detector", "both"):
        yield from (Setting(BEST, method=method, oracle=oracle) for method in ("zeroed", "line"))
    yield from (Setting(name, oracle="detector") for name in THERMOMETERS)
    for method in ("dry_line", "half_line", "study_line", "named", "both"):
        yield Setting(BEST, method=method, oracle="detector")


def run(drawn: Drawn, chosen: list[Setting]) -> tuple[Record, Record]:
    """Compute the errors of configurations in all tests, and list the causes that were named."""
    found: Record = {}
    causes: Record = {}
    learned: dict[str, tuple[Correction, pd.DataFrame]] = {}
    order = sorted(chosen, key=lambda one: (one.oracle, one.thermometer, one.firmware, one.method))
    for one in order:
        bare = Setting(one.thermometer, one.firmware, one.method, one.trained, oracle=one.oracle).key
        if bare not in learned:
            log = _log(drawn, drawn.trained, one)
            learned = {bare: (ALL[one.method].learn(log, drawn.seed), log)}
        correct, log = learned[bare]
        shaped = made(one.filter, lambda correct=correct, log=log: correct(log), drawn.trained)  # type: ignore[misc]
        found[one.key] = {
            name: figures(shaped(correct(_log(drawn, truth, one)), truth.seconds), truth)
            for name, truth in drawn.tested.items()
        }
        if one.method in ("named", "both"):
            model = diagnosed(log, drawn.seed, calibrated=one.method == "both").model
            causes[one.key] = sorted(model.transferable().effects)
    return found, causes


def warmth(drawn: Drawn) -> Record:
    """Compute the RMS error of each thermometer in each test [K]."""
    found: Record = {}
    for name in THERMOMETERS:
        for test, truth in drawn.tested.items():
            log = drawn.device.log(truth, name)
            if "temperature_C" in log:
                error = log["temperature_C"].to_numpy() - truth.temperature
                found.setdefault(name, {})[test] = float(np.nanmean(error**2))
    return found


def _log(drawn: Drawn, truth: Truth, one: Setting) -> pd.DataFrame:
    """Write a log; an oracle knows the air at the thermometer, or has a detector without time walk."""
    ideal = one.oracle in ("detector", "both")
    log = drawn.device.log(truth, one.thermometer, one.firmware, ideal=ideal)
    if one.oracle in ("air", "both"):
        return log.assign(temperature_C=truth.temperature, humidity_percent=100 * truth.humidity)
    return log


def figures(corrected: Column, truth: Truth) -> Record:
    """Errors of a value for each burst: mean square [mm2], 95 % quantile [mm], share within 3 mm, missing."""
    true = truth.distance[:: world.EACH]
    error = 1e3 * np.abs(corrected - true)
    groups = {name: (true >= low) & (true <= high) for name, (low, high) in BANDS.items()}
    placement = truth.placement[:: world.EACH]
    groups["settled"] = np.concatenate([[False, False], placement[2:] == placement[:-2]])
    return {name: _figures(error[own]) for name, own in groups.items()}


def _figures(error: Column) -> Record:
    known = error[np.isfinite(error)]
    return {
        "mean_square": float(np.mean(known**2)),
        "high": float(np.quantile(known, 0.95)),
        "within": float(np.mean(known <= LIMIT)),
        "missing": 1 - len(known) / len(error),
    }
