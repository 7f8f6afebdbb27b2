"""An oracle's noise, 1.5 mm rms of shot noise unless said: white, heavy, remembering, and the tape."""

import numpy as np
from numpy.typing import NDArray

from hidden_effects import designs
from hidden_effects.designs import Rows

Column = NDArray[np.float64]

SHOT = 1.5e-3  # m


def white(rows: Rows, random: np.random.Generator) -> Column:
    return random.normal(0, SHOT, len(rows))


def heavy(rows: Rows, random: np.random.Generator) -> Column:
    """Student t with 4 degrees of freedom, of the same standard deviation."""
    return SHOT / np.sqrt(2.0) * random.standard_t(4, len(rows))


def remembering(rows: Rows, random: np.random.Generator) -> Column:
    """First-order autoregression, some of the power white."""
    slow = designs.remembering(len(rows), random.uniform(0.3, 0.95), random)
    share = random.uniform(0.3, 1.0)
    return SHOT * (np.sqrt(share) * slow + np.sqrt(1 - share) * random.normal(size=len(rows)))


def convection(rows: Rows, random: np.random.Generator) -> Column:
    """Warm cells drift through the path: memory of some rows, growing with distance, not stationary."""
    cell = designs.remembering(len(rows), np.exp(-1 / random.uniform(2, 40)), random)
    return white(rows, random) * 0.8 + SHOT * 0.6 * cell * np.sqrt(rows.distance / 2)


def tape(rows: Rows, random: np.random.Generator, size: float = 1e-3) -> Column:
    """Error of the reference, one for every stand, or for every row where each has its own [m]."""
    if rows.design == "c":
        return random.normal(0, size, len(rows))
    return random.normal(0, size, rows.stand.max() + 1)[rows.stand]


NOISES = {"normal": white, "student_t4": heavy, "autoregressive": remembering, "convection": convection}
