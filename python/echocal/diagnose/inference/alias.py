"""Causes that these data cannot separate, from the geometry of their columns."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.settings.claims import ClaimSettings

__all__ = ["Geometry"]

Matrix = NDArray[np.floating[Any]]

_ROUNDING = 1e-12  # part of the squares below which columns are the same but for rounding
_FAR = 2.0  # times the limit, in a quick estimate, beyond which a form is no rival


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

    def visibility(self, signal: Matrix) -> float:
        """Signal over noise, summed over rows: ``snr sqrt(n)``."""
        return float(np.sqrt(np.maximum(signal @ self.products @ signal, 0.0)))

    def visibilities(self, variants: Sequence[Variant]) -> Matrix:
        """Visibility of each of several causes, each at its prior size."""
        signals = np.array([self.signal(variant) for variant in variants]).reshape(-1, len(self.products))
        squares = np.einsum("mi,mi->m", signals @ self.products, signals)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    def _imitation(self, signal: Matrix, variant: Variant, beside: Matrix) -> tuple[float, float]:
        """Log odds that remain against one form's imitation of a signal, and the size that it needs.

        The sizes of the form are within its bounds: a cause that only warms imitates nothing that cools.
        The size is in prior standard deviations of the form; it is also that of what stays, where
        that becomes larger than it was.
        """
        rest = signal if variant.offset is None else signal - self.signal(variant)
        free = [*variant.free, *np.flatnonzero(beside).tolist()]
        if not free:
            return 0.5 * self.visibility(rest) ** 2, 1.0
        size, own = self._sizes(free, rest), len(variant.free)
        within = np.clip(size[:own], *_limits(variant))
        if (within != size[:own]).any():  # the form cannot be that: the others give way as far as they can
            others = self._sizes(free[own:], rest - self._place(free[:own], within))
            size = np.concatenate([within, others])
        rest = rest - self._place(free, size)
        stays = beside[free[own:]]
        grown = np.where(np.abs(stays + size[own:]) > np.abs(stays), stays + size[own:], 0.0)
        return 0.5 * self.visibility(rest) ** 2, float(np.abs([*size[:own], *grown]).max())

    def _sizes(self, free: list[int], rest: Matrix) -> Matrix:
        """Coefficients of columns that leave the least of a signal."""
        along = self.products[free] @ rest
        if len(free) == 1:
            square = self.products[free[0], free[0]]
            return np.asarray(along / square) if square > 0 else np.zeros(1)
        return np.asarray(np.linalg.lstsq(self.products[np.ix_(free, free)], along, rcond=1e-12)[0])

    def _odds(self, signal: Matrix, variants: Sequence[Variant], beside: Matrix) -> Matrix:
        """Log odds that remain against the imitation by each form, to a few digits: many at once."""
        stays, odds = np.flatnonzero(beside), np.empty(len(variants))
        along_signal = self.products @ signal
        for count in {len(v.free) for v in variants}:
            own = [i for i, v in enumerate(variants) if len(v.free) == count]
            free = np.array([[*variants[i].free, *stays] for i in own], dtype=np.int64)
            fixed = np.array([-1 if (at := variants[i].offset) is None else at for i in own])
            there = fixed >= 0
            square = signal @ along_signal + there * (self.products[fixed, fixed] - 2 * along_signal[fixed])
            along = along_signal[free] - there[:, None] * self.products[free, fixed[:, None]]
            among = self.products[free[:, :, None], free[:, None, :]]
            ridge = _ROUNDING * np.trace(among, axis1=1, axis2=2) + np.finfo(float).tiny
            held = among + ridge[:, None, None] * np.eye(free.shape[1])
            size = np.linalg.solve(held, along[..., None])[..., 0]
            taken = np.einsum("mi,mi->m", size, 2 * along - np.einsum("mij,mj->mi", among, size))
            odds[own] = 0.5 * (square - taken)  # an error of the sizes counts by its square
        return odds

    def _place(self, free: list[int], size: Matrix) -> Matrix:
        placed = np.zeros(len(self.products))
        placed[free] = size
        return placed

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
        known = [variant for variants in others.values() for variant in variants]
        odds = dict(zip(map(id, known), self._odds(signal, known, beside).tolist(), strict=True))

        def alike(variant: Variant) -> bool:
            if odds[id(variant)] >= _FAR * settings.separable:
                return False
            left, size = self._imitation(signal, variant, beside)
            return left < settings.separable and size <= settings.plausible_size

        return [cause for cause, variants in others.items() if any(map(alike, variants))]

    def correlation(self, one: Variant, other: Variant) -> float:
        """Cosine between the columns of two causes, after whitening and removing levels."""
        a, b = self.signal(one), self.signal(other)
        lengths = self.visibility(a) * self.visibility(b)
        return float(a @ self.products @ b / lengths) if lengths > 0 else np.nan


def _limits(variant: Variant) -> tuple[Matrix, Matrix]:
    """Smallest and largest sizes of the free columns, in prior standard deviations."""
    low, high = np.array(variant.bounds, dtype=np.float64).reshape(-1, 2).T
    return low, high
