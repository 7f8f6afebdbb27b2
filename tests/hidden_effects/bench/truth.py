"""What may be said about a table of the bench: the planted names, and what is always there."""

from collections.abc import Callable

import numpy as np

from echocal.virtual_bench import CAUSES, Simulation
from hidden_effects.bench.world import Case

MISTAKES = frozenset(id_ for id_, cause in CAUSES.items() if cause.stage.__module__.endswith("bookkeeping"))
"""Mistakes of firmware and logger."""

UNFORESEEN = frozenset(id_ for id_, cause in CAUSES.items() if not cause.in_catalogue) - MISTAKES
"""Causes that the catalogue does not have: right is that something is there that it cannot name."""

NOISES = frozenset(
    {
        "correlated_noise",
        "cycle_slip",
        "noise_growth",
        "polling_jitter",
        "reading_quantization",
        "reference_error",
        "target_geometry",
        "temperature_quantization",
        "timer_quantization",
    }
)
"""Causes that change the scatter."""

FAULTS = frozenset({"crosstalk", "mistyped_rows", "stuck_reading", "timeout", "blanking_distance"})
"""Causes that spoil single rows."""

NAMES: dict[str, frozenset[str]] = {
    "beam_edge": frozenset({"beam_edge", "obstruction"}),
    "correlated_noise": frozenset({"correlated_noise", "slow_air"}),
    "divisor": frozenset({"fixed_speed"}),  # cm = us / 58 is a device with 344.8 m/s
    "wind": frozenset({"wind_along", "wind_across"}),
}
"""Names of the catalogue for causes that the bench calls otherwise, or that two names tell."""

_AIR = frozenset({"dispersion", "correlated_noise", "slow_air", "noise_growth", "timer_quantization"})
_SHAPE = frozenset({"transducer_spacing"})  # 26 mm of an HC-SR04 are on the bench, and not in the base
_WALK = frozenset({"amplitude_walk", "receiver_recovery", "fixed_delay", "cycle_slip", "cycle_offset"})
_BROUGHT = {
    "mistyped_rows": frozenset(
        {"fixed_speed", "reading_quantization"}
    ),  # who types, types a display's millimeters
    "polling_jitter": frozenset({"fixed_delay", "zero_error"}),  # its mean
    "reading_quantization": frozenset({"fixed_speed"}),  # who cuts off to centimeters reckons with 343 m/s
}
_DRY_LAW = frozenset({"humidity", "unrecorded_humidity", "linear_speed_law", "pressure"})

Value = Callable[[Simulation, float], float]


def names(id_: str) -> frozenset[str]:
    """Ids of the catalogue that name a cause of the bench."""
    return NAMES.get(id_, frozenset({id_}))


def companions(case: Case) -> frozenset[str]:
    """Causes that are truly there beside the planted ones.

    Sound of 40 kHz is faster than the laws of frequency zero say, the transducers stand apart, the air is
    slow and turbulent, the timer ticks, whoever reads a tape errs, and no target stands quite straight. A
    comparator brings its time walk, a constant delay, and missed periods, single or of a whole placement.
    """
    made = case.made
    found = _AIR | _SHAPE
    if "distance_m" in made.table:
        found |= {"reference_error"}
    if made.detector == "comparator":
        found |= _WALK
    if case.options["base"] == "linear":
        found |= _DRY_LAW
    return found.union(*(_BROUGHT.get(id_, frozenset()) for id_ in case.spec.causes))


def _same(made: Simulation, size: float) -> float:
    return size


PARAMETERS: dict[str, tuple[str, str, Value]] = {
    "fixed_delay": ("fixed_delay", "delay", _same),
    "zero_error": ("zero_error", "offset", _same),
    "clock_error": ("clock_error", "frequency_error", _same),
    "clock_temperature_coefficient": ("clock_temperature_coefficient", "coefficient", _same),
    "interrupt_loss": ("interrupt_loss", "loss", _same),
    "temperature_offset": ("temperature_offset", "offset", _same),
    "temperature_gain": ("temperature_gain", "gain", _same),
    "temperature_lag": ("temperature_lag", "time_constant", _same),
    "temperature_self_heating": ("temperature_self_heating", "rise", _same),
    "temperature_radiation": ("temperature_radiation", "gain", lambda _, size: 1e-3 * size),
    "temperature_gradient": ("temperature_gradient", "gradient", _same),
    "thermometer_mix": ("thermometer_mix", "weight", _same),
    "gas_composition": ("gas_composition", "excess", _same),
    "reference_scale": ("reference_scale", "scale", lambda _, size: 1 / (1 + size) - 1),
    "oblique_target": ("oblique_target", "shortening", lambda _, size: 1 - np.cos(size)),
    "drift": ("drift", "rate", lambda made, size: size / float(np.ptp(made.campaign.seconds))),
    "step_change": ("step_change", "offset", _same),
    "fixed_speed": ("fixed_speed", "speed", _same),
    "divisor": ("fixed_speed", "speed", lambda _, size: 2e4 / round(size)),
    "polling_jitter": ("polling_jitter", "mean", _same),
    "timer_quantization": ("timer_quantization", "step", _same),
    "temperature_quantization": ("temperature_quantization", "step", _same),
    "reading_quantization": ("reading_quantization", "step", lambda _, size: 1e-2 * size),
}
"""Id and parameter of the catalogue that hold the size of a cause, and how; by the id of the bench."""
