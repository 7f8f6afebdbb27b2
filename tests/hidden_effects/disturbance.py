"""An oracle's noise, 1.5 mm rms of shot noise unless said: white, heavy, remembering, and the tape."""

import numpy as np
from numpy.typing import NDArray

from hidden_effects.designs import Rows

Column = NDArray[np.float64]

SHOT = 1.5e-3  # m


def white(rows: Rows, random: np.random.Generator) -> Column:
    return random.normal(0, SHOT, len(rows))


def heavy(rows: Rows, random: np.random.Generator) -> Column:
    """Student t with 4 degrees of freedom, of the same standard deviation."""
    return SHOT / np.sqrt(2.0) * random.standard_t(4, len(rows))


def remembering(rows: Rows, random: np.random.Generator) -> Column:
    """First-order autoregression, half of the power white."""
    n, rho = len(rows), random.uniform(0.3, 0.95)
    slow = np.empty(n)
    slow[0] = random.normal()
    for i in range(1, n):
        slow[i] = rho * slow[i - 1] + np.sqrt(1 - rho**2) * random.normal()
    share = random.uniform(0.3, 1.0)
    return SHOT * (np.sqrt(share) * slow + np.sqrt(1 - share) * random.normal(size=n))


def convection(rows: Rows, random: np.random.Generator) -> Column:
    """Warm cells drift through the path: an Ornstein-Uhlenbeck process in time, growing with distance."""
    n, memory = len(rows), random.uniform(2, 40) * np.median(np.diff(rows.seconds))
    steps = np.diff(rows.seconds, prepend=rows.seconds[0] - memory)
    cell = np.empty(n)
    cell[0] = random.normal()
    for i in range(1, n):
        keep = np.exp(-steps[i] / memory)
        cell[i] = keep * cell[i - 1] + np.sqrt(1 - keep**2) * random.normal()
    return white(rows, random) * 0.8 + SHOT * 0.6 * cell * np.sqrt(rows.distance / 2)


def tape(rows: Rows, random: np.random.Generator, size: float = 1e-3) -> Column:
    """Error of the reference, one for every stand, or for every row where each has its own [m]."""
    if rows.design == "c":
        return random.normal(0, size, len(rows))
    return random.normal(0, size, rows.stand.max() + 1)[rows.stand]


NOISES = {"normal": white, "student_t4": heavy, "autoregressive": remembering, "convection": convection}
