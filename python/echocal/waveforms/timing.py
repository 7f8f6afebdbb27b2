"""Echo times of captures: arguments in, blocks of captures through an estimator, arrays out."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.fft import irfft, rfft
from scipy.signal import hilbert

from echocal.errors import UsageError
from echocal.waveforms.baseband import Plan, reach_of
from echocal.waveforms.captures import Captures, captures_of, per_capture, positive
from echocal.waveforms.detection import detect
from echocal.waveforms.estimators import ESTIMATORS, Request, matched_filter
from echocal.waveforms.result import EchoTimes, code
from echocal.waveforms.template import CARRIER, Template, template_of

_LEAST = 10
"""Captures with an echo that a mean needs: of n, the template has 1/n of their noise."""

_ROUNDS = 3
"""Times that captures are aligned with the mean so far; the first time, with the model burst."""

Floats = NDArray[np.float64]

_BAND_PASS = 1 / 8
"""Default bandwidth of the band-pass, of the carrier: that of a burst of 8 cycles."""


def echo_times(
    waveform: ArrayLike,
    sample_rate: float,
    method: str = "matched_filter",
    *,
    template: ArrayLike | str | None = None,
    carrier: float = CARRIER,
    bandwidth: float | None = None,
    threshold: ArrayLike | None = None,
    noise: ArrayLike | None = None,
    start: float = 0.0,
    stop: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> EchoTimes:
    """Time the strongest echo of each capture, to a part of a sample.

    Parameters
    ----------
    waveform : array_like, shape (..., N)
        Captures; the last axis is the time. Any unit: volts, counts, full scale.
    sample_rate : float
        Samples per second [Hz], above twice the carrier plus the bandwidth.
    method : str
        - ``matched_filter``: the delay at which the template fits best. It reaches the Cramer-Rao bound where
          the cycle is right.
        - ``phase``: the phase of the carrier, in the cycle that the rise of the envelope points to.
        - ``envelope``: the rise of the envelope to half of its maximum. Knows no cycles.
        - ``threshold``: the first crossing of a level, as in a comparator; not the origin of the template,
          and later for weaker echoes.
    template : array_like of shape (L,), "mean" or None
        The echo without noise, at the same sample rate; the echo time is that of its first sample. ``"mean"``
        takes the mean of the captures, aligned. None takes `echocal.waveforms.model_burst`: 8 cycles of
        the carrier through two resonances.
    carrier : float
        Frequency of the burst [Hz].
    bandwidth : float, optional
        Full width at half of the power of the band-pass of `threshold`, `envelope` and `phase`, in which
        the noise is estimated as well [Hz]; default: an eighth of the carrier.
    threshold : array_like, optional
        Level of `threshold` [unit of the waveform] behind the band-pass; one number, or one per capture.
        Default: 6 standard deviations of the noise there.
    noise : array_like, optional
        Standard deviation of white noise in the captures [unit of the waveform]; one number, or one per
        capture. Default: estimated at the carrier, in the part of each capture before its echo.
    start, stop : float
        Window of each capture [s] that is used. It should begin after the burst's own ringing.
    progress : callable, optional
        Called with the number of captures that are done, and of all.

    Returns
    -------
    EchoTimes
        Times [s] from the first sample of a capture, whatever `start` is.

    Raises
    ------
    UsageError
        If the method is not known, the sample rate too low, an argument out of its range, or a capture
        shorter than the template.
    DataError
        If `waveform` does not hold real numbers.

    See Also
    --------
    echocal.read_waveforms : Read captures.
    echocal.waveforms.cramer_rao_bound : The least standard uncertainty.

    References
    ----------
    Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, sections 3.5 and 7.10.
    Quazi 1981, doi:10.1109/TASSP.1981.1163618.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> from echocal.waveforms import model_burst
    >>> burst = model_burst(500e3)
    >>> captures = np.random.default_rng(1).normal(0.0, 0.02, (2, 6000))
    >>> captures[0, 3000 : 3000 + len(burst)] += burst
    >>> captures[1, 1] = np.nan
    >>> echoes = echocal.echo_times(captures, 500e3)
    >>> np.round(1e6 * echoes.time, 1)
    array([6000.,   nan])
    >>> echoes.reasons
    array(['', 'not_finite'], dtype='<U15')
    """
    if not isinstance(method, str) or method not in ESTIMATORS:
        raise UsageError(f"method is {method!r}; there are {', '.join(ESTIMATORS)}")
    sample_rate, carrier = positive("sample_rate", sample_rate, "Hz"), positive("carrier", carrier, "Hz")
    width = _BAND_PASS * carrier if bandwidth is None else positive("bandwidth", bandwidth, "Hz")
    _refuse_band(sample_rate, carrier, width)
    captures = captures_of(waveform, sample_rate, start, stop)
    shape = captures.shape
    plan = Plan(_template(template, captures, carrier, width), carrier, width, captures.count)
    levels = None if threshold is None else per_capture("threshold", threshold, shape)
    noises = None if noise is None else per_capture("noise", noise, shape)
    parts = []
    for part in _parts(captures, replace(Request.of(plan), threshold=levels), noises, method):
        parts.append(part)
        if progress is not None:
            progress(sum(len(own["status"]) for own in parts), len(captures.rows))
    found = {name: np.concatenate([part[name] for part in parts]).reshape(shape) for name in parts[0]}
    found["time"] += captures.start
    return EchoTimes(**found, method=method, carrier=carrier)


def _refuse_band(sample_rate: float, carrier: float, bandwidth: float) -> None:
    least = 2.0 * (carrier + bandwidth)
    if sample_rate < least:
        raise UsageError(
            f"sample_rate is {sample_rate:g} Hz, too low for a carrier of {carrier:g} Hz: it must be at "
            f"least twice (Nyquist) the carrier plus the bandwidth of {bandwidth:g} Hz, {least:g} Hz"
        )
    if bandwidth > carrier:
        raise UsageError(f"bandwidth is {bandwidth:g} Hz; give at most the carrier, {carrier:g} Hz")


def _refuse_narrow(captures: Captures, bandwidth: float) -> None:
    """Refuse a band-pass that answers for longer than a capture lasts."""
    duration = captures.count / captures.sample_rate
    if 2.0 * reach_of(bandwidth) > duration:
        raise UsageError(
            f"bandwidth is {bandwidth:g} Hz: such a band-pass answers for {2.0 * reach_of(bandwidth):g} s, "
            f"and a capture (from start to stop) lasts {duration:g} s; give at least "
            f"{2.0 * reach_of(1.0) / duration:.3g} Hz, or longer captures"
        )


def _template(
    given: ArrayLike | str | None, captures: Captures, carrier: float, bandwidth: float
) -> Template:
    rate = captures.sample_rate
    of_captures = isinstance(given, str) and given == "mean"
    template = template_of(None if of_captures else given, rate, carrier, captures.count)
    _refuse_narrow(captures, bandwidth)
    return averaged(captures, carrier, bandwidth) if of_captures else template


def _parts(
    captures: Captures, request: Request, noise: Floats | None, method: str
) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the arrays of `EchoTimes` for block after block."""
    reference = np.abs(request.reference.matched.at(np.array([request.reference_time]))[0])[0]
    scale = request.plan.template.amplitude / reference
    for place, block, finite in captures.blocks():
        found = detect(request.plan, block, None if noise is None else noise[place])
        estimate = ESTIMATORS[method](request.of_block(place), found)
        status = found.status.copy()
        if estimate.missing is not None:
            status[(status == 0) & estimate.missing] = code("below_threshold")
        status[~finite] = code("not_finite")
        with np.errstate(invalid="ignore", divide="ignore"):
            yield {
                "time": np.where(status == 0, estimate.time, np.nan),
                "standard_uncertainty": np.where(
                    status == 0, estimate.standard_uncertainty * found.inflation, np.nan
                ),
                "cycle_ambiguity": np.where(status == 0, estimate.cycle_ambiguity, np.nan),
                "amplitude": np.where(finite, found.peak * scale, np.nan),
                "signal_to_noise": np.where(finite, (found.peak / found.noise) ** 2, np.nan),
                "noise": np.where(finite, found.noise, np.nan),
                "status": status,
            }


