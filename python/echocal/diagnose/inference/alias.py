"""Causes that these data cannot separate, from the geometry of their columns."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.settings.claims import ClaimSettings
from echocal.diagnose.settings.priors import WIDEST

__all__ = ["Geometry"]

_ROUNDING = 1e-12  # part of the squares below which columns are the same but for rounding

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
        forms = [variant for variants in others.values() for variant in variants]
        left, size = self._imitations(signal, beside, forms)
        alike = (left < settings.separable) & (size <= settings.plausible_size)
        return list(dict.fromkeys(forms[at].cause for at in np.flatnonzero(alike)))

    def _imitations(self, signal: Matrix, beside: Matrix, forms: Sequence[Variant]) -> tuple[Matrix, Matrix]:
        """Log odds that remain against the imitation of a signal by each form, and the largest size it needs.

        At sizes within the bounds of the form: a cause that only warms imitates nothing that cools. What
        stays gives way as far as it can, and its size counts where it becomes larger than it was.
        """
        products, stays, along = self.products, np.flatnonzero(beside), self.products @ signal
        left, needed = np.empty((2, len(forms)))
        alike: dict[tuple[bool, int], list[int]] = {}
        for at, form in enumerate(forms):
            alike.setdefault((form.offset is None, len(form.free)), []).append(at)
        for (bare, own), places in alike.items():
            some = [forms[at] for at in places]
            offset = [form.offset for form in some if form.offset is not None]
            toward = np.broadcast_to(along if bare else along - products[offset], (len(some), len(along)))
            square = signal @ along - (0.0 if bare else 2.0 * along[offset] - products[offset, offset])
            free = np.array([[*form.free, *stays] for form in some], dtype=np.int64)
            among = products[free[:, :, None], free[:, None, :]]
            target = np.take_along_axis(toward, free, axis=1)
            bounds = np.array([form.bounds for form in some]).reshape(len(some), own, 2)
            size = _least_squares(among, target)
            within = np.clip(size[:, :own], bounds[..., 0], bounds[..., 1])
            if (out := (within != size[:, :own]).any(axis=1)).any():
                rest = target[out, own:] - np.einsum("fij,fj->fi", among[out, own:, :own], within[out])
                size[out, own:] = _least_squares(among[out, own:, own:], rest)
                size[:, :own] = within
            taken = (size * (2.0 * target - np.einsum("fij,fj->fi", among, size))).sum(axis=1)
            after, before = np.abs(beside[stays] + size[:, own:]), np.abs(beside[stays])
            sizes = np.concatenate([np.abs(within), np.where(after > before, after, 0.0)], axis=1)
            left[places] = 0.5 * np.maximum(square - taken, 0.0)
            needed[places] = sizes.max(axis=1) if sizes.shape[1] else 1.0
        return left, needed


def _least_squares(among: Matrix, along: Matrix) -> Matrix:
    """Sizes of some columns that leave the least, for each of several sets of columns."""
    ridge = _ROUNDING * np.trace(among, axis1=1, axis2=2) + np.finfo(float).tiny
    whole = among + ridge[:, None, None] * np.eye(among.shape[-1])
    return np.asarray(np.linalg.solve(whole, along[..., None])[..., 0])


def _errors(systematic: Systematic) -> tuple[list[int], Matrix]:
    """Columns of errors that all rows share, and their factors."""
    return [column for column, _ in systematic], np.array([factor for _, factor in systematic])
