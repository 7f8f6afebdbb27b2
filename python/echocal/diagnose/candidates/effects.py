"""The columns of all effects that the data can show."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.onsets import places
from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.thermometers import bound_forms, no_thermometer, read_from_thermometers
from echocal.diagnose.candidates.variant import Candidates, Variant
from echocal.observations.quantiles import quantiles
from echocal.quantities import FROM_THERMOMETERS
from echocal.registry import Effect, Parameter, effects

__all__ = ["effect_candidates"]

Column = NDArray[np.float64]

_HALF_DAY = 43_200.0  # s: a shorter part of the arc of the sun looks like a drift or an offset
_HALF_STEP = 0.05  # of a prior standard deviation: half the difference that stands for a derivative


def effect_candidates(found: Candidates, scene: Scene) -> None:
    """Add the columns of all effects that the data can show.

    A size that theory fixes enters with coefficient one, at each usual value of the nonlinear
    parameters, and once with their tangents. Any other size enters by its tangent.
    """
    for effect in effects():
        reason = _why_not(effect, scene)
        if reason:
            found.skipped[effect.id] = reason
            continue
        sizes = [p for p in effect.parameters if p.role == "size"]
        if effect.id in scene.base.presumed:
            variants = [_presumed(found, effect, scene)]
        elif quantity := read_from_thermometers(effect):
            variants = bound_forms(found, effect, quantity, scene, _free)
        else:
            form = _known if all(p.known for p in sizes) else _free
            variants = form(found, effect, scene)
        if not variants:
            found.skipped[effect.id] = "too few distances before the one where it would begin"
            continue
        total = 1.0 if _each_counts(effect, scene) else sum(v.weight for v in variants)
        found.variants += [replace(v, weight=effect.prior * v.weight / total) for v in variants]


def _each_counts(effect: Effect, scene: Scene) -> bool:
    """Whether each form of a cause is as probable as another cause.

    Where the temperature is the same in all rows, nothing shows that the device reads a thermometer. Then
    each fixed speed in use is a cause by itself.
    """
    temperature = scene.conditions.get("temperature")
    return effect.id == "fixed_speed" and (temperature is None or not np.ptp(temperature) > 0)


def _why_not(effect: Effect, scene: Scene) -> str:
    recorded = scene.conditions
    missing = [name for name in effect.requires if name not in recorded and name not in FROM_THERMOMETERS]
    superseded = [name for name in effect.excludes if name in recorded]
    assumed = [name for name in effect.excludes if name in scene.base.air]
    if not scene.base.allows(effect):
        return "the base accounts for it"
    if reason := _why_no_arithmetic(effect, scene):
        return reason
    if missing:
        return f"not recorded: {', '.join(missing)}"
    if superseded:
        return f"recorded: {', '.join(superseded)}"
    if "hour_angle" in effect.requires and _span(recorded) < _HALF_DAY:
        return "the rows do not span half a day"
    if assumed:
        return f"assumed by the base: {', '.join(assumed)}"
    return no_thermometer(scene) if read_from_thermometers(effect) else ""


def _span(recorded: Mapping[str, Column]) -> float:
    """Time from the first row to the last one [s]."""
    return float(np.ptp(recorded["elapsed_time"])) if "elapsed_time" in recorded else np.inf


def _why_no_arithmetic(effect: Effect, scene: Scene) -> str:
    """Why an effect on the arithmetic of the device does not compete; empty where it does, or is none.

    Recorded echo times do not know this arithmetic. If the user states the speed that readings were made
    with, the echo times are computed from the readings, and do not know it either. Two ways to be wrong about
    such a statement are left: the device may have compensated its readings already (``double_correction``),
    or, if the stated speed depends on the temperature, have read another thermometer.
    """
    if effect.stage != "firmware" or (effect.id == "fixed_speed" and scene.base.device_speed is not None):
        return ""
    if scene.table.echoes:
        return "echo times were recorded"
    other = read_from_thermometers(effect) and not _is_number(scene.table.stated_speed)
    own = other or effect.id == "double_correction"
    if scene.table.stated_speed and not own:
        return f"readings were made with the stated speed {scene.table.stated_speed}"
    return ""


def _is_number(speed: str) -> bool:
    try:
        float(speed)
    except ValueError:
        return False
    return True


def _known(found: Candidates, effect: Effect, scene: Scene) -> list[Variant]:
    id_, nonlinear = effect.id, [p for p in effect.parameters if p.role == "shape"]
    sizes = {p.name: float(p.known[0]) for p in effect.parameters if p.role == "size"}
    speed = scene.base.device_speed
    if id_ == "fixed_speed" and speed is not None:  # the base gives the speed
        at = {**sizes, "speed": speed}
        return [Variant(id_, at, found.columns.shift(id_, at, scene.levels(id_, at)))]
    variants = [
        Variant(
            id_,
            at := {**sizes, p.name: float(value)},
            found.columns.shift(id_, at, scene.levels(id_, at)),
        )
        for p in nonlinear
        for value in p.known
    ]
    at = {**sizes, **{p.name: p.neutral for p in nonlinear}}
    levels = scene.levels(id_, at)
    whole = Variant(id_, at, found.columns.shift(id_, at, levels))
    for name, size in sizes.items():
        column = found.columns.tangent(id_, at, name, 1.0, at_work=True, levels=levels)
        found.size_tangents[id_] = (column, size)
    if _each_counts(effect, scene):  # one of these speeds, in air that is not quite as recorded
        near = [scene.settings.priors.air_unknown * p.neutral for p in nonlinear]
        variants += [
            _freed(found, one, nonlinear, near, at_work=True, levels=scene.levels(id_, one.at))
            for one in variants
        ]
    if nonlinear:
        usual = [p.prior_scale for p in nonlinear]
        whole = _freed(found, whole, nonlinear, usual, at_work=True, levels=levels)
    variants.append(whole)
    if effect.extends and effect.calls:  # it replaces the law and has the uncertainty of the law
        middle = scene.settings.priors.law_middle
        law = scene.settings.priors.law_uncertainty * scene.base.expected(scene.distance, scene.conditions)
        celsius = np.asarray(scene.conditions.get("temperature", middle))
        own = [found.columns.store(column) for column in (law, law * (celsius - middle) / middle)]
        unbounded = ((-np.inf, np.inf),) * len(own)
        variants = [replace(v, free=(*v.free, *own), bounds=(*v.bounds, *unbounded)) for v in variants]
    return variants


def _free(found: Candidates, effect: Effect, scene: Scene) -> list[Variant]:
    """Sizes by their tangents, at all nonlinear parameters, with the usual and the wide prior."""
    sizes = [p for p in effect.parameters if p.role == "size"]
    neutral = {p.name: p.neutral for p in effect.parameters}
    variants = []
    for form, weight in _forms(effect, scene):
        at = {**neutral, **form}
        scales = [_scale(p, scene) for p in sizes]
        variants.append(_freed(found, Variant(effect.id, at, weight=weight), sizes, scales))
        if any(p.tail > 1 for p in sizes):
            wide = [p.tail * scale for p, scale in zip(sizes, scales, strict=True)]
            variants.append(
                _freed(
                    found,
                    Variant(effect.id, at, weight=scene.settings.priors.tail_weight * weight),
                    sizes,
                    wide,
                )
            )
    return variants


def _presumed(found: Candidates, effect: Effect, scene: Scene) -> Variant:
    """A condition that is stated and may be wrong: its tangent at the stated value."""
    (size,), base = effect.parameters, scene.base
    scale, at = base.presumed[effect.id].scale, base.effects[effect.id][size.name]
    ends = np.clip([at - _HALF_STEP * scale, at + _HALF_STEP * scale], *size.bounds).tolist()
    low, high = (
        base.model({effect.id: {size.name: end}}).indicate(scene.distance, **scene.conditions) for end in ends
    )
    column = found.columns.store(scale * (high - low) / (ends[1] - ends[0]))
    return Variant(
        effect.id,
        {size.name: at},
        free=(column,),
        names=(size.name,),
        scales=(scale,),
        bounds=(_in_units(size.bounds, at, scale),),
    )


def _forms(effect: Effect, scene: Scene) -> list[tuple[dict[str, float], float]]:
    """Values of the nonlinear parameters that are tried, each with its part of the prior."""
    nonlinear = [p for p in effect.parameters if p.role == "shape"]
    onsets = [p for p in nonlinear if p.tried_along and effect.edges]
    fixed = [[(p.name, x) for x in _values(p, scene)] for p in nonlinear if p not in onsets]
    at = [(dict(values), 1.0) for values in product(*fixed)]
    for p in onsets:
        at = [({**a, p.name: x}, w) for a, _ in at for x, w in places(effect, p, a, scene)]
    return at


def _values(parameter: Parameter, scene: Scene) -> tuple[float, ...]:
    """Values of a nonlinear parameter that is no onset; along a column, quantiles of it.

    Such a value says in which rows the distance is right. An unknown level includes that; then the middle is
    enough.
    """
    if parameter.tried_along is not None:
        tried = parameter.tried if scene.groups is None else parameter.tried[len(parameter.tried) // 2 :][:1]
        return tuple(quantiles(scene.conditions[parameter.tried_along], tried))
    return tuple(float(x) for x in (*parameter.known, *parameter.tried)) or (parameter.neutral,)


def _scale(parameter: Parameter, scene: Scene) -> float:
    """Prior standard deviation of a size, for the span of this table."""
    if parameter.over is None:
        return parameter.prior_scale
    quantity, usual = parameter.over
    span = float(np.ptp(scene.conditions[quantity]))
    return parameter.prior_scale * usual / span if span > 0 else parameter.prior_scale


def _in_units(bounds: tuple[float, float], at: float, scale: float) -> tuple[float, float]:
    """Bounds of a coefficient, rounded inwards: a parameter that is computed from them is within its own."""
    low, high = ((bound - at) / scale for bound in bounds)
    while at + low * scale < bounds[0]:
        low = float(np.nextafter(low, np.inf))
    while at + high * scale > bounds[1]:
        high = float(np.nextafter(high, -np.inf))
    return low, high


def _freed(
    found: Candidates,
    variant: Variant,
    parameters: list[Parameter],
    scales: list[float],
    *,
    at_work: bool = False,
    levels: Column | None = None,
) -> Variant:
    """Add tangents of parameters, in units of their prior standard deviations, to a variant."""
    each = list(zip(parameters, scales, strict=True))
    tangents = [
        found.columns.tangent(variant.cause, variant.at, p.name, scale, at_work=at_work, levels=levels)
        for p, scale in each
    ]
    return replace(
        variant,
        free=tuple(tangents),
        names=tuple(p.name for p in parameters),
        scales=tuple(float(scale) for scale in scales),
        bounds=tuple(_in_units(p.bounds, variant.at[p.name], scale) for p, scale in each),
    )
