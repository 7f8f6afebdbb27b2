"""What a sketch measured on the emulated board."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.emulation.inputs import Inputs
from echocal.firmware import Firmware
from echocal.silicon import Played

__all__ = ["TRUTH", "Emulation"]

Column = NDArray[np.float64]

TRUTH = "true_air_degC"
"""Column with the true temperature of the air. It is named like none of a table's quantities."""


@dataclass(frozen=True)
class Emulation:
    """What a sketch measured on the emulated board.

    Attributes
    ----------
    table : DataFrame
        What the sketch printed (``echo_us``, ``reading_m``, ``temperature_C``, as far as it does), the true
        ``distance_m``, the true temperature as `TRUTH`, and further columns of the input.
    inputs : Inputs
        What the board was given: echo times, air, distances.
    played : echocal.silicon.Played
        Lines of the sketch, and codes of the converter.
    name : str
        Name of the sketch.
    firmware : Firmware or None
        What was generated, if the sketch is that of a model.

    Examples
    --------
    >>> import echocal
    >>> found = echocal.emulate("timer_capture", {"temperature_C": [20.0], "echo_us": [11_660.0]})
    >>> found.name, found.played.codes.tolist(), list(found.table)
    ('timer_capture', [[143, -1]], ['echo_us', 'reading_m', 'temperature_C', 'true_air_degC'])
    """

    table: pd.DataFrame
    inputs: Inputs
    played: Played
    name: str
    firmware: Firmware | None = None

    @property
    def echo(self) -> Column:
        """True length of ECHO [s], NaN for a missed echo."""
        return self.inputs.echo

    def errors(self) -> dict[str, Column]:
        """Return what the sketch measured less what is true, for what it printed: [us], [m], [degC].

        Returns
        -------
        dict of str to ndarray, shape (n,)
            ``echo_us``, ``reading_m``, ``temperature_C``; NaN where a row has no value.
        """
        true = {"echo_us": self.echo * 1e6, "temperature_C": self.table[TRUTH].to_numpy(dtype=np.float64)}
        if "distance_m" in self.table:
            true["reading_m"] = self.table["distance_m"].to_numpy(dtype=np.float64)
        measured = {name: self.table[name].to_numpy(dtype=np.float64) for name in true if name in self.table}
        return {name: values - true[name] for name, values in measured.items()}
