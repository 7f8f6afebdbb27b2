"""What is found in captures: times of echoes, with uncertainty, ambiguity and status."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.shown import Shown

Floats = NDArray[np.float64]

ECHO_STATUSES: tuple[str, ...] = (
    "",
    "not_finite",
    "no_echo",
    "noise_unknown",
    "cut_off",
    "below_threshold",
)
"""Why a capture has no echo time, by code of `EchoTimes.status`; empty for a capture that has one.

- ``not_finite``: a sample between start and stop is infinite or no number.
- ``no_echo``: nothing stands out of the noise; see `echocal.waveforms.detection.FALSE_ALARM`.
- ``noise_unknown``: the echo comes so early that the part before it does not show the noise; give ``noise``.
- ``cut_off``: the strongest echo lies at an end of the window.
- ``below_threshold``: there is an echo, and no crest of it reaches the threshold.
"""


def code(name: str) -> int:
    """Return the code of a status."""
    return ECHO_STATUSES.index(name)


@dataclass(frozen=True, repr=False, eq=False)
class EchoTimes(Shown):
    """Echo times of captures; every array has the shape of the captures without their last axis.

    Attributes
    ----------
    time : ndarray
        Time from the first sample of the capture to the echo [s]; NaN where `status` is not 0.
    standard_uncertainty : ndarray
        Standard uncertainty of `time` from the noise [s], if `time` points to the right cycle of the carrier.
    amplitude : ndarray
        Largest magnitude of the echo's carrier [unit of the waveform]: of the template that fits best.
    signal_to_noise : ndarray
        Ratio 2E/N0 of the echo [1]: its energy, twice, by the density of the noise at the carrier. It is the
        power of the echo by that of the noise behind the matched filter. For white noise it is the sum of the
        squared samples of the echo by the variance of the noise.
    cycle_ambiguity : ndarray
        Probability that another cycle of the carrier is the right one [1]: for `threshold`, that the
        comparator switches in another cycle than without noise; for the other methods, that the error is more
        than half a period.
    noise : ndarray
        Standard deviation of white noise that is as dense as the noise at the carrier [unit of the waveform].
    status : ndarray of uint8
        0 where there is an echo time, else the place in `ECHO_STATUSES` of the reason.
    method : str
        Method.
    carrier : float
        Carrier [Hz].

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> from echocal.waveforms import model_burst
    >>> burst = model_burst(1e6)
    >>> capture = np.random.default_rng(1).normal(0.0, 0.01, 9000)
    >>> capture[5000 : 5000 + len(burst)] += 0.5 * burst
    >>> echoes = echocal.echo_times(capture, 1e6)
    >>> bool(abs(echoes.time - 5e-3) < 4.0 * echoes.standard_uncertainty)
    True
    >>> echocal.echo_times([0.0 * capture], 1e6).reasons
    array(['no_echo'], dtype='<U15')
    """

    time: Floats
    standard_uncertainty: Floats
    amplitude: Floats
    signal_to_noise: Floats
    cycle_ambiguity: Floats
    noise: Floats
    status: NDArray[np.uint8]
    method: str
    carrier: float

    @property
    def reasons(self) -> Any:
        """Reason of each capture without an echo time, empty for the others: an array of str."""
        return np.array(ECHO_STATUSES)[self.status]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether each capture has an echo time."""
        return np.asarray(self.status == 0)
