"""What a diagnosis says, as data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.findings.parts import (
    Cause,
    Gain,
    NextMeasurement,
    Refuted,
    Traces,
    Unexplained,
    Verdict,
)
from echocal.diagnose.settings import Settings
from echocal.model import Model

__all__ = ["Outcome"]


@dataclass(frozen=True)
class Outcome:
    """What the base simulation gets wrong, and how sure that is.

    Attributes
    ----------
    verdict : str
        ``named``: one class of causes that these data cannot separate holds at least 0.9.
        ``ambiguous``: several may be at work. ``unknown``: something is there that no cause
        explains. ``nothing``: nothing beyond noise.
    causes : tuple of Cause
    posterior : tuple of (tuple of str, float)
        Probability of sets of causes; the empty set is "nothing", ``unknown`` a shape without a
        cause.
    credible_set : tuple of tuple of str
        The smallest number of sets that hold at least 0.95.
    unexplained : Unexplained or None
    refuted : tuple of Refuted
        Causes that fit and yet make rows never fitted worse.
    gain : Gain or None
    next_measurements : tuple of NextMeasurement
    rows, base, noise : mapping
        Rows used and left out; the base simulation; the most probable noise.
    notes : tuple of str
        What a person should know beside the verdict.
    settings : Settings
        Every number that decided the verdict.
    model : Model
        The base extended by the causes that stand in the model. Its ``air`` holds the median of the
        recorded humidity, pressure and CO2: what it assumes where they are not given.
    traces : Traces
        Columns for plots.
    members : tuple of Member
        The sets of causes that the data leave possible, each with its model: what `predict` and
        `correct` average over.
    seconds : float
        What the diagnosis took [s].
    """

    verdict: Verdict
    causes: tuple[Cause, ...]
    posterior: tuple[tuple[tuple[str, ...], float], ...]
    credible_set: tuple[tuple[str, ...], ...]
    unexplained: Unexplained | None
    refuted: tuple[Refuted, ...]
    gain: Gain | None
    next_measurements: tuple[NextMeasurement, ...]
    rows: Mapping[str, Any]
    base: Mapping[str, Any]
    noise: Mapping[str, float]
    notes: tuple[str, ...]
    settings: Settings = field(repr=False)
    model: Model = field(repr=False)
    traces: Traces = field(repr=False)
    members: tuple[Member, ...] = field(repr=False, default=())
    seconds: float = 0.0
