"""The register of what can be hidden: one function a cause."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

Kind = Literal["mean", "noise", "row", "gross"]


@dataclass(frozen=True)
class Cause:
    """A cause that can be planted.

    Attributes
    ----------
    id : str
        As in the catalogue.
    kind : str
    plant : callable
        ``plant(world, size, shape)`` for a mean cause, where `shape` is a generator that draws
        the same shape for every campaign of a case; ``plant(log, size, random)`` for the rest.
    size : {"signed", "positive", "fixed"}
        In units of the catalogue's usual magnitude; ``fixed`` where theory knows it.
    most : float
        Largest size that nature allows.
    needs : frozenset of str
        What a design must offer (see `Rows.offers`).
    shows : frozenset of str
        Quantities that the log must hold.
    repeats : bool
        Whether a new campaign meets the same error, so that it can be corrected there.
    """

    id: str
    kind: Kind
    plant: Callable[..., None]
    size: Literal["signed", "positive", "fixed"]
    most: float
    needs: frozenset[str]
    shows: frozenset[str]
    repeats: bool


CAUSES: dict[str, Cause] = {}


def cause(
    kind: Kind = "mean",
    *,
    size: Literal["signed", "positive", "fixed"] = "signed",
    most: float = 1e3,
    needs: str = "",
    shows: str = "",
    repeats: bool = True,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register a function under its own name."""

    def register(plant: Callable[..., None]) -> Callable[..., None]:
        details: dict[str, Any] = {"needs": frozenset(needs.split()), "shows": frozenset(shows.split())}
        CAUSES[plant.__name__] = Cause(plant.__name__, kind, plant, size, most, repeats=repeats, **details)
        return plant

    return register
