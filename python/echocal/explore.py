"""The Pareto front between flash, time and error: proven functions, none of them dominated by another."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from echocal import silicon
from echocal.errors import BoundError, EchocalError, UsageError
from echocal.firmware import Firmware, generate
from echocal.model import Model

__all__ = ["Choice", "explore"]

FORMS = (
    "polynomial", "adapted", "square", "factored", "interpolated_table", "segments", "full_table", "bent",
)  # fmt: skip
TWO_INPUTS = ("additive", "grid")
TIGHTER = 0.6
"""The next bound, as a share of the error that was proven for the last. Set by hand."""
TIGHTEST = 1e-6
"""Tightest bound [m]: one unit of an output in micrometers."""

Progress = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Choice:
    """One proven function and what it costs."""

    made: Firmware  # the function
    error: float  # largest error, proven [m]
    flash: int  # bytes, including the functions of the compiler's library that it calls
    steps: int  # most cycles (AVR) or instructions of one call
    figures: str  # origin of `flash` and `steps`; one of {"measured", "cost model"}
    core: str | None  # the core on which they were measured

    @property
    def unit(self) -> str:
        """Unit of `steps`."""
        return "cycles" if (self.core or self.made.report["target"]) == "avr" else "instructions"

    @property
    def form(self) -> str:
        """The form of the function, in words."""
        return str(self.made.report["form"]["description"])

    def dominates(self, other: "Choice") -> bool:
        """Return whether this choice is nowhere worse than the other, and better in flash, time or error."""
        mine = (self.flash, self.steps, self.error)
        theirs = (other.flash, other.steps, other.error)
        return mine != theirs and all(a <= b for a, b in zip(mine, theirs, strict=True))

    def to_dict(self) -> dict[str, Any]:
        """Return the figures, their origin, and the command that makes the files, for programs."""
        return {
            "form": self.form,
            "error_proven_m": self.error,
            "flash_bytes": self.flash,
            "steps": self.steps,
            "unit": self.unit,
            "figures": self.figures,
            "core": self.core,
            "command": self.made.report["provenance"]["command"],
        }


def explore(
    model: Model,
    target: str = "avr",
    *,
    max_error: float = 2e-3,
    core: str | None = None,
    progress: Progress | None = None,
    **request: Any,
) -> list[Choice]:
    """Design with every form at tighter and tighter bounds, and keep the Pareto front.

    Flash and time are measured if the compiler and the simulator are installed. Otherwise they come from the
    cost model of the search; `Choice.figures` states which. Raises `BoundError` if no form meets `max_error`,
    and `UsageError` if an effect needs an input that the device lacks, or if the codes are invalid.

    Parameters
    ----------
    model : Model
        The model to follow.
    target : str
        Core that the C is for, as in `echocal.firmware.generate`.
    max_error : float
        The largest bound to try [m].
    core : str, optional
        Core to measure on, a key of `echocal.silicon.CORES`; default: the target's own, ``"cortex-m0"``
        for ``"c99"``.
    progress : callable, optional
        Called with the current search in words, the number of finished searches and that of all searches.
    **request
        Further arguments of `echocal.firmware.generate`, such as the codes.

    Returns
    -------
    list of Choice
        The Pareto front, the least flash first.

    Examples
    --------
    >>> from echocal import Model
    >>> from echocal.explore import explore
    >>> choices = explore(Model("cramer"), "cortex-m0", temperature=(1.0, 0.0, 40.0), echo=5000)
    >>> any(a.dominates(b) for a in choices for b in choices)
    False
    """
    generate(model, target, max_error=max_error, **request)  # raises if the loosest bound cannot be met
    forms = TWO_INPUTS if (request.get("humidity") or request.get("further")) is not None else FORMS
    searches = [(form, prefer) for form in forms for prefer in ("size", "speed")]
    found: dict[str, Firmware] = {}
    for done, (form, prefer) in enumerate(searches):
        if progress is not None:
            progress(f"{form}, {prefer}", done, len(searches))
        for made in _tightening(model, target, max_error, {**request, "form": form, "prefer": prefer}):
            found.setdefault(made.files["echocal_correction.c"], made)
    where = core or (target if target in silicon.CORES else "cortex-m0")
    choices: list[Choice] = []
    for done, made in enumerate(found.values()):
        if progress is not None:
            progress("measuring", done, len(found))
        choices.append(_costed(made, where))
    kept = [one for one in choices if not any(other.dominates(one) for other in choices)]
    return sorted(kept, key=lambda choice: (choice.flash, choice.steps, choice.error))


def _tightening(model: Model, target: str, bound: float, request: dict[str, Any]) -> Iterator[Firmware]:
    """Yield designs for tighter and tighter bounds, until none is found."""
    while bound >= TIGHTEST:
        try:
            made = generate(model, target, max_error=bound, **request)
        except (BoundError, UsageError):  # this form cannot meet it; the request itself is valid
            return
        yield made
        bound = TIGHTER * float(made.report["error_proven_m"])


def _costed(made: Firmware, core: str) -> Choice:
    error = float(made.report["error_proven_m"])
    try:
        found = silicon.measure(made, core)
    except EchocalError:  # a function that this simulator cannot time
        found = None
    if found is None:
        flash, steps = made.ranked_by()
        return Choice(made, error, flash, steps, "cost model", None)
    return Choice(made, error, found.flash_bytes, found.steps, "measured", core)
