"""Noises: causes that change the distribution of readings.

One file a noise: its facts, its thresholds, what it does to a table, and its likelihood or its
detector. `registry` lists them; `common` is what they share. The noise models that every hypothesis
includes are in `echocal.diagnose.inference.noise` and rust/infer/src/noise.
"""

from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.quantization import find_steps
from echocal.diagnose.settings.noises import NoiseSettings

__all__ = ["NoiseSettings", "find_steps", "noises"]


def noises() -> tuple[CauseFacts, ...]:
    """Return what is known about causes that change the distribution of readings.

    Examples
    --------
    >>> import echocal
    >>> "timer_quantization" in [noise.id for noise in echocal.noises()]
    True
    """
    return tuple(noise.facts for noise in registry.NOISES)
