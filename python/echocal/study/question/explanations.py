"""What a suspect makes of the readings beside Table 2, and how well suspects and pairs explain it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import logsumexp

from echocal.arrays import Column
from echocal.study.question.investigation import Readings
from echocal.study.question.suspects import Suspect
from echocal.study.tables import Table

_GRID = 201  # sizes that are tried over a range; their posterior is some 10 of them wide
_SCATTERS = "setting"  # place of what scatters the rows and moves them in no direction
_NONE = "none"
LIMIT = 3.0
"""Standard errors beyond which a suspect is excluded."""

_STEPS = (10, 5, 2)  # mm, of readings that are whole centimeters, half centimeters, ...
_SMOOTH = 2  # degree of the curve of a suspect: a straight line, and the bend of a law
_SAME_SIZE = 0.5  # mm: a suspect that moves the readings by less moves them in no direction


@dataclass(frozen=True)
class Explanation:
    """One suspect, a pair, or none."""

    suspects: tuple[Suspect, ...]
    probability: float  # posterior probability among all explanations
    left: float  # root mean square of what it leaves of the deviations, with the best sizes [mm]
    # sizes, size_errors: posterior mean and standard deviation of the free sizes, by suspect
    sizes: dict[str, float]
    size_errors: dict[str, float]

    @property
    def name(self) -> str:
        """Names of the suspects."""
        return " + ".join(one.id for one in self.suspects) or "nothing"


def explain(
    table: Table, suspects: Sequence[Suspect], readings: Mapping[str, Readings], without: Sequence[float] = ()
) -> list[Explanation]:
    """Weigh every suspect and every pair from different places.

    The deviations of a table scatter normally about the curves of the suspects. The standard deviation is
    not known (prior 1/sigma), and a free size is uniform in its range. One suspect and two suspects are
    equally probable beforehand, and so are all explanations of the same number. `table` is Table 2, and
    `without` has the temperatures of rows that are left out [degC]. The most probable explanation is the
    first.
    """
    used = ~np.isin(table.temperature, without)
    wanted = 1e3 * (table.values("measured_distance_tinkercad_m") - unrounded(table))[used]
    able = [one for one in suspects if one.place not in (_SCATTERS, _NONE) and not one.absent]
    curves = {one.id: without_steps(table, one, readings[one.id])[used] for one in able}
    groups: list[list[tuple[Suspect, ...]]] = [
        [()],
        [(one,) for one in able],
        [pair for pair in combinations(able, 2) if pair[0].place != pair[1].place],
    ]
    found = [(own, *_weigh(wanted, own, curves)) for group in groups for own in group]
    beforehand = np.concatenate([np.full(len(group), -np.log(len(group))) for group in groups])
    evidence = np.array([one[1] for one in found]) + beforehand
    probability = np.exp(evidence - logsumexp(evidence))
    weighed = [
        Explanation(own, float(p), left, sizes, errors)
        for (own, _, left, sizes, errors), p in zip(found, probability, strict=True)
    ]
    return sorted(weighed, key=lambda one: -one.probability)


def involved(explanations: Sequence[Explanation]) -> dict[str, float]:
    """Probability that a suspect is part of the truth, the most probable first."""
    total: dict[str, float] = {}
    for explanation in explanations:
        for one in explanation.suspects:
            total[one.id] = total.get(one.id, 0.0) + explanation.probability
    return dict(sorted(total.items(), key=lambda item: -item[1]))


def _weigh(
    wanted: Column, own: tuple[Suspect, ...], curves: Mapping[str, Column]
) -> tuple[float, float, dict[str, float], dict[str, float]]:
    """Return log evidence, what is left [mm], and the free sizes with their standard deviations."""
    fixed = np.sum([np.zeros_like(wanted), *(curves[one.id] for one in own if one.free is None)], axis=0)
    free = [(one, one.free) for one in own if one.free is not None]
    axes = [np.linspace(size.low, size.high, _GRID) for _, size in free]
    units = [curves[one.id] / size.staged for one, size in free]
    squares = _squares(wanted - fixed, units, axes)
    log_likelihood = -0.5 * len(wanted) * np.log(squares)
    evidence = float(logsumexp(log_likelihood) - np.log(squares.size))
    weight = np.exp(log_likelihood - logsumexp(log_likelihood))
    sizes, errors = {}, {}
    for place, ((one, _), axis) in enumerate(zip(free, axes, strict=True)):
        others = tuple(other for other in range(len(free)) if other != place)
        own_weight = weight.sum(axis=others)
        mean = float(own_weight @ axis)
        sizes[one.id], errors[one.id] = mean, float(np.sqrt(own_weight @ (axis - mean) ** 2))
    return evidence, float(np.sqrt(squares.min() / len(wanted))), sizes, errors


def _squares(rest: Column, units: Sequence[Column], axes: Sequence[Column]) -> Column:
    """Sum of squares of what is left for every combination of sizes [mm2]."""
    total = np.asarray(rest @ rest)
    for place, (unit, axis) in enumerate(zip(units, axes, strict=True)):
        shape = [1] * len(axes)
        shape[place] = len(axis)
        size = axis.reshape(shape)
        total = total + size**2 * (unit @ unit) - 2.0 * size * (unit @ rest)
        for before in range(place):
            shape = [1] * len(axes)
            shape[before] = len(axes[before])
            total = total + 2.0 * size * axes[before].reshape(shape) * (unit @ units[before])
    return np.asarray(total)


@dataclass(frozen=True)
class Pattern:
    """What is left of readings less the calculation."""

    mean: float  # mean [mm]
    slope: float  # slope against the temperature [mm/K]
    scatter: float  # standard deviation about the line [mm]
    # mean_error, slope_error: standard errors of mean [mm] and slope [mm/K]
    mean_error: float
    slope_error: float
    step: int  # largest step [mm] of which all readings are multiples


@dataclass(frozen=True)
class Verdict:
    """Whether a suspect alone could have made the Tinkercad column."""

    excluded_by: tuple[str, ...]
    """Of ``sign``, ``size``, ``slope``, ``step``, ``absent``; empty if the suspect remains."""
    size: float | None = None  # size that the table needs, where it is free
    size_error: float | None = None  # its standard error

    @property
    def remains(self) -> bool:
        """Whether nothing excludes it."""
        return not self.excluded_by


def deviation(table: Table, reading: Column | None = None) -> Column:
    """Readings, by default Tinkercad's, less the calculation of Table 2 [mm], shape (n,) or (tables, n)."""
    told = table.values("measured_distance_tinkercad_m") if reading is None else reading
    return np.asarray((told - table.values("measured_distance_calculation_m")) * 1e3)


