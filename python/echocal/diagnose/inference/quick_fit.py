"""A quick fit of one further column at a time: enough for a shortlist, not for a probability."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.unexplained_terms import Basis, degrees_of
from echocal.diagnose.inference.innovation import innovation
from echocal.diagnose.inference.noise import WHITE, Noise
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings import TermSettings

__all__ = ["QuickFit", "scores"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_ALIKE = 1e-10  # part of the largest eigenvalue below which columns are the same but for rounding


@dataclass(frozen=True, eq=False)
class QuickFit:
    """The residual without some columns, whitened, and how well further columns fit it.

    Attributes
    ----------
    order : Order
    noise : Noise
        Every column is whitened for it.
    degrees : tuple of int
        Of the curves that are tried.
    taken : ndarray, shape (p, n)
        Orthonormal basis of the columns that are taken out.
    residual : ndarray, shape (n,)
        Residual without them.
    """

    order: Order
    noise: Noise
    degrees: tuple[int, ...]
    taken: Column
    residual: Column

    @classmethod
    def of(
        cls, scene: Scene, rows: Labels, order: Order, further: Sequence[Column], noise: Noise
    ) -> "QuickFit":
        """Take out an offset, a scale, what the temperature does to the scale, and further columns."""
        distance = scene.distance[rows]
        temperature = scene.conditions.get("temperature")
        warm = np.zeros(len(rows)) if temperature is None else temperature[rows] - np.mean(temperature[rows])
        columns = np.array([np.ones(len(rows)), *(distance * warm**power for power in range(3)), *further])
        degrees = scene.settings.terms.degrees
        bare = cls(order, noise, degrees, np.empty((0, len(rows))), np.zeros(len(rows)))
        columns, (residual,) = bare.whitened(columns), bare.whitened(scene.residual[rows][None])
        columns /= np.maximum(np.sqrt(np.mean(columns**2, axis=1, keepdims=True)), 1e-300)
        value, vector = np.linalg.eigh(columns @ columns.T)
        independent = value > _ALIKE * value[-1]
        taken = (vector[:, independent] / np.sqrt(value[independent])).T @ columns
        return cls(order, noise, degrees, taken, residual - (taken @ residual) @ taken)

    def whitened(self, columns: Column) -> Column:
        """Columns, shape (k, n), without unknown levels, whitened."""
        if self.order.flat_level:
            groups = np.unique(self.order.groups, return_inverse=True)[1]
            rows = np.bincount(groups)
            columns = columns - np.array([np.bincount(groups, one) / rows for one in columns])[:, groups]
        if self.noise.correlation is WHITE:
            return columns
        return np.array([innovation(column, self.order, self.noise) for column in columns])

    def score(self, functions: Column) -> float:
        """Gain in log likelihood of the better of two degrees, less the penalty of the BIC (Schwarz 1978)."""
        functions = self.whitened(functions)
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


def scores(name: str, column: Column, fits: Sequence[QuickFit], settings: TermSettings) -> list[float]:
    """Score of a term against a column in each of several fits."""
    basis = Basis.of(name, column, settings)
    if not basis.low < basis.high:  # nearly constant: a term would depend on a few rows
        return [-np.inf] * len(fits)
    functions = np.array(basis.at(column)[: max(degrees_of(column, settings), 1)])
    return [fit.score(functions) for fit in fits]
