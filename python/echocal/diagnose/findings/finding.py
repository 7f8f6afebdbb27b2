"""What a detector hands back: rows, their repair, and why a person should believe it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.findings.parts import Parameter
from echocal.observations import Observations

__all__ = ["Finding", "listed", "probability"]

Mask = NDArray[np.bool_]

_SHOWN = 8  # rows that a sentence lists
_CERTAIN = 30.0  # log odds beyond which a float's one is one


def probability(log_bayes: float, prior: float) -> float:
    """Probability of a cause from its log Bayes factor against "no fault"."""
    odds = np.clip(log_bayes + np.log(prior) - np.log1p(-prior), -_CERTAIN, _CERTAIN)
    return float(1 / (1 + np.exp(-odds)))


@dataclass(frozen=True, eq=False)
class Finding:
    """A fault, or a noise, that the data speak for.

    Attributes
    ----------
    facts : CauseFacts
    log_bayes : float
        Log Bayes factor against "no fault".
    because : str
        A sentence with rows and values that a person can check.
    parameters : tuple of Parameter
    rows : ndarray of bool, shape (n,), or None
        Rows of the source concerned.
    repaired : Observations or None
        The table without the fault: repaired values, or rows marked unusable with the reason.
    share : float
        Part of the noise's variance that it makes; what makes little of it is no verdict.
    rms : float
        Standard deviation that it adds to a reading [m], where that is all it does.
    rivals : tuple of str
        What looks the same in these data.
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

    @property
    def cause(self) -> str:
        """Id of the cause."""
        return self.facts.id

    @property
    def probability(self) -> float:
        """That the cause is at work, its prior reckoned with."""
        return probability(self.log_bayes, self.facts.prior)


def listed(rows: Mask | Sequence[int]) -> str:
    """Rows as messages count them: ``rows 3, 7, 12, ... (31 rows)``."""
    mask = np.asarray(rows)
    at = np.flatnonzero(mask) if mask.dtype == bool else mask
    noun = "row" if len(at) == 1 else "rows"
    shown = ", ".join(str(int(row) + 1) for row in at[:_SHOWN])
    return f"{noun} {shown}" + (f", ... ({len(at)} rows)" if len(at) > _SHOWN else "")
