"""Forms of firmware that a request can choose from, each with what it costs or why it is not possible."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from echocal.errors import BoundError, UsageError
from echocal.explore import FORMS, TWO_INPUTS
from echocal.firmware import Firmware, generate
from echocal.model import Model


@dataclass(frozen=True)
class Considered:
    """A form that was tried for a request."""

    form: str  # its name, as `form` takes it
    made: Firmware | None  # the proven function; None if the form cannot meet the bound
    reason: str = ""  # why not; empty if it can


def considered(
    model: Model,
    target: str,
    *,
    progress: Callable[[str, int, int], object] | None = None,
    **request: Any,
) -> list[Considered]:
    """Design and prove every form for one request, without measuring it.

    In the order of their cost by the model of the search; those that cannot meet the bound last. `request`
    has further arguments of `echocal.firmware.generate`; `progress` is called with the form, the number of
    finished ones and of all.

    Examples
    --------
    >>> from echocal import Model
    >>> found = considered(Model("linear"), "c99", temperature=(1.0, 0.0, 40.0), echo=5000)
    >>> [one.form for one in found][:1], all(one.made or one.reason for one in found)
    (['polynomial'], True)
    """
    forms = TWO_INPUTS if request.get("humidity") is not None else FORMS
    found = []
    for done, form in enumerate(forms):
        if progress is not None:
            progress(f"for the report: {form}", done, len(forms))
        try:
            found.append(Considered(form, generate(model, target, form=form, **request)))
        except (BoundError, UsageError) as refusal:  # this form; the request itself is valid
            found.append(Considered(form, None, str(refusal)))
    fast = request.get("prefer") == "speed"
    return sorted(found, key=lambda one: _cost(one, fast))


def _cost(one: Considered, fast: bool) -> tuple[float, float]:
    if one.made is None:
        return float("inf"), 0.0
    flash, steps = one.made.ranked_by()
    return (steps, flash) if fast else (flash, steps)
