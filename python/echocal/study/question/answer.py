"""The answer to the question, from the readings of the board, Table 2 and the class that is diagnosed."""

import warnings
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.diagnose import Cause, Diagnosis, diagnose
from echocal.registry import find_effect
from echocal.study import origin
from echocal.study.origin import SHOWN, reading_in, table_law
from echocal.study.question.explanations import (
    LIMIT,
    Explanation,
    Pattern,
    Verdict,
    compare,
    deviation,
    explain,
    pattern_of,
    without_steps,
)
from echocal.study.question.investigation import NEAR, Investigation, Readings
from echocal.study.question.laws import ALL
from echocal.study.question.measurements import Effects, Outcome, judge
from echocal.study.question.suspects import Suspect
from echocal.study.tables import DISTANCE, READING_SPEED, Tables

_ODD = 6.0  # degC: the row whose reading is that of 4 degC
_UNTOUCHED = "pulse_in"


@dataclass(frozen=True)
class _Possible:
    """Sizes that a cause can have in this experiment, as (low, high), and why."""

    range: tuple[float, float] | None
    why: str


_POSSIBLE = {
    "interrupt_loss": _Possible(
        (0.00578, 0.00590), "the board's pulseIn() loses 0.584 % (0.578 to 0.590 %), whatever the sketch does"
    ),
    "clock_error": _Possible(
        None, "a simulated clock is exact; the resonator of a real UNO may be 0.5 % off"
    ),
    "fixed_delay": _Possible((0.0, 1.0), "a latency lengthens the echo"),
    "gas_composition": _Possible(None, "Tinkercad has no air"),
    "temperature_gradient": _Possible(None, "Tinkercad has no air"),
    "oblique_target": _Possible(None, "the target in Tinkercad has no angle"),
    "amplitude_walk": _Possible(None, "Tinkercad's module has no comparator"),
    "receiver_recovery": _Possible(None, "Tinkercad's module has no comparator"),
    "reference_scale": _Possible((-0.005, 0.005), "the target is placed by mouse: 2 m may be 10 mm off"),
    "zero_error": _Possible((-0.010, 0.010), "the target is placed by mouse: 2 m may be 10 mm off"),
    "speed_intercept": _Possible((-0.5, 0.7), "programs use 330.8 to 332 m/s at 0 degC"),
    "temperature_offset": _Possible((-1.0, 1.0), "the potentiometer is set to about 1 degC"),
}

_TRUE = {
    "pulse_in": ("interrupt_loss",),
    "target": ("zero_error",),
    "module_factor": ("clock_error", "reference_scale", "interrupt_loss"),
    "law_332": ("speed_intercept",),
    "latency": ("fixed_delay", "zero_error"),  # the program divides it by its speed
}
"""Causes of the catalogue that a suspect is."""


@dataclass(frozen=True)
class Member:
    """One cause of the class."""

    id: str
    parameter: str
    size: str  # fitted size with its standard uncertainty and unit
    verdict: str  # ``remains``, or ``sign``, ``size`` or ``absent``; empty if this cause is not judged here
    why: str


@dataclass(frozen=True)
class Told:
    """What the diagnosis says of a table of the board."""

    suspect: str
    # one_distance, two_distances: causes of the first class, from readings at 2 m alone and with a second
    # distance
    one_distance: tuple[str, ...]
    two_distances: tuple[str, ...]
    right: tuple[bool, bool]  # whether the true cause is among them


def diagnosis_of(tables: Tables) -> Diagnosis:
    """Diagnose the Tinkercad column against the law of the study's tables."""
    table = tables.table2
    return _diagnosed(
        table_law(tables),
        table.temperature,
        table.values("measured_distance_tinkercad_m"),
        np.full(len(table), DISTANCE),
    )


def members(tables: Tables, diagnosis: Diagnosis) -> list[Member]:
    """Judge each cause of the first class by the sign and the size that the table needs.

    In alphabetical order; the diagnosis is that of the Tinkercad column.
    """
    return [_judged(tables, id_) for id_ in _class_of(diagnosis)]


def told(tables: Tables, found: Investigation) -> list[Told]:
    """Diagnose what the board made of some suspects, at one distance and at two."""
    law, temperature = table_law(tables), found.temperature
    answers = []
    for name, (far, near) in found.told.items():
        reading = np.concatenate([far.reading.ravel(), near.reading.ravel()])
        distance = np.repeat([DISTANCE, NEAR], [far.reading.size, near.reading.size])
        warm = np.tile(temperature, len(far.reading) + len(near.reading))
        count = far.reading.size
        first = _class_of(_diagnosed(law, warm[:count], reading[:count], distance[:count]))
        second = _class_of(_diagnosed(law, warm, reading, distance))
        right = tuple(not set(_TRUE[name]).isdisjoint(one) for one in (first, second))
        answers.append(Told(name, first, second, (right[0], right[1])))
    return answers


