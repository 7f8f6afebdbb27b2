"""Result of a detector: rows, their repair, and evidence that a user can check."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.findings.parts import Parameter
from echocal.observations import Observations
from echocal.observations.marks import RowRule

__all__ = ["Finding", "listed", "probability"]

Mask = NDArray[np.bool_]

_SHOWN = 8  # rows that a sentence lists
_CERTAIN = 30.0  # log odds beyond which a probability rounds to one


def probability(log_bayes: float, prior: float) -> float:
    """Probability of a cause from its log Bayes factor against "no fault"."""
    odds = np.clip(log_bayes + np.log(prior) - np.log1p(-prior), -_CERTAIN, _CERTAIN)
    return float(1 / (1 + np.exp(-odds)))


@dataclass(frozen=True, eq=False)
class Finding:
    """A fault or a noise that the data support.

    Attributes
    ----------
    log_bayes : float
        Log Bayes factor against "no fault".
    because : str
        A sentence with rows and values that a user can check.
    rows : ndarray of bool, shape (n,), or None
        Rows of the source concerned.
    repaired : Observations or None
        The table without the fault: values are repaired, or rows are marked as unusable.
    share : float
        Its part of the variance of the noise. A small part does not count for the verdict.
    rms : float
        Standard deviation that it adds to a reading [m], if this is its only effect.
    rivals : tuple of str
        Causes that these data cannot separate from it.
    rules : tuple of RowRule
        By which a correction finds such rows in another table, or in a part of one.
    """

    facts: CauseFacts
    log_bayes: float
    because: str
    parameters: tuple[Parameter, ...] = ()
    rows: Mask | None = None
    repaired: Observations | None = field(default=None, repr=False)
    share: float = 1.0
    rms: float = np.inf
    rivals: tuple[str, ...] = ()
    rules: tuple[RowRule, ...] = ()

    @property
    def cause(self) -> str:
        """Id of the cause."""
        return self.facts.id

    @property
    def probability(self) -> float:
        """Posterior probability of the cause."""
        return probability(self.log_bayes, self.facts.prior)


def listed(rows: Mask | Sequence[int]) -> str:
    """Rows in a message, counted from 1: ``rows 3, 7, 12, ... (31 rows)``."""
    mask = np.asarray(rows)
    at = np.flatnonzero(mask) if mask.dtype == bool else mask
    noun = "row" if len(at) == 1 else "rows"
    shown = ", ".join(str(int(row) + 1) for row in at[:_SHOWN])
    return f"{noun} {shown}" + (f", ... ({len(at)} rows)" if len(at) > _SHOWN else "")
