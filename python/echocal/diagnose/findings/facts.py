"""What is known about a cause that is no effect on the mean: the second registry's facts."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["JUDGED", "CauseFacts", "Columns", "Quantity"]

Columns = dict[str, NDArray[np.float64]]
"""Columns as `echocal.read_observations` takes them: ``reading_m``, ``distance_m``, ``temperature_C``, ..."""

JUDGED = "judgement: no survey of tables counts it"
"""Source of a prior that nobody measured."""

_KINDS = {
    "noise": "changes the distribution of the readings; a diagnosis weighs its likelihood",
    "row": "spoils single rows; a diagnosis repairs them or leaves them out, and says which",
    "gross": "spoils whole columns; a diagnosis undoes it before anything else",
}


@dataclass(frozen=True)
class Quantity:
    """A parameter that a finding states.

    Attributes
    ----------
    name, unit : str
    meaning : str
    bounds : (float or None, float or None)
        Least and largest value, in the unit; None where there is no bound.
    prior : str
        What is assumed of its value before the data; empty where a detector reads it off the rows.
    """

    name: str
    unit: str
    meaning: str
    bounds: tuple[float | None, float | None] = (0.0, None)
    prior: str = ""

    @property
    def range(self) -> str:
        """The bounds as people read them."""
        low, high = ("" if bound is None else f"{bound:g}" for bound in self.bounds)
        return f"{low} .. {high}".strip()


@dataclass(frozen=True)
class CauseFacts:
    """A cause that acts on the distribution, on single rows, or on a whole column.

    Attributes
    ----------
    id : str
        Name in files and messages.
    kind : {"noise", "row", "gross"}
        ``noise`` has a likelihood; ``row`` and ``gross`` have a detector that repairs or leaves out.
    sentence, signature, source : str
        What it is, how the data show it, and where that is known from.
    parameters : tuple of Quantity
    check : str
        The measurement, or the look at the data, that confirms or refutes it.
    prior : float
        Probability that a table has it, before the data.
    formula : str
        What it does to a reading, an echo time or a row, with the names of the parameters in it.
    needs : tuple of str
        Columns without which it cannot be found.
    repair : str
        What a diagnosis does to the rows; empty for a noise that changes no row.
    prior_source : str
        Where the prior comes from.
    """

    id: str
    kind: Literal["noise", "row", "gross"]
    sentence: str
    signature: str
    source: str
    parameters: tuple[Quantity, ...]
    check: str
    prior: float
    formula: str
    needs: tuple[str, ...] = ()
    repair: str = ""
    prior_source: str = JUDGED

    def to_dict(self) -> dict[str, Any]:
        """As plain data, for JSON."""
        return asdict(self)

    def details(self) -> dict[str, str]:
        """Return what is known besides parameters, in reading order.

        Examples
        --------
        >>> from echocal.diagnose.catalogue import find_cause
        >>> find_cause("timeout").details()["found in"]
        '2 % of tables (prior)'
        """
        told = {
            "kind": f"{self.kind}: {_KINDS[self.kind]}",
            "formula": self.formula,
            "signature": self.signature,
            "needs": ", ".join(self.needs),
            "repair": self.repair,
            "found in": f"{100 * self.prior:g} % of tables (prior)",
            "prior from": self.prior_source,
            "check": self.check,
            "source": self.source,
        }
        return {name: text for name, text in told.items() if text}