def averaged(captures: Captures, carrier: float, bandwidth: float) -> Template:
    """Return the mean echo of captures, from about where the model burst begins.

    Raises `UsageError` if too few captures have an echo.
    """
    template = template_of(None, captures.sample_rate, carrier, captures.count)
    template = _turned(captures, Plan(template, carrier, bandwidth, captures.count))
    for _ in range(_ROUNDS):
        template = _aligned(captures, Plan(template, carrier, bandwidth, captures.count))
    return template


def _turned(captures: Captures, plan: Plan) -> Template:
    """Turn the carrier of the template by a phase, so that it fits the captures where the envelopes fit.

    Otherwise a real echo of another phase, such as behind an amplifier that inverts, fits two cycles alike.
    """
    total = 0j
    for _, block, finite in captures.blocks():
        found = detect(plan, block, None)
        good = (found.status == 0) & finite
        value = found.matched.carried(found.time)[0][good]
        total += complex(np.sum(value * np.abs(value) / found.noise[good] ** 2))
    analytic = hilbert(plan.template.samples, 2 * len(plan.template.samples))
    turned = (analytic * np.exp(1j * np.angle(total))).real[: len(plan.template.samples)]
    return Template(turned, plan.sample_rate)


def _aligned(captures: Captures, plan: Plan) -> Template:
    """Fit the echo to all captures by least squares, at the times and strengths by the template so far."""
    request = Request.of(plan)
    angular = 2j * np.pi * plan.frequencies
    total: NDArray[np.complex128] = np.zeros(plan.count // 2 + 1, complex)
    norm, count = 0.0, 0
    for _, block, finite in captures.blocks():
        found = detect(plan, block, None)
        good = (found.status == 0) & finite
        time, strength = matched_filter(request, found).time[good], found.peak[good]
        weights = strength / found.noise[good] ** 2
        spectra = rfft(block[good], plan.count)[:, plan.band]
        total[plan.band] += np.einsum("i,ij,ij->j", weights, spectra, np.exp(angular * time[:, None]))
        norm += float(weights @ strength)
        count += int(good.sum())
    if count < _LEAST:
        raise UsageError(
            f'template is "mean", and {count} captures have an echo before which there is enough noise; '
            f"give at least {_LEAST}, or an echo as template"
        )
    mean = irfft(total / norm, plan.count)[: len(plan.template.samples)]
    return Template(mean * np.linalg.norm(plan.template.samples) / np.linalg.norm(mean), plan.sample_rate)
