"""Suspects alone and in pairs: how well each explains the Tinkercad column, row by row."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from echocal.study.question.comparison import unrounded, without_steps
from echocal.study.question.experiment import Readings
from echocal.study.question.suspects import Suspect
from echocal.study.tables import Table

__all__ = ["Explanation", "explain", "involved"]

Column = NDArray[np.float64]

_GRID = 201  # sizes that are tried over a range; their posterior is some 10 of them wide
_SCATTERS = "setting"  # place of what scatters the rows and moves them in no direction
_NONE = "none"


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
    equally probable beforehand, and so are all explanations of the same number.

    Parameters
    ----------
    table : Table
        Table 2.
    readings : mapping of str to Readings
        What the board made of each.
    without : sequence of float
        Temperatures of rows that are left out [degC].

    Returns
    -------
    list of Explanation
        The most probable first.
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
