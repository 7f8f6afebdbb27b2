"""A cause as columns: its linear forms, and the forms of all that compete."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from echocal.diagnose.candidates.columns import Columns

__all__ = ["UNKNOWN", "Candidates", "Variant"]

UNKNOWN = "unknown"
"""Id under which an unexplained term competes: a smooth function without a cause."""


@dataclass(frozen=True)
class Variant:
    """One linear form of a cause: a fixed column, free columns, or both.

    Attributes
    ----------
    cause : str
        Id of the effect, or `UNKNOWN`.
    at : mapping of str to float
        Parameters of the fixed column, or at which the free ones are linearized.
    offset : int or None
        Column that enters with coefficient one.
    free : tuple of int
        Columns with a coefficient to be found, in units of its prior standard deviation.
    names, scales : tuple
        Parameter and its prior standard deviation, per free column.
    bounds : tuple of (float, float)
        Bounds of each coefficient, in the same units.
    weight : float
        Probability among the variants of its cause.
    against : str
        For `UNKNOWN`, the column that the term is a function of.
    """

    cause: str
    at: Mapping[str, float] = field(default_factory=dict)
    offset: int | None = None
    free: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    scales: tuple[float, ...] = ()
    bounds: tuple[tuple[float, float], ...] = ()
    weight: float = 1.0
    against: str = ""

    @property
    def columns(self) -> tuple[int, ...]:
        """Every column that it uses."""
        return self.free if self.offset is None else (self.offset, *self.free)


@dataclass
class Candidates:
    """Columns so far, the variants that use them, and what was left out and why.

    `aside` are further columns of the table that no unexplained term is tried against, for there are many.
    """

    columns: Columns
    variants: list[Variant] = field(default_factory=list)
    size_tangents: dict[str, tuple[int, float]] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    line: Variant | None = None
    aside: tuple[str, ...] = ()

    @property
    def competing(self) -> int:
        """Number of causes that have a variant."""
        return len({v.cause for v in self.variants} - {UNKNOWN})

    @property
    def terms(self) -> dict[str, Variant]:
        """The freest unexplained term against each column."""
        terms = sorted((v for v in self.variants if v.cause == UNKNOWN), key=lambda v: len(v.free))
        return {v.against: v for v in terms}
