"""Which further measurement would have told the explanations apart."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.study.question.explanations import Explanation, Pattern
from echocal.study.question.suspects import Suspect

_READINGS = 10
_LABEL = 1.0  # mm: judgement, what a label or the coordinates of a drawing tell of the target
_DRAWS = 4000
_WEIGHED = 30  # explanations that are followed
_SEED = 0

_SEEN = ("timer", "module", "target")
"""Places whose effect is in the echo time that the program counts."""


@dataclass(frozen=True)
class Effects:
    """What is known of the suspects for the prediction of further measurements."""

    # far, near: mean deviation that a suspect makes at 2 m and at the second distance [mm]; of a free one,
    # per unit of its size
    far: Mapping[str, float]
    near: Mapping[str, float]
    table: Pattern  # Table 2
    jitter: float  # standard deviation of a reading when nothing is touched [mm]


Channel = Callable[[Suspect, float, Effects], float]
"""Value [mm] that a suspect of a size makes in one value of a measurement."""


@dataclass(frozen=True)
class Measurement:
    """A further measurement."""

    id: str
    title: str
    how: str  # what the person does
    channels: tuple[Channel, ...]  # values that it gives
    error: Callable[[Effects], float]  # standard error of each value [mm]
    replaced: bool = False  # whether the target is placed anew, so that its offset is another one


@dataclass(frozen=True)
class Outcome:
    """What a measurement is worth."""

    measurement: Measurement
    expected_probability: float  # expected posterior probability of what is true, after the measurement


def _at(place: Sequence[str], factor: float = 1.0) -> Channel:
    def channel(suspect: Suspect, size: float, effects: Effects) -> float:
        return factor * size * effects.far[suspect.id] if suspect.place in place else 0.0

    return channel


def _held(suspect: Suspect, size: float, effects: Effects) -> float:
    """Change of the reading when interrupts are held: what pulseIn() had lost comes back."""
    disturbed = suspect.place == "timer" and suspect.free is None
    return -effects.far[suspect.id] if disturbed else 0.0


def _nearer(suspect: Suspect, size: float, effects: Effects) -> float:
    return size * effects.near[suspect.id]


def _scatter(effects: Effects) -> float:
    return effects.table.scatter / float(np.sqrt(_READINGS))


def _jitter(effects: Effects) -> float:
    return effects.jitter / float(np.sqrt(_READINGS))


def _twice(effects: Effects) -> float:
    return float(np.sqrt(2.0)) * _jitter(effects)


MEASUREMENTS = (
    Measurement(
        "second_distance",
        "a second distance",
        f"Drag the target to 0.5 m and take {_READINGS} readings.",
        (_nearer,),
        _scatter,
        replaced=True,
    ),
    Measurement(
        "label",
        "the place of the target",
        f"Write down where the target truly is, to {_LABEL:g} mm.",
        (_at(("target",)),),
        lambda effects: _LABEL,
    ),
    Measurement(
        "interrupts_held",
        "interrupts held",
        "Touch nothing, put noInterrupts() before pulseIn() and interrupts() behind it: "
        f"{_READINGS} readings with and without.",
        (_held,),
        _twice,
    ),
    Measurement(
        "microseconds",
        "the counted time",
        f"Print `duration` beside the reading, {_READINGS} times.",
        (_at(_SEEN),),
        _jitter,
    ),
    Measurement(
        "steps",
        "every step of the program",
        "Print `duration`, the distance, the temperature and the speed beside the reading, "
        f"{_READINGS} times.",
        (_at(_SEEN), _at(("conversion",)), _at(("thermometer", "record")), _at(("law",))),
        _jitter,
    ),
    Measurement(
        "steps_and_interrupts",
        "every step of the program, with interrupts held and without",
        "Both of these.",
        (_at(_SEEN), _at(("conversion",)), _at(("thermometer", "record")), _at(("law",)), _held),
        _twice,
    ),
)
"""Measurements, as a person in front of Tinkercad could take them."""


def separation(measurement: Measurement, pair: tuple[Explanation, Explanation], effects: Effects) -> float:
    """Distance between what two explanations predict, in standard deviations of the difference."""
    (first, one), (second, other) = (_predicted(measurement, own, effects) for own in pair)
    covariance = one + other + np.eye(len(first)) * measurement.error(effects) ** 2
    away = first - second
    return float(np.sqrt(away @ np.linalg.solve(covariance, away)))


def judge(explanations: Sequence[Explanation], effects: Effects) -> list[Outcome]:
    """Rank the measurements by how well they would tell what is true.

    The most probable explanation comes first, and so does the best measurement.
    """
    followed = explanations[:_WEIGHED]
    weight = np.array([one.probability for one in followed])
    weight = weight / weight.sum()
    found = [Outcome(one, _expected(one, followed, weight, effects)) for one in MEASUREMENTS]
    return sorted(found, key=lambda one: -one.expected_probability)


def _predicted(measurement: Measurement, explanation: Explanation, effects: Effects) -> tuple[Column, Column]:
    """Return mean and covariance of the values [mm], [mm2]."""
    mean = np.zeros(len(measurement.channels))
    covariance = np.zeros((len(mean), len(mean)))
    for one in explanation.suspects:
        size, error = explanation.sizes.get(one.id, 1.0), explanation.size_errors.get(one.id, 0.0)
        if measurement.replaced and one.place == "target" and one.free is not None:
            size, error = 0.0, (one.free.high - one.free.low) / float(np.sqrt(12.0))
        unit = np.array([channel(one, 1.0, effects) for channel in measurement.channels])
        mean += unit * size
        covariance += np.outer(unit, unit) * error**2
    return mean, covariance


def _expected(
    measurement: Measurement, explanations: Sequence[Explanation], weight: Column, effects: Effects
) -> float:
    random = np.random.default_rng(_SEED)
    error = measurement.error(effects) ** 2
    predicted = [_predicted(measurement, own, effects) for own in explanations]
    noisy = [(mean, covariance + np.eye(len(mean)) * error) for mean, covariance in predicted]
    true = random.choice(len(explanations), _DRAWS, p=weight)
    drawn = np.array([random.multivariate_normal(*noisy[place]) for place in true])
    log_density = np.array([_log_normal(drawn, *own) for own in noisy]) + np.log(weight)[:, None]
    after = np.exp(log_density - np.logaddexp.reduce(log_density, axis=0))
    return float(after[true, np.arange(_DRAWS)].mean())


def _log_normal(values: Column, mean: Column, covariance: Column) -> Column:
    away = values - mean
    distance = np.einsum("ij,ij->i", away, np.linalg.solve(covariance, away.T).T)
    return np.asarray(-0.5 * (distance + np.linalg.slogdet(covariance)[1]))
