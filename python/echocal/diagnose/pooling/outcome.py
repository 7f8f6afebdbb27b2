"""The results of a pool, as data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from echocal.diagnose.findings.parts import Gain, Verdict
from echocal.diagnose.pooling.parts import PooledCause, SkippedTable, TableResult
from echocal.diagnose.settings import Settings
from echocal.model import Model

__all__ = ["PooledOutcome"]


@dataclass(frozen=True)
class PooledOutcome:
    """What the base simulation gets wrong about several tables together.

    Attributes
    ----------
    verdict : str
        ``named``: one class of causes that the tables share has a probability of at least 0.9, and its
        model gains on tables left out. ``ambiguous``: tables share something that is not certain enough for
        a name. ``unknown``: two or more tables show an effect outside the catalogue. ``nothing``: no shared
        cause is detected; a table may still have causes of its own.
    causes : tuple of PooledCause
        Causes that the tables are claimed to share.
    posterior : tuple of (tuple of str, float)
        Probability of the sets of causes that all tables share. The empty set is "no shared cause".
    credible_set : tuple of tuple of str
        The fewest sets whose probabilities add up to at least 0.95.
    gain : Gain
        Error on tables left out in turn: the others choose the causes and their sizes.
    tables : mapping of str to TableResult
        By name, in the order of the input.
    skipped : tuple of SkippedTable
        Tables that could not be diagnosed.
    model : Model
        The base extended by the shared causes, with their mean sizes.
    base : mapping
    notes : tuple of str
    settings : Settings
    seconds : float
        Time that the diagnosis took [s].
    """

    verdict: Verdict
    causes: tuple[PooledCause, ...]
    posterior: tuple[tuple[tuple[str, ...], float], ...]
    credible_set: tuple[tuple[str, ...], ...]
    gain: Gain
    tables: Mapping[str, TableResult]
    skipped: tuple[SkippedTable, ...]
    base: Mapping[str, Any]
    notes: tuple[str, ...]
    settings: Settings = field(repr=False)
    model: Model = field(repr=False)
    seconds: float = 0.0
