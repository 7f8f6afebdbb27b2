"""One drawn device: trained in spring or in a room, judged elsewhere; errors of every configuration."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
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
TESTED = {"nominal": "a room at 20 °C", "spring": "another week in spring"}
TESTED |= {"summer": "summer", "winter": "winter"}
BANDS = {"all": (0.2, 4.0), "to_1_m": (0.2, 1.0), "to_2_m": (1.0, 2.0), "to_4_m": (2.0, 4.0)}
LIMIT = 3.0  # mm: the data sheet of the HC-SR04
BEST = "shield"
NOTHING = "no effect"
ALL: dict[str, Method] = METHODS | LEARNERS
_FALSE = 300.0  # us, 5 cm: more than ten cycles of the echo
SHORT = ("fixed", "cramer", "zeroed", "line", "named")
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
    """Draw a device, its training and its tests: replicates of one seed, with air and noise of their own."""
    random, unit = partial(Random, seed), world.draw_unit(Random(seed)("unit"))
    if trained == "room":
        training = world.bench(unit, random(1))
    else:
        training = world.outdoors(trained, unit, random(2), 5.0, 6.0, _LEARNED)
    tested = {"nominal": world.nominal(unit, random(3), _REACH)}
    for number, season in enumerate(world.SEASONS, 4):
        tested[season] = world.outdoors(season, unit, random(number), 6.0, 3.0, _REACH)
    return Drawn(Device(unit, random(), training), training, tested, seed)


def settings() -> list[Setting]:
    """List what is compared."""
    return list(dict.fromkeys(_settings()))


def _settings() -> Iterator[Setting]:
    for name in THERMOMETERS:
        bare = ("fixed",) if name == "none" else ("cramer", "named", "boosting_left")
        yield from (Setting(name, method=method) for method in (*bare, "zeroed", "line"))
        yield Setting(name, oracle="detector")
    for trained in TRAINED:
        yield from (Setting(BEST, method=method, trained=trained) for method in ALL)
    for firmware in FIRMWARE:
        yield from (Setting(BEST, firmware, method) for method in SHORT)
    for firmware in ("capture", "whole_cm"):
        yield from (Setting(BEST, firmware, filter=name) for name in FILTERS)
    yield from (Setting(BEST, oracle=oracle) for oracle in ("air", "both"))
    for method in ("dry_line", "half_line", "study_line", "named"):
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
            log = without_false(_log(drawn, drawn.trained, one), drawn.trained)
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
                error = log["temperature_C"].to_numpy() - truth.around.temperature
                found.setdefault(name, {})[test] = float(np.nanmean(error**2))
    return found


def _log(drawn: Drawn, truth: Truth, one: Setting) -> pd.DataFrame:
    """Write a log; an oracle knows the air at the thermometer, or has a detector without time walk."""
    ideal = one.oracle in ("detector", "both")
    log = drawn.device.log(truth, one.thermometer, one.firmware, ideal=ideal)
    if one.oracle in ("air", "both"):
        around = truth.around
        return log.assign(temperature_C=around.temperature, humidity_percent=100 * around.relative_humidity)
    return log


def without_false(log: pd.DataFrame, truth: Truth) -> pd.DataFrame:
    """Leave out what nobody would learn from: readings that are far from the median of their burst."""
    echo = log["echo_us"]
    far = (echo - echo.groupby(truth.burst).transform("median")).abs() > _FALSE
    return log.assign(echo_us=echo.mask(far))


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
