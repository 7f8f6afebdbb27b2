"""Candidate causes as columns: what each would add to the readings of this table."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.onsets import places
from echocal.diagnose.preprocess.base import Base
from echocal.model import Model
from echocal.registry import Effect, Parameter, effects

__all__ = ["UNKNOWN", "Candidates", "Scene", "Variant", "effect_candidates"]

Column = NDArray[np.float64]

UNKNOWN = "unknown"
"""Id under which a smooth shape without a cause competes."""

_CACHED = 8192  # rows that are worked on at a time, so that their columns stay near the processor
_TAIL = 0.1  # weight of a prior's tail beside its bulk
_LAW = 300e-6 / 3**0.5
"""Relative standard uncertainty of a law: Cramer 1993 states limits of 300 ppm (GUM 4.3.7)."""
_MIDDLE = 15.0
"""Middle of the range of those limits, 0 to 30 degC: a law may be wrong by its level and by its tilt."""


@dataclass(frozen=True)
class Variant:
    """One linear form of a cause: a fixed column, free columns, or both.

    Attributes
    ----------
    cause : str
        Id of the effect, or `UNKNOWN`.
    at : mapping of str to float
        Parameters of the fixed column, or at which the free ones are linearized.
    offset : int or None
        Column that enters with coefficient one.
    free : tuple of int
        Columns with a coefficient to be found, in units of its prior standard deviation.
    names, scales : tuple
        Parameter and its prior standard deviation, per free column.
    bounds : tuple of (float, float)
        Bounds of each coefficient, in the same units.
    weight : float
        Probability among the variants of its cause.
    against : str
        For `UNKNOWN`, the column that the shape is a function of.
    """

    cause: str
    at: Mapping[str, float] = field(default_factory=dict)
    offset: int | None = None
    free: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    scales: tuple[float, ...] = ()
    bounds: tuple[tuple[float, float], ...] = ()
    weight: float = 1.0
    against: str = ""

    @property
    def columns(self) -> tuple[int, ...]:
        """Every column that it uses."""
        return self.free if self.offset is None else (self.offset, *self.free)


@dataclass
class Candidates:
    """Columns so far, the variants that use them, and what was left out and why.

    `aside` are further columns of the table that no shape is tried against, for there are many.
    """

    columns: Columns
    variants: list[Variant] = field(default_factory=list)
    size_tangents: dict[str, tuple[int, float]] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    line: Variant | None = None
    aside: tuple[str, ...] = ()

    @property
    def competing(self) -> int:
        """Number of causes that have a variant."""
        return len({v.cause for v in self.variants} - {UNKNOWN})

    @property
    def shapes(self) -> dict[str, Variant]:
        """The freest shape without a cause against each column."""
        shapes = sorted((v for v in self.variants if v.cause == UNKNOWN), key=lambda v: len(v.free))
        return {v.against: v for v in shapes}


@dataclass(frozen=True)
class Scene:
    """Where the candidates are evaluated.

    Attributes
    ----------
    base : Base
        The base simulation.
    distance : ndarray, shape (n,)
        Reference distance, or the level of each row's stretch [m].
    conditions : mapping of str to ndarray
        Recorded influence quantities.
    relevel : callable
        ``relevel(model)`` is every row's distance [m] if that model were right.
    groups : ndarray of int, shape (n,), or None
        Stretch of each row where the level is unknown; None where the distance is.
    residual : ndarray, shape (n,)
        Reading less what the base simulation predicts [m].
    echoes : bool
        Whether the readings come from recorded echo times.
    """

    base: Base
    distance: Column
    conditions: Mapping[str, Column]
    relevel: Callable[[Model], Column]
    groups: NDArray[np.int64] | None
    residual: Column
    echoes: bool = False

    @cached_property
    def leftover(self) -> Column:
        """Residual less what a scale and the temperature may have done, shape (n,) [m].

        Where something begins in time shows there, whatever else is wrong.
        """
        warm = np.asarray(self.conditions.get("temperature", 0.0))
        mean, spread = np.mean(warm), max(float(np.std(warm)), 1e-12)
        firsts = range(0, len(self.distance), _CACHED)

        def design(first: int) -> Column:
            rows = slice(first, first + _CACHED)
            distance = self.distance[rows]
            scaled = ((warm[rows] if warm.ndim else warm) - mean) / spread
            columns = np.empty((4, len(distance)))
            columns[0], columns[1] = 1.0, distance
            for power in (2, 3):  # the distance times the temperature, once and twice
                np.multiply(columns[power - 1], scaled, out=columns[power])
            return columns

        among, along = np.zeros((4, 4)), np.zeros(4)
        for first in firsts:
            columns = design(first)
            among += columns @ columns.T
            along += columns @ self.residual[first : first + _CACHED]
        found = np.linalg.lstsq(among, along, rcond=1e-9)[0]
        left = self.residual.copy()
        for first in firsts:
            left[first : first + _CACHED] -= found @ design(first)
        return left

    def columns(self) -> Columns:
        """A table's columns, of which there is none yet."""
        return Columns(self.base.plain, self.distance, self.conditions, self.groups)

    def levels(self, id_: str, at: Mapping[str, float]) -> Column | None:
        """Level of each stretch [m] if an effect were there; None where the distance is known."""
        if self.groups is None:
            return None
        firsts = np.unique(self.groups, return_index=True)[1]
        return self.relevel(self.base.model({id_: at}))[firsts]


