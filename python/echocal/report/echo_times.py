"""Echo times of captures as a table that can be diagnosed, and in words."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from echocal.errors import UsageError
from echocal.waveforms import EchoTimes

COLUMNS = (
    "capture",
    "echo_us",
    "standard_uncertainty_us",
    "peak_amplitude",
    "signal_to_noise_dB",
    "cycle_ambiguity",
    "status",
)
"""Columns of the table; with a full scale, ``amplitude`` stands for ``peak_amplitude``."""

_US = 1e6  # us in a second

_DOUBTFUL = 0.01
"""Cycle ambiguity above which captures are counted: a judgement."""


def echo_table(
    echoes: EchoTimes, beside: Mapping[str, object] | None = None, full_scale: float | None = None
) -> pd.DataFrame:
    """Return a row per capture, in the order of the captures.

    Raises `UsageError` if a column beside has the name of one of the table. Columns that a file has `beside`
    its captures come first. With the amplitude of full scale [unit of the waveform], the amplitude is given
    as a part of it, which is the influence quantity `amplitude`.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = 10.0 * np.log10(echoes.signal_to_noise)
    values = (
        np.arange(1, echoes.time.size + 1),
        _US * echoes.time,
        _US * echoes.standard_uncertainty,
        echoes.amplitude / (full_scale or 1.0),
        np.where(np.isfinite(ratio), ratio, np.nan),
        echoes.cycle_ambiguity,
        echoes.reasons,
    )
    names = (
        COLUMNS if full_scale is None else tuple(n.replace("peak_amplitude", "amplitude") for n in COLUMNS)
    )
    ours = {name: np.ravel(value) for name, value in zip(names, values, strict=True)}
    given = dict(beside or {})
    if taken := sorted(given.keys() & ours.keys()):
        message = f"the file has columns that the table makes: {', '.join(taken)}; rename them in the file"
        raise UsageError(message)
    first = {"capture": ours.pop("capture")}
    return pd.DataFrame({**first, **given, **ours})


def counted(echoes: EchoTimes) -> dict[str, int]:
    """Captures without an echo time, by reason."""
    reasons, counts = np.unique(np.ravel(echoes.reasons), return_counts=True)
    return {str(why): int(count) for why, count in zip(reasons, counts, strict=True) if why}


def said(echoes: EchoTimes) -> str:
    """Say in a line what was found."""
    found = echoes.found
    line = f"Echo times by {echoes.method}: {int(found.sum())} of {found.size} captures"
    if not found.any():
        return line
    spread = _US * float(np.median(echoes.standard_uncertainty[found]))
    doubtful = int((echoes.cycle_ambiguity[found] > _DOUBTFUL).sum())
    cycles = f"; in {doubtful} of them the cycle is doubtful" if doubtful else ""
    return f"{line}; median standard uncertainty {spread:.2g} us{cycles}"