def _diagnosed(law: str, temperature: np.ndarray, reading: np.ndarray, distance: np.ndarray) -> Diagnosis:
    columns = {"temperature_C": temperature, "reading_m": reading, "distance_m": distance}
    with warnings.catch_warnings(action="ignore"):  # among the notes
        return diagnose(columns, base=law, reading_speed=READING_SPEED)


def _class_of(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the most probable effect and what cannot be told from it, in alphabetical order."""
    effects = [cause for cause in diagnosis.causes if cause.kind == "effect"]
    if not effects:
        return ()
    first: Cause = max(effects, key=lambda cause: cause.probability)
    return tuple(sorted((first.id, *first.indistinguishable_from)))


def _judged(tables: Tables, id_: str) -> Member:
    name = next(one.name for one in find_effect(id_).parameters if one.role == "size")
    estimate = origin.explain(tables, [f"{id_}.{name}"])[f"{id_}.{name}"]
    factor, unit = SHOWN.get(estimate.unit, (1.0, estimate.unit))
    size = f"{estimate.value * factor:.2f} ± {estimate.standard_uncertainty * factor:.2f} {unit}"
    if id_ not in _POSSIBLE:
        return Member(id_, name, size, "", "not judged")
    possible = _POSSIBLE[id_]
    if possible.range is None:
        return Member(id_, name, size, "absent", possible.why)
    low, high = possible.range
    beyond = max(low - estimate.value, estimate.value - high) / estimate.standard_uncertainty
    verdict = "remains" if beyond <= LIMIT else "sign" if _other_way(estimate.value, low, high) else "size"
    return Member(id_, name, size, verdict, possible.why)


def _other_way(value: float, low: float, high: float) -> bool:
    return (value < 0.0 <= low) or (value > 0.0 >= high)


@dataclass(frozen=True)
class Made:
    """What a suspect makes."""

    suspect: Suspect
    pattern: Pattern
    """Of the mean over its tables."""
    scatter: tuple[float, float, float]
    """Lowest, median and highest scatter of its tables [mm]."""
    verdict: Verdict
    smooth: Column
    """Readings less the calculation, without rounding and without what differs in each run [mm]; shape
    (n,)."""


@dataclass(frozen=True)
class Answer:
    """Everything on the page."""

    tables: Tables
    wanted: Pattern  # of the Tinkercad column
    without_odd: Pattern  # the same without the row at 6 degC
    parts: tuple[float, float]  # standard deviations of the first seven rows and of the others [mm]
    made: list[Made]
    explanations: list[Explanation]
    explanations_without_odd: list[Explanation]
    effects: Effects
    outcomes: list[Outcome]
    diagnosis: Diagnosis
    members: list[Member]
    told: list[Told]

    def of(self, suspect: str) -> Made:
        """Return what a suspect makes."""
        return {one.suspect.id: one for one in self.made}[suspect]


def answer(found: Investigation, tables: Tables | None = None) -> Answer:
    """Compare what the board measured with Table 2, and ask the diagnosis."""
    tables = tables or Tables.load()
    table = tables.table2
    printed, left, warm = table.values("measured_distance_tinkercad_m"), deviation(table), table.temperature
    used = warm != _ODD
    wanted = pattern_of(warm, left, printed)
    made = [_made(tables, one, found.far[one.id]) for one in ALL]
    effects = _effects(tables, found, made, wanted)
    explanations = explain(table, ALL, found.far)
    diagnosis = diagnosis_of(tables)
    return Answer(
        tables,
        wanted,
        pattern_of(warm[used], left[used], printed[used]),
        (float(left[:7].std(ddof=1)), float(left[7:].std(ddof=1))),
        made,
        explanations,
        explain(table, ALL, found.far, without=(_ODD,)),
        effects,
        judge(explanations, effects),
        diagnosis,
        members(tables, diagnosis),
        told(tables, found),
    )


def _made(tables: Tables, suspect: Suspect, readings: Readings) -> Made:
    table = tables.table2
    away, warm = deviation(table, readings.reading), table.temperature
    each = [pattern_of(warm, one, own).scatter for one, own in zip(away, readings.reading, strict=True)]
    scatter = (min(each), float(np.median(each)), max(each))
    mean = pattern_of(warm, away.mean(axis=0), readings.reading[0])
    smooth = without_steps(table, suspect, readings)
    return Made(suspect, mean, scatter, compare(table, suspect, readings), smooth)


def _effects(tables: Tables, found: Investigation, made: list[Made], wanted: Pattern) -> Effects:
    """Means at both distances; of a free suspect per unit of its size."""
    expected = reading_in(table_law(tables), found.temperature) * NEAR / 2.0
    unit = {one.suspect.id: one.suspect.free.staged if one.suspect.free else 1.0 for one in made}
    far = {one.suspect.id: one.pattern.mean / unit[one.suspect.id] for one in made}
    near = {
        name: float((own.reading - expected).mean()) * 1e3 / unit[name] for name, own in found.near.items()
    }
    untouched = next(one for one in made if one.suspect.id == _UNTOUCHED)
    return Effects(far, near, wanted, untouched.scatter[1])
