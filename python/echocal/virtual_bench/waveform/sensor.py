"""A sensor: its transducers, its receiver, the comparator, and the pulse that tells the echo."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from echocal.virtual_bench.waveform.burst import Resonance

__all__ = ["Comparator", "Sensor"]


@dataclass(frozen=True)
class Comparator:
    """Compares the received voltage with a threshold, from the blanking time on.

    Voltages are in units of the carrier that an endless hard wall at one meter would return in air
    without absorption, if the burst never ended.

    Attributes
    ----------
    threshold : float
        The last threshold.
    steps : tuple of (float, float)
        Times since the burst began [s], and the factor of the threshold until then; ascending.
    raised, recovery : float
        What is added to the threshold at first, over the last one, and the time constant [s] with which that
        decays: a controller holds the threshold up while its own burst rings.
    blanking : float
        Time since the burst began from which it listens [s].
    ideal : bool
        Whether it tells the front of the echo itself, and ECHO rises with the burst. No such part exists: it
        takes the time walk away, to show what else is there.
    """

    threshold: float = 0.0127
    steps: tuple[tuple[float, float], ...] = ()
    raised: float = 93.0
    recovery: float = 0.94e-3
    blanking: float = 0.1e-3
    ideal: bool = False

    def at(self, elapsed: np.ndarray) -> np.ndarray:
        """Compute the threshold at times since the burst began [s]."""
        factor = 1.0 + self.raised * np.exp(-elapsed / self.recovery)
        for until, step in reversed(self.steps):
            factor = np.where(elapsed < until, step, factor)
        return np.asarray(self.threshold * factor)


@dataclass(frozen=True)
class Sensor:
    """An ultrasonic ranger; the defaults are an HC-SR04.

    Attributes
    ----------
    frequency : float
        Of the burst [Hz].
    cycles : int
        Of the burst.
    transmitter, receiver : Resonance
        The transducers.
    amplifier : tuple of Resonance
        Stages of the band-pass.
    piston : float
        Radius of the transducers [m].
    spacing : float
        Between their axes [m].
    face : tuple of float
        Half of the width and of the height of the board [m], which returns an echo to the target.
    coupling : float
        Amplitude of the burst that reaches the receiver along the board.
    noise : float
        Standard deviation of the noise before the comparator, in its units.
    comparator : Comparator
    supply_gain : float
        Relative change of the emitted pressure per relative change of the supply.
    zero : float
        Time from the start of the burst to the rise of ECHO [s].
    tick : float
        Of the timer that makes the pulse [s].
    timeout : float
        Longest time after the burst in which an echo is waited for [s].
    """

    frequency: float = 40e3
    cycles: int = 8
    transmitter: Resonance = field(default_factory=lambda: Resonance(40.2e3, 30.0, -40.0))
    receiver: Resonance = field(default_factory=lambda: Resonance(40.5e3, 30.0, -40.0))
    amplifier: tuple[Resonance, ...] = (Resonance(32e3, 1.5),)
    piston: float = 8e-3
    spacing: float = 26e-3
    face: tuple[float, float] = (22.5e-3, 10e-3)
    coupling: float = 0.1
    noise: float = 6e-4
    comparator: Comparator = field(default_factory=Comparator)
    supply_gain: float = 1.0
    zero: float = 0.2e-3
    tick: float = 1e-6
    timeout: float = 36e-3

    @property
    def chain(self) -> tuple[Resonance, ...]:
        """All resonances that the burst passes."""
        return (self.transmitter, self.receiver, *self.amplifier)

    def but(self, **changes: object) -> Self:
        """Return a copy with other numbers; those of the comparator by their names, too."""
        own = {
            name: changes.pop(name)
            for name in ("threshold", "steps", "raised", "recovery", "blanking", "ideal")
            if name in changes
        }
        comparator = replace(self.comparator, **own)  # type: ignore[arg-type]
        return replace(self, comparator=changes.pop("comparator", comparator), **changes)  # type: ignore[arg-type]
