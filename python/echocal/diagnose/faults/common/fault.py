"""What the file of a fault hands to the registry."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.causes import NoThresholds
from echocal.diagnose.settings.faults import FaultSettings
from echocal.observations import Observations
from echocal.observations.marks import RowRule

__all__ = ["Fault", "Found"]


@dataclass(frozen=True, eq=False)
class Found:
    """What a detector found.

    Attributes
    ----------
    rows : ndarray of bool, shape (n,)
        Rows concerned.
    log_bayes : float
        Log Bayes factor against "no fault".
    because : str
        A sentence with rows and values that a user can check.
    sizes : tuple
        Of the parameters in the order of the facts: each a value, or a value with its standard uncertainty.
    repaired : Observations, optional
        The table without the fault. Default: the rows are marked as unusable.
    rules : tuple of RowRule
        By which a correction finds such rows in another table.
    share : float
        Its part of the variance of the noise; 0 where no verdict counts it.
    rivals : tuple of str
        Causes that these rows cannot separate from it.
    """

    rows: NDArray[np.bool_]
    log_bayes: float
    because: str
    sizes: tuple[float | tuple[float, float], ...]
    repaired: Observations | None = field(default=None, repr=False)
    rules: tuple[RowRule, ...] = ()
    share: float = 1.0
    rivals: tuple[str, ...] = ()


@dataclass(frozen=True)
class Fault:
    """A fault of single rows or of whole columns.

    Attributes
    ----------
    facts : CauseFacts
    detect : callable
        Looks for the fault in a view of a table, by its own thresholds and those that faults share. It is
        not asked where a column is missing that the facts say it needs.
    spoil : callable
        What the fault does to a table: changes it in place. The tests plant the fault with it.
    thresholds : object
        Defaults of the numbers that `detect` decides by.
    """

    facts: CauseFacts
    detect: Callable[[View, Any, FaultSettings], Found | None]
    spoil: Callable[[Columns, np.random.Generator], None]
    thresholds: object = NoThresholds()

    def search(self, view: View, settings: FaultSettings) -> Finding | None:
        """Look for the fault in a view of a table; None where there is no sign of it."""
        held = {*view.observations.conditions, *(() if view.reference is None else ("reference_distance",))}
        if not held.issuperset(self.facts.needs):
            return None
        found = self.detect(view, settings.of(self.facts, type(self.thresholds)), settings)
        if found is None:
            return None
        sizes = (size if isinstance(size, tuple) else (size, 0.0) for size in found.sizes)
        each = zip(self.facts.parameters, sizes, strict=True)
        return Finding(
            settings.facts(self.facts),
            float(np.clip(found.log_bayes, -settings.cap, settings.cap)),
            found.because,
            tuple(Parameter(quantity.name, float(v), u, quantity.unit) for quantity, (v, u) in each),
            found.rows,
            view.without(found.rows, self.facts.id) if found.repaired is None else found.repaired,
            found.share,
            rivals=found.rivals,
            rules=found.rules,
        )
