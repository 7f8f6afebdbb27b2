"""Places along a column at which an effect may begin, closer where it explains most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.columns import Columns
from echocal.registry import Effect, Parameter

if TYPE_CHECKING:
    from echocal.diagnose.candidates import Scene

__all__ = ["places"]

Column = NDArray[np.float64]
Matrix = NDArray[np.floating[Any]]

_CLOSEST = 0.5  # rows between two places at which an effect may begin
_ENDS = 5  # rows at either end of a table: what begins there is a wild row rather than an effect
_BEFORE = 1 / 8  # of all distances lie before the one where an effect begins, so that its absence shows
_FEWEST_BEFORE = 2  # distances: one alone would make any offset a beginning
_ALIKE = 1e-9  # part of a column's square below which it is what others are
_ROUNDING = 1e-9  # part of a sum of products that arithmetic leaves


def places(
    effect: Effect, parameter: Parameter, at: Mapping[str, float], scene: Scene
) -> list[tuple[float, float]]:
    """Places at which an effect may begin, each with its share of the prior.

    The share of a place is the part of the rows that is nearer to it than to any other. What begins
    in time is sought in what a scale and the temperature leave; and, where distances follow each
    other, so that these two take up what a step does, in all that is there.
    """
    along = parameter.tried_along
    assert along is not None
    column = scene.distance if along == "distance" else scene.conditions[along]
    ordered = bool((column[1:] >= column[:-1]).all())
    ascending = column if ordered else np.sort(column)
    inner = ascending[:_ENDS][-1], ascending[-_ENDS:][0]
    reach = _reach(ascending, parameter) if along == "distance" else inner
    look = _Look(
        effect,
        {**{p.name: p.neutral for p in effect.parameters}, **at},
        parameter.name,
        scene,
        [scene.residual] if along == "distance" else [scene.leftover, scene.residual],
        ascending if ordered and scene.groups is None else None,
    )
    found: set[float] = set()
    for of in range(len(look.of)):
        found |= _closer(look, of, parameter, ascending, reach)
    return _shares(ascending, sorted(found)) if found else []


def _closer(
    look: _Look, of: int, parameter: Parameter, ascending: Column, reach: tuple[float, float]
) -> set[float]:
    """Where a place explains most, halve the distance to the next one until it is half a row."""

    def explained(tried: Sequence[float], around: Sequence[float] = ()) -> dict[float, float]:
        values = dict(zip(tried, _quantiles(ascending, tried), strict=True))
        shown = {q: value for q, value in values.items() if reach[0] <= value <= reach[1]}
        look.at(list(shown.values()), _quantiles(ascending, around))
        return {q: look.squares(value, of) for q, value in shown.items()}

    scores = explained(parameter.tried)
    step = float(np.diff(parameter.tried).min()) / 2
    while scores and step * len(ascending) > _CLOSEST:
        best = max(scores, key=lambda q: scores[q])
        ends = [min(max(best + far * step, 0.0), 1.0) for far in (-2, 0, 2)]
        scores |= explained((best - step, best + step), ends)
        step /= 2
    return set(scores)


def _shares(ascending: Column, quantiles: Sequence[float]) -> list[tuple[float, float]]:
    middles = np.array([0.0, *(np.diff(quantiles) / 2 + quantiles[:-1]), 1.0])
    values: dict[float, float] = {}
    for value, share in zip(_quantiles(ascending, quantiles), np.diff(middles).tolist(), strict=True):
        values[value] = values.get(value, 0.0) + share
    return list(values.items())


@dataclass
class _Look:
    """What the sizes of an effect explain beside a level, wherever the effect may begin.

    Attributes
    ----------
    effect : Effect
    parameters : dict of str to float
        Where the tangents are taken; the place is put in.
    place : str
        Name of the parameter that says where.
    scene : Scene
    of : list of ndarray, shape (n,)
        What is to be explained [m]: either of these.
    ascending : ndarray, shape (n,), or None
        The column along which the places lie, where its rows ascend and no level is to be found:
        between two places then lie rows that follow each other.
    known : dict of float to ndarray
        Products of the level, the sizes' tangents and what is to be explained, by place.
    """

    effect: Effect
    parameters: dict[str, float]
    place: str
    scene: Scene
    of: list[Column]
    ascending: Column | None
    known: dict[float, Matrix] = field(default_factory=dict)

    def at(self, wanted: Sequence[float], around: Sequence[float]) -> None:
        """Look at some places, which lie between the outer two of `around`, if those are given.

        Rows on whose side of all these places the effect is the same are not looked at again. That
        they are such rows is seen in their sums at the outer places, which are known.
        """
        new = [value for value in dict.fromkeys(wanted) if value not in self.known]
        if not new:
            return
        if self.ascending is not None and len(around) and around[1] in self.known:
            (low, middle, high), count = around, len(self.ascending)
            first, last = np.searchsorted(self.ascending, [low, high], side="right").tolist()
            first, last = first if low in self.known else 0, last if high in self.known else count
            seen = [value for value in dict.fromkeys(around) if value in self.known]
            if 0 < last - first < count:
                inside = self._products([*seen, *new], slice(first, last))
                outside = [self.known[value] - inside[value] for value in seen]
                if self._same(outside, self.known[middle]):
                    self.known |= {
                        value: self.known[middle] - inside[middle] + inside[value] for value in new
                    }
                    return
                self.ascending = None  # what begins there goes on to change beyond
        self.known |= self._products(new, slice(None))

    def squares(self, value: float, of: int) -> float:
        """Squares that are explained at a place, of one of what is to be explained."""
        products = self.known[value]
        own = len(products) - len(self.of)
        among, along = products[:own, :own], products[:own, own + of]
        ridge = np.diag(_ALIKE * among.diagonal() + np.finfo(float).tiny)
        return float(np.linalg.solve(among + ridge, along) @ along)

    def _products(self, values: Sequence[float], rows: slice) -> dict[float, Matrix]:
        scene = self.scene
        groups = None if scene.groups is None else scene.groups[rows]
        conditions = {name: column[rows] for name, column in scene.conditions.items()}
        columns = Columns(scene.base.plain, scene.distance[rows], conditions, groups)
        sizes = [p.name for p in self.effect.parameters if p.role == "size"]
        slope = columns.slope()
        tangents = {
            value: [
                columns.tangent(self.effect.id, {**self.parameters, self.place: value}, name, 1.0)
                for name in sizes
            ]
            for value in values
        }
        left = [columns.store(of[rows]) for of in self.of]
        gram = columns.gram()
        designs = {value: [slope, *own, *left] for value, own in tangents.items()}
        return {value: gram[np.ix_(design, design)] for value, design in designs.items()}

    @staticmethod
    def _same(outside: Sequence[Matrix], whole: Matrix) -> bool:
        scale = np.sqrt(np.diag(whole))
        limit = _ROUNDING * np.outer(scale, scale)
        return all((np.abs(one - outside[0]) <= limit).all() for one in outside[1:])


def _quantiles(ascending: Column, parts: Sequence[float]) -> list[float]:
    """Quantiles of a sorted column, between neighbors where none of its rows is at the place."""
    at = np.asarray(parts, dtype=np.float64) * (len(ascending) - 1)
    before = np.floor(at).astype(np.int64)
    low, high = ascending[before], ascending[np.minimum(before + 1, len(ascending) - 1)]
    return [float(value) for value in low + (high - low) * (at - before)]


def _reach(ascending: Column, parameter: Parameter) -> tuple[float, float]:
    """First and last distance at which an effect may begin: one that begins before is an offset."""
    distinct = ascending[np.append(True, ascending[1:] > ascending[:-1])]
    before = max(_FEWEST_BEFORE, int(np.ceil(_BEFORE * len(distinct))))
    if len(distinct) <= before:
        return np.inf, -np.inf
    return max(parameter.bounds[0], float(distinct[before - 1])), float(distinct[-2])
