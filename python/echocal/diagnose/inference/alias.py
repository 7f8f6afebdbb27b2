"""Causes that these data cannot separate, from the geometry of their columns."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.settings.claims import ClaimSettings
from echocal.diagnose.settings.priors import WIDEST

__all__ = ["Geometry"]

Systematic = Sequence[tuple[int, float]]
Matrix = NDArray[np.floating[Any]]


class Geometry:
    """Lengths and angles of the causes' columns, after whitening and removing levels.

    Parameters
    ----------
    products : ndarray, shape (k, k)
        Whitened products under the most probable noise.
    variance : float
        Variance of the innovations [m^2].
    """

    def __init__(self, products: Matrix, variance: float) -> None:
        self.products = products / variance

    def signal(self, variant: Variant, mean: Matrix | None = None) -> Matrix:
        """Combination of columns that a cause adds, at its prior size or at the size found."""
        combination = np.zeros(len(self.products))
        if variant.offset is not None:
            combination[variant.offset] = 1.0
        size = np.ones(len(variant.free)) if mean is None else mean
        if mean is not None or variant.offset is None:
            combination[list(variant.free)] = size
        return combination

    def type_b(self, fit: HypothesisFit, systematic: Systematic) -> Matrix:
        """Standard uncertainty of each coefficient from errors that all rows share.

        A coefficient takes up of such an error what generalized least squares makes of it:
        docs/method/checks.md, Eq. 17a.
        """
        columns, factors = _errors(systematic)
        free = [column for variant in fit.hypothesis.variants for column in variant.free]
        among = self.products[np.ix_(free, free)] + np.eye(len(free)) / WIDEST**2
        taken = np.linalg.solve(among, self.products[np.ix_(free, columns)] * factors)
        return np.asarray(np.linalg.norm(taken, axis=1))

    def beyond_shared(self, signal: Matrix, systematic: Systematic) -> float:
        """Visibility of a signal where the noise has these errors, too: docs/method/checks.md, Eq. 46a."""
        columns, factors = _errors(systematic)
        along = factors * (self.products[columns] @ signal)
        among = factors[:, None] * self.products[np.ix_(columns, columns)] * factors
        shared = along @ np.linalg.solve(among + np.eye(len(columns)), along)
        return float(np.sqrt(np.maximum(signal @ self.products @ signal - shared, 0.0)))

    def visibility(self, signal: Matrix) -> float:
        """Signal over noise, summed over rows: ``snr sqrt(n)``."""
        return float(np.sqrt(np.maximum(signal @ self.products @ signal, 0.0)))

    def visibilities(self, variants: Sequence[Variant]) -> Matrix:
        """Visibility of each of several causes, each at its prior size."""
        signals = np.array([self.signal(variant) for variant in variants]).reshape(-1, len(self.products))
        squares = np.einsum("mi,mi->m", signals @ self.products, signals)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    def rivals(
        self,
        signal: Matrix,
        others: dict[str, list[Variant]],
        beside: Matrix,
        settings: ClaimSettings,
    ) -> list[str]:
        """Causes that these data cannot separate from a signal: a form of plausible size imitates it.

        docs/method.md, Eq. 23.

        Parameters
        ----------
        signal : ndarray, shape (k,)
        others : mapping of str to list of Variant
            Forms of each other cause.
        beside : ndarray, shape (k,)
            What causes that stay add, whose sizes may change: what two causes make together may be
            made by one of them and a third, though no two of them are similar.
        settings : ClaimSettings
        """
        forms = [(cause, variant.form) for cause, variants in others.items() for variant in variants]
        left, size = _core.imitations(self.products, signal, beside, [form for _, form in forms])
        alike = (left < settings.separable) & (size <= settings.plausible_size)
        return list(dict.fromkeys(forms[at][0] for at in np.flatnonzero(alike)))


def _errors(systematic: Systematic) -> tuple[list[int], Matrix]:
    """Columns of errors that all rows share, and their factors."""
    return [column for column, _ in systematic], np.array([factor for _, factor in systematic])
