"""Which of many further columns an unexplained term is tried against: a cheap look at each by itself."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.unexplained_terms import Basis, degrees_of
from echocal.diagnose.inference.innovation import innovation, log_likelihood
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings import NoiseModelSettings, TermSettings

__all__ = ["MEASURE", "set_aside"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

MEASURE = (
    "how well a smooth curve against the column alone fits what is left beside an offset, a scale and the "
    "temperature, or beside smooth curves against all known quantities"
)
"""What they are chosen by, in words."""

_ROWS = 20_000  # that tell which column is worth a closer look
_RUN = 97  # of them that follow each other: a prime, so that no period of a table is missed
_FREE, _PART = 64, 4  # coefficients of all curves against known quantities; rows for each of them
_ALIKE = 1e-10  # part of the largest eigenvalue below which columns are the same but for rounding
_WHITE = Noise(0.0, 0.0, 0.0, 1.0)


def set_aside(
    scene: Scene,
    order: Order,
    known: Mapping[str, Column],
    further: Mapping[str, Column],
    rows: Labels,
    others: int,
) -> tuple[str, ...]:
    """List the further columns that no term is tried against; none where they are few.

    Two looks are taken, and the best of either stay: one at what an offset, a scale and the
    temperature leave, which takes nothing else for granted; and one at what smooth curves against
    all that is known leave, less what the rows before tell, where a small effect shows that is
    hidden beside a large one or in autocorrelated noise.

    Parameters
    ----------
    scene : Scene
    order : Order
    known : mapping of str to ndarray, shape (n,)
        What a term is tried against in any case: influence quantities, distance, rows or time.
    further : mapping of str to ndarray, shape (n,)
    rows : ndarray of int
        Rows that a fit may see.
    others : int
        Columns that there are already.

    Returns
    -------
    tuple of str
        The one nearest to a place comes first.
    """
    terms, search = scene.settings.terms, scene.settings.search
    able = [name for name, column in further.items() if degrees_of(column, terms)]
    others += sum(degrees_of(column, terms) for column in known.values())
    most = max((search.most_columns - others) // max(terms.degrees), search.shortlist_least)
    if len(able) <= most:
        return ()
    rows = rows[np.arange(len(rows)) // _RUN % -(-len(rows) // _ROWS) == 0]
    order = order.at(rows)
    first = _Look.of(scene, rows, order, [], _WHITE)
    second = _Look.of(scene, rows, order, curves := _curves(known, rows, terms), _WHITE)
    second = _Look.of(
        scene, rows, order, curves, _likeliest(second.residual, order, scene.settings.noise_models)
    )
    scores = np.array([_scores(name, further[name][rows], (first, second), terms) for name in able])
    places = np.argsort(np.argsort(-scores, axis=0, kind="stable"), axis=0).min(axis=1)
    return tuple(able[at] for at in np.argsort(places, kind="stable")[most:])


@dataclass(frozen=True, eq=False)
class _Look:
    """What is left of the residual beside some columns.

    Attributes
    ----------
    order : Order
    noise : Noise
        What is taken out of every column with it.
    degrees : tuple of int
        Of the curves that are tried.
    taken : ndarray, shape (p, n)
        Orthonormal: what the columns span.
    residual : ndarray, shape (n,)
        What they leave.
    """

    order: Order
    noise: Noise
    degrees: tuple[int, ...]
    taken: Column
    residual: Column

    @classmethod
    def of(cls, scene: Scene, rows: Labels, order: Order, further: Sequence[Column], noise: Noise) -> "_Look":
        """Take out an offset, a scale, what the temperature does to the scale, and further columns."""
        distance = scene.distance[rows]
        temperature = scene.conditions.get("temperature")
        warm = np.zeros(len(rows)) if temperature is None else temperature[rows] - np.mean(temperature[rows])
        columns = np.array([np.ones(len(rows)), *(distance * warm**power for power in range(3)), *further])
        degrees = scene.settings.terms.degrees
        bare = cls(order, noise, degrees, np.empty((0, len(rows))), np.zeros(len(rows)))
        columns, (residual,) = bare.seen(columns), bare.seen(scene.residual[rows][None])
        columns /= np.maximum(np.sqrt(np.mean(columns**2, axis=1, keepdims=True)), 1e-300)
        value, vector = np.linalg.eigh(columns @ columns.T)
        told = value > _ALIKE * value[-1]
        taken = (vector[:, told] / np.sqrt(value[told])).T @ columns
        return cls(order, noise, degrees, taken, residual - (taken @ residual) @ taken)

    def seen(self, columns: Column) -> Column:
        """Columns, shape (k, n), less unknown levels, and less what the rows before tell."""
        if self.order.flat_level:
            groups = np.unique(self.order.groups, return_inverse=True)[1]
            rows = np.bincount(groups)
            columns = columns - np.array([np.bincount(groups, one) / rows for one in columns])[:, groups]
        if self.noise.rho == 0.0:
            return columns
        return np.array([innovation(column, self.order, self.noise) for column in columns])

    def score(self, functions: Column) -> float:
        """Gain in log likelihood of the better of two degrees, less the penalty of the BIC (Schwarz 1978)."""
        functions = self.seen(functions)
        taken = functions @ self.taken.T
        among, along = functions @ functions.T - taken @ taken.T, functions @ self.residual
        among += _ALIKE * np.trace(among) * np.eye(len(among))
        whole, rows = max(float(self.residual @ self.residual), 1e-300), len(self.residual)
        gains = []
        for degree in {min(degree, len(along)) for degree in self.degrees}:
            sizes = np.linalg.solve(among[:degree, :degree], along[:degree])
            rest = max(1.0 - float(along[:degree] @ sizes) / whole, 1e-12)
            gains.append(-0.5 * rows * np.log(rest) - 0.5 * degree * np.log(rows))
        return float(max(gains))


def _scores(name: str, column: Column, looks: Sequence[_Look], settings: TermSettings) -> list[float]:
    """How well a term against a column fits what each look leaves."""
    basis = Basis.of(name, column, settings)
    if not basis.low < basis.high:  # nearly constant: a term would depend on a few rows
        return [-np.inf] * len(looks)
    functions = np.array(basis.at(column)[: max(degrees_of(column, settings), 1)])
    return [look.score(functions) for look in looks]


def _curves(known: Mapping[str, Column], rows: Labels, settings: TermSettings) -> list[Column]:
    """Smooth functions of known quantities, as many as the rows allow."""
    able = [(name, column) for name, column in known.items() if degrees_of(column, settings)]
    each = min(_FREE, len(rows) // _PART) // max(len(able), 1)
    curves: list[Column] = []
    for name, column in able:
        functions = Basis.of(name, column[rows], settings).at(column[rows])
        curves += functions[: min(each, degrees_of(column, settings))]
    return curves


def _likeliest(left: Column, order: Order, settings: NoiseModelSettings) -> Noise:
    """The noise that what is left has most likely, of those that are alike at all distances."""
    noises = [Noise(theta, rho, 0.0, 1.0) for theta, rhos in settings.autoregressions for rho in rhos]
    return max(noises, key=lambda noise: log_likelihood(left, order, noise))
