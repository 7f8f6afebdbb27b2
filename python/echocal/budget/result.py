"""Budgets as a result: for each row what its distance is uncertain by, and why."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.budget.coverage import coverage_factor
from echocal.budget.entries import Entry, Itemized
from echocal.budget.monte_carlo import MonteCarlo
from echocal.shown import Shown


@dataclass(frozen=True, repr=False)
class Budget(Shown):
    """Uncertainty budgets of corrected distances (JCGM 100:2008), one for each row.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        Corrected distances [m]; NaN where there is none.
    conditions : mapping of str to ndarray, shape (n,)
        Recorded influence quantities [SI].
    row : ndarray of int, shape (n,)
        Row of the table, or of the grid; 1 is the first.
    itemized : Itemized
        The entries: source, type, distribution, standard uncertainty, sensitivity, degrees of freedom.
    coverage : float
        Coverage probability.
    monte_carlo : MonteCarlo or None
        The same by drawing (JCGM 101:2008), for the rows of `monte_carlo_rows`.
    monte_carlo_rows : ndarray of int
        Places of these rows.
    model_hash : str
    notes : tuple of str

    Examples
    --------
    >>> import echocal
    >>> air, stated = {"temperature": 20.0, "relative_humidity": 0.5}, {"thermometer": "DHT22"}
    >>> found = echocal.budget("cramer", distance=2.0, **air, uncertainties=stated)
    >>> (1e3 * found.standard_uncertainty).round(2).tolist(), found.coverage_factor.round(2).tolist()
    ([1.11], [2.0])
    """

    distance: Column
    conditions: Mapping[str, Column]
    row: NDArray[np.int64]
    itemized: Itemized
    coverage: float
    monte_carlo: MonteCarlo | None
    monte_carlo_rows: NDArray[np.int64]
    model_hash: str
    notes: tuple[str, ...] = ()

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The lines of the budgets."""
        return self.itemized.entries

    @property
    def standard_uncertainty(self) -> Column:
        """Combined standard uncertainty, shape (n,) [m]."""
        return np.where(np.isnan(self.distance), np.nan, self.itemized.standard_uncertainty)

    @property
    def degrees_of_freedom(self) -> Column:
        """Effective degrees of freedom (Welch and Satterthwaite), shape (n,)."""
        return self.itemized.degrees_of_freedom

    @property
    def coverage_factor(self) -> Column:
        """Coverage factor k, shape (n,)."""
        return coverage_factor(self.degrees_of_freedom, self.coverage)

    @property
    def expanded_uncertainty(self) -> Column:
        """Expanded uncertainty U, shape (n,) [m]."""
        return self.coverage_factor * self.standard_uncertainty

    def to_dict(self) -> dict[str, Any]:
        """Plain data, schema ``echocal.budget/1``; SI units."""
        shares, place = self.itemized.shares, {int(i): j for j, i in enumerate(self.monte_carlo_rows)}
        rows = []
        for i in range(len(self.distance)):
            own: dict[str, Any] = {
                "row": int(self.row[i]),
                "distance": float(self.distance[i]),
                "conditions": {name: float(values[i]) for name, values in self.conditions.items()},
                "standard_uncertainty": float(self.standard_uncertainty[i]),
                "effective_degrees_of_freedom": _degrees(self.degrees_of_freedom[i]),
                "coverage_factor": float(self.coverage_factor[i]),
                "expanded_uncertainty": float(self.expanded_uncertainty[i]),
                "entries": [_entry(entry, i, float(shares[i, j])) for j, entry in enumerate(self.entries)],
            }
            if self.monte_carlo is not None and i in place:
                names = ("mean", "standard_uncertainty", "low", "high")
                own["monte_carlo"] = {n: float(getattr(self.monte_carlo, n)[place[i]]) for n in names}
            rows.append(own)
        return {
            "schema": "echocal.budget/1",
            "model_hash": self.model_hash,
            "coverage": self.coverage,
            "trials": 0 if self.monte_carlo is None else self.monte_carlo.trials,
            "correlation": None if self.itemized.correlation is None else self.itemized.correlation.tolist(),
            "rows": rows,
            "notes": list(self.notes),
        }


def _degrees(value: float) -> float | None:
    """Null is infinite: JSON has no infinity."""
    return float(value) if np.isfinite(value) else None


def _entry(entry: Entry, i: int, share: float) -> dict[str, Any]:
    return {
        "quantity": entry.quantity,
        "source": entry.words,
        "type": entry.evaluation,
        "distribution": entry.distribution,
        "standard_uncertainty": float(entry.standard_uncertainty[i]),
        "unit": entry.unit,
        "sensitivity": float(entry.sensitivity[i]),
        "degrees_of_freedom": _degrees(entry.degrees_of_freedom),
        "contribution": float(entry.contribution[i]),
        "share": share,
        "origin": entry.origin,
    }
