"""The results of a diagnosis, as data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.findings.parts import (
    Cause,
    Gain,
    NextMeasurement,
    Refuted,
    Remainder,
    SmoothCorrection,
    Traces,
    Unexplained,
    Verdict,
)
from echocal.diagnose.results.fates import Fates
from echocal.diagnose.settings import Settings
from echocal.model import Model

__all__ = ["Outcome"]


@dataclass(frozen=True)
class Outcome:
    """What the base simulation gets wrong, with probabilities.

    Attributes
    ----------
    verdict : str
        ``named``: one class of causes that these data cannot separate has a probability of at least
        0.9. ``ambiguous``: several causes can explain the data. ``unknown``: an effect outside the
        catalogue is detected. ``nothing``: no effect is detected.
    causes : tuple of Cause
    posterior : tuple of (tuple of str, float)
        Probability of sets of causes. The empty set is "no effect"; ``unknown`` is an effect
        outside the catalogue.
    credible_set : tuple of tuple of str
        The fewest sets whose probabilities add up to at least 0.95.
    unexplained : Unexplained or None
    refuted : tuple of Refuted
        Causes that fit, but make the error on cross-validated or held-out rows larger.
    gain : Gain or None
    next_measurements : tuple of NextMeasurement
    rows, base, noise : mapping
        Rows used and left out; the base simulation; the most probable noise.
    notes : tuple of str
        What a user should know besides the verdict.
    settings : Settings
        Every number that decided the verdict.
    model : Model
        The base extended by the claimed causes. Its ``air`` holds the median of the recorded
        humidity, pressure and CO2, which the model assumes where they are not given.
    traces : Traces
        Columns for plots.
    fates : Fates
        What became of each row.
    members : tuple of Member
        The possible sets of causes, each with its model. `predict` and `correct` average over them.
    seconds : float
        Time that the diagnosis took [s].
    smooth : SmoothCorrection or None
        A correction without a cause for what the model leaves: smooth functions of recorded columns. None
        if none was tried.
    remainder : Remainder or None
        What is known where the columns could lower the error by far, but nothing is claimed for it.
    moved : str
        How the target moved although its distance is stated to be the same in all rows; empty where not.
    hidden : tuple of str
        Causes that these rows cannot show, whatever their size.
    matters_mm : float
        The difference of a reading from which on it matters [mm].
    matters_because : str
        Where this difference comes from.
    good_enough : bool
        Whether the data show effects, and all of them together change a reading by less than this.
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
    fates: Fates = field(repr=False)
    members: tuple[Member, ...] = field(repr=False, default=())
    seconds: float = 0.0
    smooth: SmoothCorrection | None = None
    remainder: Remainder | None = None
    moved: str = ""
    hidden: tuple[str, ...] = ()
    matters_mm: float = 0.0
    matters_because: str = ""
    good_enough: bool = False
