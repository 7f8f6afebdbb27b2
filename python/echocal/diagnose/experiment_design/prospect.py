"""What each member of a credible set predicts at possible places of measurement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.inference.noise import Noise
from echocal.model import Model

__all__ = ["Prospect"]

Matrix = NDArray[np.float64]

_FREE = 1.0  # m^2: variance of an unknown level
_LEAST = 1e-12  # m^2: 1 um, below the resolution of such sensors; a column of constants has no noise
_EXACT = 0.005  # relative difference below which an effect is an exact alias of another at first order
_TAPE = 1e-3  # m, standard deviation of the distance of a new station: a tape errs by 0.5 to 2 mm


@dataclass(frozen=True)
class Prospect:
    """What each member predicts at possible places of measurement.

    Attributes
    ----------
    shift : ndarray, shape (m, p)
        What a member adds to the reading of the base at each place [m].
    spread : ndarray, shape (m, p, p)
        Covariance of these readings from the uncertainty of the member's parameters [m^2].
    distance, slope : ndarray, shape (p,)
        Distance [m], and derivative of the reading with respect to it.
    variance : float
        Of the innovations [m^2].
    level_known : bool
        Whether the distance of new rows would be known.
    stations : ndarray
        Distances of the stations of the table [m].
    """

    shift: Matrix
    spread: Matrix
    distance: Matrix
    slope: Matrix
    noise: Noise
    variance: float
    level_known: bool
    stations: Matrix

    @classmethod
    def of(
        cls,
        members: Sequence[Member],
        base: Model,
        conditions: dict[str, Matrix],
        noise: Noise,
        variance: float,
        level_known: bool,
        stations: Matrix,
    ) -> "Prospect":
        """Evaluate the model of each member, with its exact derivatives."""
        shifts, spreads = [], []
        reading = base.indicate(**conditions)
        for member in members:
            jacobian = member.model.jacobian(**conditions)
            shifts.append(member.model.indicate(**conditions) - reading)
            covariance = member.model.covariance
            tangents = jacobian[:, 1:]
            none = np.zeros((len(tangents), len(tangents)))
            spreads.append(none if covariance is None else tangents @ covariance @ tangents.T)
            slope = jacobian[:, 0]
        distance = conditions["distance"]
        variance = max(variance, _LEAST)
        found = np.array(shifts), np.array(spreads)
        return cls(*found, distance, slope, noise, variance, level_known, stations)

    def aliases(self, counts: Sequence[int]) -> NDArray[np.int64]:
        """Class of each member, shape (m,): members of a class differ by a constant factor at most.

        Only sets with the same number of causes can be in one class.
        """
        shift = self.shift
        if not self.level_known:
            unit = self.slope / np.linalg.norm(self.slope)
            shift = shift - np.outer(shift @ unit, unit)
        length = np.linalg.norm(shift, axis=1)
        cosine = shift @ shift.T / np.maximum(np.outer(length, length), np.finfo(float).tiny)
        same = (cosine >= 1 - 0.5 * _EXACT**2) & np.equal.outer(counts, counts)
        np.fill_diagonal(same, True)
        return np.asarray(same.argmax(axis=1))  # the first member of the class

    def covariance(self, places: NDArray[np.int64], rows: Sequence[int]) -> Matrix:
        """Covariance of the mean reading at each place; shape (m, designs, k, k)."""
        among = self.spread[:, places[:, :, None], places[:, None, :]]
        at = self.distance[places]
        shot = np.stack([self._of_mean(n, at[:, place]) for place, n in enumerate(rows)], axis=1)
        among = among + shot[:, :, None] * np.eye(len(rows)) + self._of_stations(at)
        if not self.level_known:
            slope = self.slope[places]
            among = among + _FREE * slope[:, :, None] * slope[:, None, :]
        return np.asarray(among)

    def _of_stations(self, at: Matrix) -> Matrix:
        """Covariance from the errors of stations, each of which is in all rows of its station.

        A table with one station does not show how large such errors are. Its parameters include the
        error of that station, which is therefore common to all new stations.
        """
        new = ~np.isin(at, self.stations)
        many = len(self.stations) > 1
        size = self.noise.station_ratio * self.variance if many else _TAPE**2
        own = (at[:, :, None] == at[:, None, :]) & new[:, :, None]
        learned = 0.0 if many else 1.0 * (new[:, :, None] & new[:, None, :])
        return np.asarray(size * (own + learned))

    def _of_mean(self, n: int, distance: Matrix) -> Matrix:
        """Variance of the mean of `n` successive rows with autocorrelated noise, at some distances."""
        rho, theta, lags = self.noise.rho, self.noise.moving_average, np.arange(1, n)
        white = self.variance * self.noise.white_part
        cells = white * self.noise.growth * distance ** (2 if self.noise.whole_path else 1)
        first = white / self.noise.first_weight + cells
        if rho == theta:
            return first / n
        alone = self.variance * (rho - theta) * (1 - rho * theta) / (1 - rho**2)
        second = rho * cells if self.noise.growth else np.full(len(distance), alone)
        return np.asarray((n * first + 2 * second * ((n - lags) * rho ** (lags - 1)).sum()) / n**2)
