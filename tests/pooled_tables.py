"""Tables of several units for the tests of a pool."""

import numpy as np

from echocal.model import Model

Columns = dict[str, np.ndarray]

STEP = 20.0  # s from row to row


def unit(
    random: np.random.Generator,
    time_constant: float = 0.0,
    *,
    noise: float = 5e-3,
    rows: int = 250,
    visible: float | None = None,
) -> Columns:
    """Rows of one unit at 1 m, whose thermometer lags by a time constant [s].

    With `visible`, the noise [m] is such that the lag has this signal-to-noise ratio, summed over rows, and
    none of it lies along the lag: the estimate is exactly so many standard deviations.
    """
    time = np.arange(rows) * STEP
    period = random.uniform(3e3, 5e3)
    celsius = 15.0 + 8.0 * np.sin(2 * np.pi * time / period + random.uniform(0.0, 6.0))
    late = celsius + time_constant * np.gradient(celsius, time)
    model = Model("linear")
    true, told = (model.speed_of_sound(1.0, temperature=one) for one in (late, celsius))
    signal = told / true - 1.0
    left = random.normal(0.0, noise, rows)
    if visible is not None:
        centered = signal - signal.mean()
        left = random.normal(0.0, np.linalg.norm(centered) / visible, rows)
        left -= centered * (centered @ left) / (centered @ centered)
    return {
        "reading_m": 1.0 + signal + left,
        "temperature_C": celsius,
        "time_s": time,
        "distance_m": np.ones(rows),
    }