def effect_candidates(found: Candidates, scene: Scene) -> None:
    """Add the columns of every effect that the data could show.

    A size that theory knows enters with coefficient one, at every value of its shape that the
    trade uses and beside the shape's tangent; any other size enters by its tangent.
    """
    for effect in effects():
        reason = _why_not(effect, scene)
        if reason:
            found.skipped[effect.id] = reason
            continue
        sizes = [p for p in effect.parameters if p.role == "size"]
        form = _known if all(p.known for p in sizes) else _free
        variants = form(found, effect, scene)
        if not variants:
            found.skipped[effect.id] = "too few distances before the one where it would begin"
            continue
        total = sum(v.weight for v in variants)
        found.variants += [replace(v, weight=v.weight / total) for v in variants]


def _why_not(effect: Effect, scene: Scene) -> str:
    recorded = scene.conditions
    missing = [name for name in effect.requires if name not in recorded]
    superseded = [name for name in effect.excludes if name in recorded]
    assumed = [name for name in effect.excludes if name in scene.base.air]
    if not scene.base.allows(effect):
        return "the base accounts for it"
    asked = effect.id == "fixed_speed" and scene.base.device_speed is not None
    if scene.echoes and effect.stage == "firmware" and not asked:  # the device's own arithmetic comes after
        return "echo times were recorded"
    if missing:
        return f"not recorded: {', '.join(missing)}"
    if superseded:
        return f"recorded: {', '.join(superseded)}"
    if assumed:
        return f"assumed by the base: {', '.join(assumed)}"
    return ""


def _known(found: Candidates, effect: Effect, scene: Scene) -> list[Variant]:
    id_, shapes = effect.id, [p for p in effect.parameters if p.role == "shape"]
    sizes = {p.name: float(p.known[0]) for p in effect.parameters if p.role == "size"}
    speed = scene.base.device_speed
    if id_ == "fixed_speed" and speed is not None:  # the base says which speed it is
        at = {**sizes, "speed": speed}
        return [Variant(id_, at, found.columns.shift(id_, at, scene.levels(id_, at)))]
    variants = [
        Variant(
            id_,
            at := {**sizes, p.name: float(value)},
            found.columns.shift(id_, at, scene.levels(id_, at)),
        )
        for p in shapes
        for value in p.known
    ]
    at = {**sizes, **{p.name: p.neutral for p in shapes}}
    levels = scene.levels(id_, at)
    whole = Variant(id_, at, found.columns.shift(id_, at, levels))
    for name, size in sizes.items():
        column = found.columns.tangent(id_, at, name, 1.0, at_work=True, levels=levels)
        found.size_tangents[id_] = (column, size)
    usual = [p.prior_scale for p in shapes]
    variants.append(_freed(found, whole, shapes, usual, at_work=True, levels=levels) if shapes else whole)
    if effect.extends and effect.calls:  # it stands in for the law: the law's own uncertainty comes in
        law = _LAW * scene.base.expected(scene.distance, scene.conditions)
        celsius = np.asarray(scene.conditions.get("temperature", _MIDDLE))
        own = [found.columns.store(column) for column in (law, law * (celsius - _MIDDLE) / _MIDDLE)]
        unbounded = ((-np.inf, np.inf),) * len(own)
        variants = [replace(v, free=(*v.free, *own), bounds=(*v.bounds, *unbounded)) for v in variants]
    return variants


def _free(found: Candidates, effect: Effect, scene: Scene) -> list[Variant]:
    """Sizes by their tangents, for every shape that is tried, with the usual and with a tail's prior."""
    sizes = [p for p in effect.parameters if p.role == "size"]
    neutral = {p.name: p.neutral for p in effect.parameters}
    variants = []
    for shape, weight in _shapes(effect, scene):
        at = {**neutral, **shape}
        scales = [_scale(p, scene) for p in sizes]
        variants.append(_freed(found, Variant(effect.id, at, weight=weight), sizes, scales))
        if any(p.tail > 1 for p in sizes):
            wide = [p.tail * scale for p, scale in zip(sizes, scales, strict=True)]
            variants.append(_freed(found, Variant(effect.id, at, weight=_TAIL * weight), sizes, wide))
    return variants


def _shapes(effect: Effect, scene: Scene) -> list[tuple[dict[str, float], float]]:
    """Shapes that are worth a try in these data, each with its share of the prior."""
    shapes = [p for p in effect.parameters if p.role == "shape"]
    fixed = [
        [(p.name, float(x)) for x in (*p.known, *p.tried) or (p.neutral,)]
        for p in shapes
        if not p.tried_along
    ]
    at = [(dict(values), 1.0) for values in product(*fixed)]
    for p in (p for p in shapes if p.tried_along):
        at = [({**a, p.name: x}, w) for a, _ in at for x, w in places(effect, p, a, scene)]
    return at


def _scale(parameter: Parameter, scene: Scene) -> float:
    """Prior standard deviation of a size in a table that spans this much."""
    if parameter.over is None:
        return parameter.prior_scale
    quantity, usual = parameter.over
    span = float(np.ptp(scene.conditions[quantity]))
    return parameter.prior_scale * usual / span if span > 0 else parameter.prior_scale


def _freed(
    found: Candidates,
    variant: Variant,
    parameters: list[Parameter],
    scales: list[float],
    *,
    at_work: bool = False,
    levels: Column | None = None,
) -> Variant:
    """Let parameters of a variant move around where they stand, by prior standard deviations."""
    each = list(zip(parameters, scales, strict=True))
    low_high = [tuple((b - variant.at[p.name]) / scale for b in p.bounds) for p, scale in each]
    tangents = [
        found.columns.tangent(variant.cause, variant.at, p.name, scale, at_work=at_work, levels=levels)
        for p, scale in each
    ]
    return replace(
        variant,
        free=tuple(tangents),
        names=tuple(p.name for p in parameters),
        scales=tuple(float(scale) for scale in scales),
        bounds=tuple((low, high) for low, high in low_high),
    )
