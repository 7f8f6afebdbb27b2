"""Which causes a table of the bench cannot tell apart: cosines of finite differences made on the bench."""

from collections.abc import Callable

import numpy as np

from echocal.virtual_bench import CAUSES, Simulation, air
from hidden_effects.aliases import EITHER_SIGN, SAME_DIRECTION, label
from hidden_effects.bench.truth import FAULTS, NOISES, UNFORESEEN, companions, names
from hidden_effects.bench.world import Case, Column, bare, error, signal_of

_NOT_SHAPES = NOISES | FAULTS | UNFORESEEN | {"fixed_speed", "divisor", "round_trip_factor"}
_EITHER_SIGN = EITHER_SIGN | {"reference_scale", "gas_composition", "temperature_self_heating"}
_OTHER_NAMES = {"wind_along": "wind", "wind_across": "wind"}
_ITS_SIZE = 2.0  # with what noise adds to it, it is not larger
_SPEED = 343.0  # m/s, of changes that are small beside it


def _faster(made: Simulation, change: Column | float) -> Column:
    """What a faster sound makes of a reading [m]."""
    return np.asarray(-made.campaign.distance * change / _SPEED)


def _speed(made: Simulation, humidity: Column | float | None = None, frequency: float = 0.0) -> Column:
    """Speed of sound, of the front of an echo where a frequency is given [m/s]."""
    around = made.campaign.around
    wet = around.relative_humidity if humidity is None else humidity
    return air.speed_of_sound(around.temperature, wet, around.pressure, 4e-4, frequency, group=frequency > 0)


def _spaced(made: Simulation) -> Column:
    return np.hypot(made.campaign.distance, 0.5 * made.campaign.sensor.spacing) - made.campaign.distance


UNSTAGED: dict[str, Callable[[Simulation], Column]] = {
    "speed_intercept": lambda made: _faster(made, 1.0),
    "speed_slope": lambda made: _faster(made, 0.02 * made.campaign.around.temperature),
    "dispersion": lambda made: _faster(made, _speed(made, frequency=40e3) - _speed(made)),
    "humidity": lambda made: _faster(made, _speed(made) - _speed(made, 0.0)),
    "unrecorded_humidity": lambda made: _faster(made, _speed(made, 0.5) - _speed(made, 0.0)),
    "thermal_expansion": lambda made: np.asarray(1e-4 * (made.campaign.around.temperature - 20.0)),
    "transducer_spacing": _spaced,
}
"""Influence [m] of names that the engine can say and the bench does not stage, by the laws of the bench."""

_ONE_SIGN = frozenset({"dispersion", "humidity", "unrecorded_humidity", "transducer_spacing"})


def usual(id_: str) -> float:
    """A usual size of a cause, positive where it can be."""
    low, high = CAUSES[id_].low, CAUSES[id_].high
    size = high / 2 if low < 0 else float(np.sqrt(low * high))
    return float(round(size)) if CAUSES[id_].whole else size


def influence(case: Case, id_: str) -> Column | None:
    """What a cause would add to the readings of a case [m], at a usual size; None where nobody can tell."""
    id_ = _OTHER_NAMES.get(id_, id_)
    if id_ in UNSTAGED:
        return UNSTAGED[id_](case.without)
    if id_ in _NOT_SHAPES or id_ not in CAUSES:
        return None
    spec = case.spec
    try:
        staged = bare(spec, _detector(case), {id_: usual(id_)})
    except ValueError:  # the design has not what the cause needs
        return None
    return error(staged) - error(bare(spec, "ideal" if id_ == "amplitude_walk" else staged.detector))


def _detector(case: Case) -> str:
    """The ideal one where the planted causes do not bring a comparator: its noise only blurs a direction."""
    forced = any(bare(case.spec, "ideal", {id_: usual(id_)}).detector != "ideal" for id_ in case.spec.causes)
    return case.made.detector if forced else "ideal"


def direction(case: Case, truth: str) -> Column:
    """What a planted cause adds, as cleanly as the bench can tell."""
    if _detector(case) == case.spec.detector:
        return signal_of(case, truth)
    staged = bare(case.spec, "ideal", {truth: case.spec.sizes[truth]})
    return error(staged) - error(bare(case.spec, "ideal"))


def cosine(case: Case, one: Column, other: Column) -> float:
    """Cosine between two influences over rows that have both; 0 where one of them is nothing."""
    seen = np.isfinite(one) & np.isfinite(other)
    one, other = one[seen], other[seen]
    if "distance_m" not in case.made.table and len(one):
        one, other = one - one.mean(), other - other.mean()
    size = float(np.sqrt(np.sum(one**2) * np.sum(other**2)))
    return float(np.sum(one * other)) / size if size > 0 else 0.0


def same_class(case: Case, truth: str, named: str) -> bool:
    """Whether a name is that of a planted cause, or of one that these rows see in the same direction."""
    if named in names(truth) or label(named) == label(truth):
        return True
    if truth in _NOT_SHAPES or named in _NOT_SHAPES:
        return False
    other = influence(case, named)
    if other is None:
        return False
    found = cosine(case, direction(case, truth), other)
    return (found if _one_sign(named) else abs(found)) >= SAME_DIRECTION


def _one_sign(named: str) -> bool:
    staged = CAUSES.get(_OTHER_NAMES.get(named, named))
    positive = staged is not None and staged.low >= 0
    return (positive or named in _ONE_SIGN) and named not in _EITHER_SIGN


def accompanies(case: Case, named: str, claimed: Column | None = None) -> bool:
    """Whether a name is of what is always there, or acts like it.

    Like the constant delay of a comparator at any size. Like the scale that every table has only at about its
    size: half a percent is neither what makes a burst of 40 kHz faster by 0.05 %, nor the tilt of a target
    that stands as well as a hand puts it. `claimed` is what the name takes away [m].
    """
    if named in companions(case):
        return True
    other = None if named in _NOT_SHAPES else influence(case, named)
    if other is None:
        return False
    delay = influence(case, "fixed_delay") if case.made.detector == "comparator" else None
    if delay is not None and abs(cosine(case, delay, other)) >= SAME_DIRECTION:
        return True
    faster = UNSTAGED["dispersion"](case.without)
    alike = abs(cosine(case, faster, other)) >= SAME_DIRECTION
    return alike and (claimed is None or _rms(claimed) < _ITS_SIZE * _rms(_scale(case, faster)))


def _scale(case: Case, faster: Column) -> Column:
    """What dispersion and the tilt of the targets add to a reading [m]."""
    made = case.without
    scale = faster - made.campaign.distance * (1 - np.cos(made.scene.target.tilt))
    return scale if "distance_m" in made.table else scale - scale.mean()


def _rms(values: Column) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
