"""How far the law of a model may be from the speed of sound in true air."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal._core import speed_of_sound
from echocal.budget.sources import Source, of_law
from echocal.errors import DomainWarning
from echocal.model import Model

__all__ = ["published"]

Column = NDArray[np.float64]

_CRAMER = 300e-6
"""Cramer 1993, doi:10.1121/1.405827: 300 ppm."""
_VIRIAL = 110e-6
"""Of `virial` up to a mole fraction of water of 0.06: 43 ppm from two formulations of moist air, and these
65 ppm from each other (docs/physics.md)."""
_HUMIDITIES = (0.0, 0.5, 1.0)
"""Where none is recorded."""
_CARRIER = 40e3  # Hz
_READ = ("temperature", "pressure", "co2_mole_fraction")


def published(model: Model, given: dict[str, Column], count: int) -> tuple[Source, Column]:
    """Source of a model's law, and its half-width relative to the speed of sound, shape (n,).

    For Cramer's law inside of its domain it is what its author states. For any other law it is the
    difference from `virial`, over the humidity that is recorded, else over every humidity, and the
    uncertainty of `virial` in addition. At 40 kHz sound is faster than the laws say, if the model has no
    `dispersion`: this is part of the difference.
    """
    air: dict[str, Any] = {name: given[name] for name in _READ if name in given}
    air = {**{name: own for name, own in model.air.items() if name in _READ}, **air}
    humid = given.get("relative_humidity", model.air.get("relative_humidity"))
    frequency = 0.0 if "dispersion" in model.effects else _CARRIER
    law = Model(model.law)
    worst = np.zeros(count)
    with warnings.catch_warnings(action="ignore", category=DomainWarning):
        for humidity in _HUMIDITIES if humid is None else (humid,):
            true = speed_of_sound(**air, relative_humidity=humidity, law="virial", frequency=frequency)
            assumed = given.get("relative_humidity", model.air.get("relative_humidity", 0.0))
            own = law.speed_of_sound(1.0, **air, relative_humidity=assumed)
            worst = np.maximum(worst, np.abs(np.asarray(own) / true - 1.0))
    half = worst + _VIRIAL
    words = "difference from virial at 40 kHz, and 110 ppm of virial itself"
    if model.law == "cramer":
        half = np.maximum(half, _CRAMER)
        words = f"Cramer 1993: 300 ppm, or where it is more, the {words}"
    law_words = "law of the speed of sound" + (", humidity not recorded" if humid is None else "")
    return replace(of_law(0.0, words), words=law_words), np.broadcast_to(half, (count,))
