"""The burst as it leaves a chain of resonances, in closed form.

A sine of whole cycles excites resonances one after the other: the two transducers and the
band-pass of the receiver. The answer of such a chain is a sum of decaying exponentials, one for
each resonance, and the carrier itself while the burst lasts.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.virtual_bench.waveform.possible import Limits, check

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]

_APART = 1e-5  # relative: resonances at one frequency are set apart by so much, which divides by it


@dataclass(frozen=True)
class Resonance:
    """A resonant band-pass of second order, with gain 1 at its center.

    Attributes
    ----------
    center : float or ndarray, shape (n,)
        Center frequency [Hz].
    quality : float
        Quality factor: the center over the width between the points at -3 dB.
    drift : float
        Change of the center with the temperature [Hz/K], from 25 degC on.
    """

    center: float | Column = 40e3
    quality: float = 20.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        check("center of a resonance", self.center, Limits(0.0, above=True, unit="Hz"))
        check("quality of a resonance", self.quality, Limits(0.5, above=True, way_out="it must ring"))

    def at(self, temperature: ArrayLike) -> Column:
        """Compute the center frequency [Hz] at a temperature [degC]."""
        return np.asarray(self.center + self.drift * (np.asarray(temperature, dtype=float) - 25.0))


@dataclass(frozen=True)
class BurstResponse:
    """What a chain of resonances makes of a burst: `Re[envelope(t) exp(2 pi i frequency t)]`."""

    frequency: float  # of the carrier [Hz]
    length: float  # of the burst [s]
    carrier: Phasor  # steady answer to the carrier; shape (n,)
    rates: Phasor  # decay of each resonance beside the carrier [1/s]; shape (n, k)
    # sizes, after: their phasors while the burst lasts, and after it; shape (n, k)
    sizes: Phasor
    after: Phasor

    @classmethod
    def of(
        cls, chain: Sequence[Resonance], frequency: float, cycles: int, temperature: ArrayLike = 25.0
    ) -> "BurstResponse":
        """Compute the answer of a chain to a burst of unit amplitude.

        The carrier is in Hz, and the temperature of the resonances, shape (n,), in degC.
        """
        celsius = np.atleast_1d(np.asarray(temperature, dtype=float))
        omega = 2 * np.pi * frequency
        poles = []
        for place, one in enumerate(chain):
            center = 2 * np.pi * one.at(celsius) * (1 + _APART * place)
            poles.append(center * (-0.5 / one.quality + 1j * np.sqrt(1 - 0.25 / one.quality**2)))
        found = np.stack(poles, axis=-1)
        widths = np.stack([2 * np.pi * one.at(celsius) / one.quality for one in chain], axis=-1)

        def residue(at: Phasor, own: int | None) -> Phasor:
            value = np.prod(widths * at[:, None], axis=-1) * omega
            for place in range(found.shape[1]):
                value = value / (at - found[:, place].conj())
                if place != own:
                    value = value / (at - found[:, place])
            return np.asarray(value / (at + 1j * omega if own is None else at**2 + omega**2))

        # Twice: the conjugate poles give the other half of the real answer; -i is the phase of a sine.
        carrier = 2 * residue(np.full(len(celsius), 1j * omega), None)
        sizes = np.stack([2 * residue(found[:, k], k) for k in range(found.shape[1])], axis=-1)
        rates = found - 1j * omega
        length = cycles / frequency
        return cls(frequency, length, carrier, rates, sizes, sizes * (1 - np.exp(-rates * length)))

    @property
    def peak(self) -> float:
        """The most that an envelope reaches, 5 % more to be safe; looked for in nine of the answers.

        A chain of k resonances that decay at a rate of a answers to a short burst most (k - 1) / a after it.
        """
        some = np.argsort(np.abs(self.carrier))[np.linspace(0, len(self.carrier) - 1, 9).astype(int)]
        longest = self.rates.shape[1] / float(np.abs(self.rates.real).min())
        at = np.linspace(0.0, 4 * self.length + longest, 257)
        return float(1.05 * np.abs(self.at(some).envelope(np.tile(at, (9, 1)))).max())

    def at(self, rows: NDArray[np.int64]) -> "BurstResponse":
        """Return the answers of some rows."""
        if len(self.carrier) == 1:
            return self
        return BurstResponse(
            self.frequency,
            self.length,
            self.carrier[rows],
            self.rates[rows],
            self.sizes[rows],
            self.after[rows],
        )

    def envelope(self, elapsed: Column, step: float | None = None) -> Phasor:
        """Compute the complex envelope at times since the front of the burst.

        `elapsed`, shape (n, ...), is since the front arrived [s]; before it there is nothing. Where the
        `step` between neighbors along the last of two axes [s] is the same everywhere, this is faster.
        """
        shape = (slice(None), *(None,) * (elapsed.ndim - 1))
        late = elapsed >= self.length
        since = np.maximum(elapsed, 0.0) if step is None else elapsed
        total = np.where(late, 0.0, self.carrier[shape])
        for k in range(self.rates.shape[1]):
            size = np.where(late, self.after[:, k][shape], self.sizes[:, k][shape])
            total += size * _decay(self.rates[:, k][shape], since, step)
        total[elapsed < 0] = 0.0
        return np.asarray(total)


def _decay(rate: Phasor, since: Column, step: float | None) -> Phasor:
    """Compute exp(rate * since); on a grid by products."""
    if step is None:
        return np.asarray(np.exp(rate * since))
    powers = np.ones((len(rate), since.shape[1]), dtype=complex)
    powers[:, 1:] = np.exp(rate * step)
    return np.asarray(np.exp(rate * since[:, :1]) * np.multiply.accumulate(powers, axis=1))
