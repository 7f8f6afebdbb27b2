"""The sequential test: sums over all onsets that are still possible, at constant memory."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from echocal.arrays import Column


@dataclass(frozen=True)
class Onset:
    """When a change began, and which signatures explain it."""

    row: int  # most probable first changed row
    # low, high: the first changed row lies between them, with the probability of the settings
    low: int
    high: int
    rows: int  # rows from the most probable one to the present, both included
    probabilities: Column  # of the signatures, given that one of them began once; shape (j,)
    # sizes, uncertainties: size at the most probable onset of each, and its standard uncertainty; shape (j,)
    sizes: Column
    uncertainties: Column


class Onsets:
    """For each possible onset and each signature, the sums of docs/method/several-tables.md, Eq. 51.

    The last signature is a drift that begins at the onset. Onsets of age a are at most a / `spacing` apart,
    and `longest` is the greatest age [rows].
    """

    def __init__(self, signatures: int, spacing: int, longest: int) -> None:
        self.spacing, self.longest = spacing, longest
        self.rows = np.empty(0, dtype=np.int64)
        self.times = np.empty(0)
        self.past = np.empty((0, signatures))
        self.along = np.empty((0, signatures))
        self.information = np.empty((0, signatures))

    def add(
        self,
        row: int,
        time: float,
        signature: Column,
        score: float,
        noise: tuple[float, float, float],
        weight: float = 1.0,
    ) -> float:
        """Take one row in, and return the largest log likelihood ratio.

        The time is since the test began [days], the signature what each cause adds to this row's residual
        [m], the score its standardized innovation; `noise` is autocorrelation, white part and standard
        deviation of the innovation [m], and `weight` what the signature has been multiplied by, for the
        drift.
        """
        rho, theta, scale = noise
        self._thin(row)
        self.rows = np.append(self.rows, row)
        self.times = np.append(self.times, time)
        blank = np.zeros((1, self.past.shape[1]))
        self.past = np.concatenate([self.past, blank])
        self.along = np.concatenate([self.along, blank])
        self.information = np.concatenate([self.information, blank])
        added = np.empty_like(self.past)
        added[:, :-1] = signature
        added[:, -1] = (time - self.times) * weight
        innovation = added + (theta - rho) * self.past
        self.past *= theta
        self.past += added
        innovation /= scale
        self.along += innovation * score
        self.information += innovation * innovation
        return float(self._ratios().max())

    def _ratios(self) -> Column:
        """Log likelihood ratio of every onset and signature, each with its best size."""
        square = self.along * self.along
        return 0.5 * np.divide(square, self.information, out=np.zeros_like(square), where=square > 0.0)

    def _thin(self, row: int) -> None:
        age = row - self.rows
        octave = np.maximum(age // self.spacing, 1)
        step = 1 << (np.frexp(octave.astype(np.float64))[1] - 1)
        keep = (self.rows % step == 0) & (age < self.longest)
        if not keep.all():
            for name in ("rows", "times", "past", "along", "information"):
                setattr(self, name, getattr(self, name)[keep])

    def onset(self, probability: float) -> Onset:
        """When the change began: posterior over onsets and signatures, sizes as usual (Eq. 55)."""
        information = self.information
        gain = self._ratios() * information / (1.0 + information) - 0.5 * np.log1p(information)
        span = np.diff(self.rows, prepend=self.rows[0] - 1).astype(np.float64)
        weight = np.exp(gain - gain.max()) * span[:, None]
        weight /= weight.sum()
        each = weight.sum(axis=1)
        best = int(np.argmax(each / span))
        order = np.argsort(-each / span, kind="stable")
        inside = order[: int(np.searchsorted(np.cumsum(each[order]), probability)) + 1]
        low, high = int(inside.min()), int(inside.max())
        at = np.argmax(weight / span[:, None], axis=0)
        columns = np.arange(len(at))
        known = information[at, columns] + 1e-300
        return Onset(
            int(self.rows[best]),
            int(self.rows[low] - span[low]) + 1,
            int(self.rows[high]),
            int(self.rows[-1] - self.rows[best]) + 1,
            weight.sum(axis=0),
            self.along[at, columns] / known,
            1.0 / np.sqrt(known),
        )

    def clear(self) -> None:
        """Forget every onset: the test begins anew."""
        self.rows, self.times = self.rows[:0], self.times[:0]
        self.past, self.along, self.information = self.past[:0], self.along[:0], self.information[:0]

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        names = ("rows", "times", "past", "along", "information")
        return {name: getattr(self, name).tolist() for name in names}

    def restore(self, kept: dict[str, Any]) -> None:
        """Take the sums of `to_dict`."""
        width = self.past.shape[1]
        self.rows = np.array(kept["rows"], dtype=np.int64)
        self.times = np.array(kept["times"], dtype=np.float64)
        for name in ("past", "along", "information"):
            setattr(self, name, np.array(kept[name], dtype=np.float64).reshape(-1, width))