def pattern_of(temperature: Column, left: Column, reading: Column) -> Pattern:
    """Describe deviations [mm] and readings [m] of one table."""
    centered = temperature - temperature.mean()
    slope = float(centered @ left / (centered @ centered))
    rest = left - left.mean() - slope * centered
    scatter = float(np.sqrt(rest @ rest / (len(left) - 2)))
    step = next((one for one in _STEPS if not np.any(np.round(reading * 1e3) % one)), 1)
    mean_error = scatter / np.sqrt(len(left))
    return Pattern(
        float(left.mean()), slope, scatter, float(mean_error), scatter / float(np.linalg.norm(centered)), step
    )


def curve(table: Table, readings: Readings, size: float | None = None, staged: float | None = None) -> Column:
    """Deviation that a suspect makes [mm], mean over its tables, shape (n,); a free one in another size."""
    made = deviation(table, readings.reading).mean(axis=0)
    return np.asarray(made if size is None or staged is None else made * size / staged)


def unrounded(table: Table) -> Column:
    """Calculation of Table 2 before it was rounded to millimeters [m]: its speed is a straight line."""
    temperature, speed = table.temperature, 1.0 / table.values("measured_distance_calculation_m")
    return np.asarray(1.0 / np.polyval(np.polyfit(temperature, speed, 1), temperature))


def without_steps(table: Table, suspect: Suspect, readings: Readings) -> Column:
    """Deviation that a suspect makes, without what only this run of the board has [mm], shape (n,).

    Where the count begins and how a reading is rounded differ in each run. So a smooth curve through the rows
    stands for a suspect, unless the suspect itself cuts off.
    """
    away = (readings.reading.mean(axis=0) - unrounded(table)) * 1e3
    if suspect.cuts_off:
        return np.asarray(away)
    return np.asarray(np.polyval(np.polyfit(table.temperature, away, _SMOOTH), table.temperature))


def compare(table: Table, suspect: Suspect, readings: Readings) -> Verdict:
    """Judge a suspect by sign, size, slope and step."""
    temperature = table.temperature
    wanted = pattern_of(temperature, deviation(table), table.values("measured_distance_tinkercad_m"))
    made = curve(table, readings)
    if suspect.free is not None:
        return _sized(suspect, wanted, made)
    own = pattern_of(temperature, made, readings.reading[0])
    found = [_by_size(own.mean, wanted)]
    if abs(own.slope - wanted.slope) > LIMIT * wanted.slope_error:
        found.append("slope")
    if own.step > wanted.step:
        found.append("step")
    if suspect.absent:
        found.append("absent")
    return Verdict(tuple(one for one in found if one))


def _by_size(mean: float, wanted: Pattern) -> str:
    """Return ``sign`` or ``size`` if a mean [mm] cannot be that of the table."""
    if abs(mean - wanted.mean) <= LIMIT * wanted.mean_error:
        return ""
    return "sign" if mean * wanted.mean < 0.0 and abs(mean) > _SAME_SIZE else "size"


def _sized(suspect: Suspect, wanted: Pattern, made: Column) -> Verdict:
    free = suspect.free
    if free is None:
        raise ValueError("a suspect of a fixed size has none to find")
    unit = float(made.mean()) / free.staged  # mm for one unit of the size
    size, error = wanted.mean / unit, abs(wanted.mean_error / unit)
    inside = free.low - LIMIT * error <= size <= free.high + LIMIT * error
    wrong_way = (free.low >= 0.0 and size < 0.0) or (free.high <= 0.0 and size > 0.0)
    why = () if inside else ("sign",) if wrong_way else ("size",)
    return Verdict((*why, "absent") if suspect.absent else why, size, error)
