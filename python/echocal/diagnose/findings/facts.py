"""Facts of a cause that is not an effect on the mean."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["JUDGED", "CauseFacts", "Columns", "Quantity"]

Columns = dict[str, NDArray[np.float64]]
"""Columns as `echocal.read_observations` takes them: ``reading_m``, ``distance_m``, ``temperature_C``, ..."""

JUDGED = "judgement: no survey of tables counts it"
"""Source of a prior that is not measured."""

_KINDS = {
    "noise": "changes the distribution of the readings; a diagnosis compares its likelihood",
    "row": "spoils single rows; a diagnosis repairs them or leaves them out, and lists them",
    "gross": "spoils whole columns; a diagnosis corrects them before all other steps",
}


@dataclass(frozen=True)
class Quantity:
    """A parameter that a finding states.

    Attributes
    ----------
    name, unit : str
    meaning : str
    bounds : (float or None, float or None)
        Smallest and largest value, in the unit; None where there is no bound.
    prior : str
        Prior distribution of its value; empty if a detector computes it from the rows.
    """

    name: str
    unit: str
    meaning: str
    bounds: tuple[float | None, float | None] = (0.0, None)
    prior: str = ""

    @property
    def range(self) -> str:
        """The bounds as text."""
        low, high = ("" if bound is None else f"{bound:g}" for bound in self.bounds)
        return f"{low} .. {high}".strip()


@dataclass(frozen=True)
class CauseFacts:
    """A cause that acts on the noise, on single rows or on a whole column.

    Attributes
    ----------
    id : str
        Name in files and messages.
    kind : {"noise", "row", "gross"}
        A ``noise`` has a likelihood. ``row`` and ``gross`` have a detector that repairs rows or
        leaves them out.
    sentence, signature, source : str
        What the cause is, how the data show it, and the source of this knowledge.
    parameters : tuple of Quantity
    check : str
        A measurement, or a comparison in the data, that confirms or refutes the cause.
    prior : float
        Prior probability that a table has the cause.
    formula : str
        What the cause does to a reading, an echo time or a row, with the names of the parameters.
    needs : tuple of str
        Columns that its detection requires.
    repair : str
        What a diagnosis does to the rows; empty for a noise.
    prior_source : str
        Source of the prior.
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
        """Return the facts except the parameters, in reading order.

        Examples
        --------
        >>> from echocal.diagnose.catalogue import find_cause
        >>> find_cause("timeout").details()["found in"]
        '2 % of tables (prior)'
        """
        facts = {
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
        return {name: text for name, text in facts.items() if text}
