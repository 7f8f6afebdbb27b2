"""The answer to the question: what is computed from the readings of the board, and from Table 2."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose import Diagnosis
from echocal.study.origin import reading_in, table_law
from echocal.study.question.comparison import Pattern, Verdict, compare, deviation, pattern_of, without_steps
from echocal.study.question.experiment import Readings
from echocal.study.question.explanations import Explanation, explain
from echocal.study.question.investigation import NEAR, Investigation
from echocal.study.question.laws import ALL
from echocal.study.question.measurements import Effects, Outcome, judge
from echocal.study.question.members import Member, Told, diagnosis_of, members, told
from echocal.study.question.suspects import Suspect
from echocal.study.tables import Tables

__all__ = ["Answer", "Made", "answer"]

Column = NDArray[np.float64]

_ODD = 6.0  # degC: the row whose reading is that of 4 degC
_UNTOUCHED = "pulse_in"


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
    """Compare what the board measured with Table 2, and ask the diagnosis.

    Parameters
    ----------
    tables : Tables, optional
        Other tables than those that the package ships.
    """
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
