"""What is known about a cause that is no effect on the mean: the second registry's facts."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

__all__ = ["CauseFacts", "Quantity"]


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
    """

    name: str
    unit: str
    meaning: str


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
    """

    id: str
    kind: Literal["noise", "row", "gross"]
    sentence: str
    signature: str
    source: str
    parameters: tuple[Quantity, ...]
    check: str
    prior: float

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
        return {
            "kind": f"{self.kind}: {_KINDS[self.kind]}",
            "signature": self.signature,
            "found in": f"{100 * self.prior:g} % of tables (prior)",
            "check": self.check,
            "source": self.source,
        }
