"""The causes that the bench can stage: one function each, registered with its unit and its usual size."""

from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real

import numpy as np

from echocal.errors import UsageError
from echocal.virtual_bench.campaign.campaign import Campaign

__all__ = ["CAUSES", "Cause", "cause"]

Stage = Callable[[Campaign, float, np.random.Generator], None]

_MOST = 10.0  # times the largest usual size: more is a slip of the unit
_LEAST = 1e-6  # of the largest usual size: less shows in no table


@dataclass(frozen=True)
class Cause:
    """A cause and how it is staged.

    Attributes
    ----------
    id : str
        As in the catalogue of effects and noises, or a name of the bench where the catalogue has none.
    unit : str
        Of its size.
    low, high : float
        Usual sizes; a negative `low` of the same amount means either sign.
    sentence : str
    needs : frozenset of str
        What a design must have to show it: "time" (hours), "distances", "weather" (days of it), "visits"
        (known placements), "reference" (known distances).
    in_catalogue : bool
    stage : callable
    whole : bool
        Whether its size is a whole number.
    """

    id: str
    unit: str
    low: float
    high: float
    sentence: str
    needs: frozenset[str]
    in_catalogue: bool
    stage: Stage
    whole: bool = False

    def refused(self, offered: frozenset[str]) -> frozenset[str]:
        """What a design lacks without which there is nothing to stage; without weather a cause acts, too."""
        return self.needs - offered - {"weather"}

    def usual(self) -> str:
        """Write the usual sizes."""
        return f"+-{-self.low / 4:g} to {self.high:g}" if self.low < 0 else f"{self.low:g} to {self.high:g}"

    def check(self, size: float) -> float:
        """Return a size that somebody asks for.

        Raises
        ------
        UsageError
            If it is not a number, or of the wrong sign, or more than ten times the usual, or less than a
            millionth of it.
        """
        if isinstance(size, bool) or not isinstance(size, Real):
            message = f"{self.id}={size!r}: its size is a number [{self.unit}], or None for a usual one"
            raise UsageError(message)
        least = -_MOST * self.high if self.low < 0 else 0.0
        if not least <= size <= _MOST * self.high or abs(size) < _LEAST * self.high:
            limits = f"from {least:g} to {_MOST * self.high:g}, and not 0"
            message = (
                f"{self.id}={size:g}: its size is {limits} [{self.unit}]; usual is {self.usual()}, "
                f"and {self.id} without a size draws one"
            )
            raise UsageError(message)
        if self.whole and size != round(size):
            message = f"{self.id}={size:g}: its size is a whole number [{self.unit}]; usual is {self.usual()}"
            raise UsageError(message)
        return float(size)

    def draw(self, random: np.random.Generator) -> float:
        """Draw a usual size, log-uniform."""
        if self.low < 0:
            return float(
                random.choice([-1, 1]) * np.exp(random.uniform(np.log(-self.low / 4), np.log(self.high)))
            )
        size = float(np.exp(random.uniform(np.log(self.low), np.log(self.high))))
        return float(round(size)) if self.whole else size


CAUSES: dict[str, Cause] = {}


def cause(
    unit: str,
    low: float,
    high: float,
    *needs: str,
    id: str = "",
    in_catalogue: bool = True,
    whole: bool = False,
) -> Callable[[Stage], Stage]:
    """Register a function that stages a cause; its name is the id, its docstring the sentence."""

    def register(stage: Stage) -> Stage:
        name = id or stage.__name__
        sentence = (stage.__doc__ or "").strip().splitlines()[0]
        CAUSES[name] = Cause(name, unit, low, high, sentence, frozenset(needs), in_catalogue, stage, whole)
        return stage

    return register
