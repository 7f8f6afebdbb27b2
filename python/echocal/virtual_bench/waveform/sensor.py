"""A sensor: its transducers, its receiver, the comparator, and the pulse that tells the echo."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from echocal.virtual_bench.waveform.burst import Resonance
from echocal.virtual_bench.waveform.possible import Limits, check

_TIME, _SPAN = Limits(0.0, unit="s"), Limits(0.0, above=True, unit="s")
_COMPARATOR = {
    "threshold": Limits(0.0, above=True),
    "raised": Limits(0.0),
    "recovery": _SPAN,
    "response_time": Limits(0.0, 1e-5, unit="s"),
    "blanking": _TIME,
}
_SENSOR = {
    "frequency": Limits(0.0, above=True, unit="Hz"),
    "cycles": Limits(1.0),
    "piston": Limits(0.0, above=True, unit="m"),
    "spacing": Limits(0.0, above=True, unit="m"),
    "face": Limits(0.0, above=True, unit="m"),
    "coupling": Limits(0.0),
    "noise": Limits(0.0),
    "burst_scatter": Limits(0.0),
    "supply_gain": Limits(),
    "zero": _TIME,
    "tick": _SPAN,
    "timeout": _SPAN,
}


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
    response_time : float
        How long the voltage must stay above the threshold until the output tells it [s].
    blanking : float
        Time since the burst began from which it listens [s].
    ideal : bool
        Whether it tells the front of the echo itself, and ECHO rises with the burst. No such part exists: it
        takes the time walk away, to show what else is there.

    Notes
    -----
    Nobody has published how the threshold of an HC-SR04 moves. Threshold, rise and recovery are set by hand
    near the best of 550 trials of the desk campaign of docs/virtual-bench.md, which compares slips, time walk
    and the cycles of near placements with one real unit. The fit did not settle: the slips agree within a
    factor of three, and thresholds from 0.0101 to 0.0119 do nearly as well. A plate of 33 x 38 mm is told
    farther than in reality (same page). The response time is an assumption: an LM324 rises by 0.4 V/us
    (STMicroelectronics, LM324 datasheet), so it needs 2 us to turn a transistor on and 5 us to a logic level.
    The blanking is an assumption, too.
    """

    threshold: float = 0.0105
    steps: tuple[tuple[float, float], ...] = ()
    raised: float = 83.0
    recovery: float = 0.82e-3
    response_time: float = 4e-6
    blanking: float = 0.1e-3
    ideal: bool = False

    def __post_init__(self) -> None:
        for name, limits in _COMPARATOR.items():
            check(f"comparator.{name}", getattr(self, name), limits)

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
    burst_scatter : float
        Standard deviation of the logarithm of the pressure from one burst to the next.
    comparator : Comparator
    supply_gain : float
        Relative change of the emitted pressure per relative change of the supply.
    zero : float
        Time from the start of the burst to the rise of ECHO [s].
    tick : float
        Of the timer that makes the pulse [s].
    timeout : float
        Longest time after the burst in which an echo is waited for [s].

    Notes
    -----
    Where the defaults come from:

    - burst: eight cycles of 40 kHz (Elecfreaks, HC-SR04 user guide);
    - transducers: two resonances fitted to the response of one cheap pair of 16 mm cans
      (jdesbonnet/LPC824_Ultrasonic_Ranger at 3b90cbd, doc/40kHz_transducer_freq_curve.dat), which is down by
      6 dB at 39.7 and 41.0 kHz; others are sold with 40 +- 1 kHz and a quality of 24 to 46;
    - band-pass: two simulations of the board tell 18 and 32 kHz (forum of SparkFun, thread 41853);
    - piston: 6 dB down at 27.5 degrees (Pro-Wave 400ST/SR160); TCT40-16 are sold with 40 degrees;
    - noise, scatter of bursts: set by hand with the threshold; the noise also so that it alone crosses the
      threshold in less than 1 % of readings without a target;
    - coupling: pistons in a wall send 1.2 to each other, `directivity(pi / 2)**2 * 2 / spacing`; cans that
      stand free send less to the side, and a quarter of it is an assumption;
    - assumptions without a source: drift of the resonances, quality of the band-pass, supply_gain;
    - board: 45 x 20 mm with cans 26 mm apart, tick of 1 us and time-out of 36 ms: as common units are told;
    - rise of ECHO: at the end of the burst (Haitronic, HC-SR04 manual); two records say 0.08 to 0.24 ms.
    """

    frequency: float = 40e3
    cycles: int = 8
    transmitter: Resonance = field(default_factory=lambda: Resonance(40.27e3, 32.0, -40.0))
    receiver: Resonance = field(default_factory=lambda: Resonance(40.49e3, 32.0, -40.0))
    amplifier: tuple[Resonance, ...] = (Resonance(32e3, 1.5),)
    piston: float = 6.5e-3
    spacing: float = 26e-3
    face: tuple[float, float] = (22.5e-3, 10e-3)
    coupling: float = 0.3
    noise: float = 2.3e-3
    burst_scatter: float = 0.05
    comparator: Comparator = field(default_factory=Comparator)
    supply_gain: float = 1.0
    zero: float = 0.2e-3
    tick: float = 1e-6
    timeout: float = 36e-3

    def __post_init__(self) -> None:
        for name, limits in _SENSOR.items():
            check(f"sensor.{name}", getattr(self, name), limits)

    @property
    def chain(self) -> tuple[Resonance, ...]:
        """All resonances that the burst passes."""
        return (self.transmitter, self.receiver, *self.amplifier)

    def but(self, **changes: object) -> Self:
        """Return a copy with other numbers; those of the comparator by their names, too."""
        known = Comparator.__dataclass_fields__
        own = {name: changes.pop(name) for name in tuple(changes) if name in known}
        comparator = replace(self.comparator, **own)  # type: ignore[arg-type]
        return replace(self, comparator=changes.pop("comparator", comparator), **changes)  # type: ignore[arg-type]
