"""Onsets of an effect along a column, with a finer grid where the effect explains most."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.onset_search import OnsetSearch
from echocal.diagnose.candidates.scene import Scene
from echocal.registry import Effect, Parameter

__all__ = ["places"]

Column = NDArray[np.float64]

_RESOLUTION = 0.5  # rows: these show no more
_ENDS = 5  # rows at either end without an onset: it would be an outlier
_BEFORE = 1 / 8  # of the distances, before an onset along the distance
_FEWEST_BEFORE = 2  # of them: with a single one, any offset would be an onset


def places(
    effect: Effect, parameter: Parameter, at: Mapping[str, float], scene: Scene
) -> list[tuple[float, float]]:
    """Onsets that are tried, each with its part of the prior.

    The part of an onset is the part of the rows that is nearer to it than to any other onset. An
    onset in time is searched in the residual of a scale and the temperature. It is also searched in
    the whole residual, because these two may fit a step if the distances are in order.
    """
    along = parameter.tried_along
    assert along is not None
    column = scene.distance if along == "distance" else scene.conditions[along]
    ascending = column if (column[1:] >= column[:-1]).all() else np.sort(column)
    inner = ascending[:_ENDS][-1], ascending[-_ENDS:][0]
    reach = _reach(ascending, parameter) if along == "distance" else inner
    onset = OnsetSearch(
        effect=effect,
        parameters={**{p.name: p.neutral for p in effect.parameters}, **at},
        place=parameter.name,
        scene=scene,
        of=[scene.residual] if along == "distance" else [scene.leftover, scene.residual],
    )
    found: set[float] = set()
    for of in range(len(onset.of)):
        found |= _refined(onset, of, parameter, ascending, reach)
    return _shares(ascending, sorted(found)) if found else []


def _refined(
    onset: OnsetSearch, of: int, parameter: Parameter, ascending: Column, reach: tuple[float, float]
) -> set[float]:
    """Halve the distance between onsets around the best one, until it is half a row."""

    def explained(tried: Sequence[float]) -> dict[float, float]:
        values = dict(zip(tried, _quantiles(ascending, tried), strict=True))
        shown = {q: value for q, value in values.items() if reach[0] <= value <= reach[1]}
        return dict(zip(shown, onset.squares(list(shown.values()), of), strict=True))

    scores = explained(parameter.tried)
    step = float(np.diff(parameter.tried).min()) / 2
    while scores and step * len(ascending) > _RESOLUTION:
        best = max(scores, key=lambda q: scores[q])
        scores |= explained((best - step, best + step))
        step /= 2
    return set(scores)


def _shares(ascending: Column, quantiles: Sequence[float]) -> list[tuple[float, float]]:
    middles = np.array([0.0, *(np.diff(quantiles) / 2 + quantiles[:-1]), 1.0])
    values: dict[float, float] = {}
    for value, share in zip(_quantiles(ascending, quantiles), np.diff(middles).tolist(), strict=True):
        values[value] = values.get(value, 0.0) + share
    return list(values.items())


def _quantiles(ascending: Column, parts: Sequence[float]) -> list[float]:
    """Quantiles of a sorted column, interpolated between its rows."""
    at = np.asarray(parts, dtype=np.float64) * (len(ascending) - 1)
    before = np.floor(at).astype(np.int64)
    low, high = ascending[before], ascending[np.minimum(before + 1, len(ascending) - 1)]
    return [float(value) for value in low + (high - low) * (at - before)]


def _reach(ascending: Column, parameter: Parameter) -> tuple[float, float]:
    """First and last distance at which an effect may begin; an earlier one would be an offset."""
    distinct = ascending[np.append(True, ascending[1:] > ascending[:-1])]
    before = max(_FEWEST_BEFORE, int(np.ceil(_BEFORE * len(distinct))))
    if len(distinct) <= before:
        return np.inf, -np.inf
    return max(parameter.bounds[0], float(distinct[before - 1])), float(distinct[-2])
