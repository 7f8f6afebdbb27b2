"""The registry of noises: one line each."""

from collections.abc import Collection
from importlib import import_module

from echocal.diagnose.noises.common.kinds import (
    FittedNoise,
    NoiseEntry,
    NuisanceNoise,
    OffsetNoise,
    Quantization,
)

__all__ = [
    "NOISES",
    "fitted",
    "listed_only",
    "not_imitated",
    "nuisances",
    "offsets",
    "quantizations",
]


def _noise(id_: str) -> NoiseEntry:
    noise = import_module(f"echocal.diagnose.noises.{id_}").NOISE
    assert isinstance(noise, NoiseEntry)
    return noise


NOISES: tuple[NoiseEntry, ...] = tuple(
    _noise(id_)
    for id_ in (
        "reading_quantization",
        "timer_quantization",
        "temperature_quantization",
        "cycle_offset",
        "slow_level",
        "target_geometry",
        "cycle_slip",
        "noise_growth",
        "polling_jitter",
        "correlated_noise",
        "slow_air",
        "reference_error",
    )
)


def quantizations() -> tuple[Quantization, ...]:
    """Noises that are read off a column."""
    return tuple(noise for noise in NOISES if isinstance(noise, Quantization))


def fitted() -> tuple[FittedNoise, ...]:
    """Noises with a likelihood of their own."""
    return tuple(noise for noise in NOISES if isinstance(noise, FittedNoise))


def not_imitated(present: Collection[str]) -> tuple[FittedNoise, ...]:
    """Noises with a likelihood that no quantization of a table imitates."""
    imitated = {id_ for noise in quantizations() if noise.facts.id in present for id_ in noise.imitates}
    return tuple(noise for noise in fitted() if noise.facts.id not in imitated)


def nuisances() -> tuple[NuisanceNoise, ...]:
    """Noises that every hypothesis includes."""
    return tuple(noise for noise in NOISES if isinstance(noise, NuisanceNoise))


def offsets() -> tuple[OffsetNoise, ...]:
    """Noises that add an offset to each placement of the target."""
    return tuple(noise for noise in NOISES if isinstance(noise, OffsetNoise))


def listed_only() -> frozenset[str]:
    """Ids of noises that no verdict counts: they are no error of the readings."""
    return frozenset(noise.facts.id for noise in nuisances() if not noise.is_answer)
