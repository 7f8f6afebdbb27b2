"""Causes as columns: the linear forms of each cause that competes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.candidates.columns import Columns

__all__ = ["UNKNOWN", "Candidates", "Variant", "number_of"]

UNKNOWN = "unknown"
"""Id of an unexplained term: a smooth function of one column without a cause."""


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
        Column with coefficient one.
    free : tuple of int
        Columns whose coefficients are fitted, in units of their prior standard deviations.
    names, scales : tuple
        Parameter and its prior standard deviation, per free column.
    bounds : tuple of (float, float)
        Bounds of each coefficient, in the same units.
    weight : float
        Probability among the variants of its cause, times the prior of this cause beside a usual one.
    against : str
        For `UNKNOWN`, the column of the function.
    bound : tuple of (str, str)
        Quantities that it reads from a further thermometer, each with the name of the column.
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
    bound: tuple[tuple[str, str], ...] = ()

    @property
    def columns(self) -> tuple[int, ...]:
        """Every column that it uses."""
        return self.free if self.offset is None else (self.offset, *self.free)

    @cached_property
    def form(self) -> _core.Form:
        """The same for the core, which knows a cause by a number; an unexplained term has none."""
        cause = None if self.cause == UNKNOWN else number_of(self.cause)
        offsets = [] if self.offset is None else [self.offset]
        return _core.Form(cause, offsets, self.free, self.bounds, self.weight)


def number_of(cause: str) -> int:
    """The number by which the core knows a cause."""
    return crc32(cause.encode())


@dataclass
class Candidates:
    """Columns so far, the variants that use them, and skipped causes with the reasons.

    `aside` are further columns of the table without an unexplained term, because there are too many.
    `unread` are further thermometers that no cause reads, with the reasons. `steps` are columns of steps of
    an unknown level, and `slow_air` those of air that differs from the thermometer; no variant uses these.
    `systematic` are columns of errors that all rows share, with the factors of one standard uncertainty.
    """

    columns: Columns
    variants: list[Variant] = field(default_factory=list)
    line: Variant | None = None
    size_tangents: dict[str, tuple[int, float]] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    aside: tuple[str, ...] = ()
    unread: dict[str, str] = field(default_factory=dict)
    steps: tuple[int, ...] = ()
    slow_air: tuple[int, ...] = ()
    systematic: tuple[tuple[int, float], ...] = ()

    def average(self, cause: str, segment: NDArray[np.int64]) -> None:
        """Let each column of a cause have the mean of its segment in every row."""
        rows = np.bincount(segment)
        for at, variant in enumerate(self.variants):
            if variant.cause == cause:
                means = (np.bincount(segment, self.columns[column]) / rows for column in variant.free)
                self.variants[at] = replace(
                    variant, free=tuple(self.columns.store(mean[segment]) for mean in means)
                )

    @property
    def competing(self) -> int:
        """Number of causes that have a variant."""
        return len({v.cause for v in self.variants} - {UNKNOWN})

    @property
    def terms(self) -> dict[str, Variant]:
        """The unexplained term with the most coefficients against each column."""
        terms = sorted((v for v in self.variants if v.cause == UNKNOWN), key=lambda v: len(v.free))
        return {v.against: v for v in terms}
