"""The answer to the study's question on a terminal."""

from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from echocal.study.question.answer import Answer
from echocal.study.question.explanations import involved
from echocal.study.question.laws import suspect

__all__ = ["document", "show"]

_LISTED = 6


def show(found: Answer, console: Console) -> None:
    """Print what each suspect makes, and the most probable explanations.

    Parameters
    ----------
    found : Answer
    console : Console
        Where to.
    """
    wanted = found.wanted
    title = f"Tinkercad reads {wanted.mean:.2f} ± {wanted.mean_error:.2f} mm beside the calculation"
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, padding=(0, 1))
    for name in ("suspect", "mean [mm]", "slope [mm/K]", "size needed", "excluded by"):
        table.add_column(name, justify="left" if name in ("suspect", "excluded by") else "right")
    for one in found.made:
        if one.suspect.place in ("setting", "none"):
            continue
        free = one.suspect.free
        needed = "" if free is None else f"{one.verdict.size:+.2f} {free.unit}"
        cells = (f"{one.pattern.mean:+.1f}", f"{one.pattern.slope:+.3f}") if free is None else ("", "")
        excluded = ", ".join(one.verdict.excluded_by)
        table.add_row(
            one.suspect.title, *cells, needed, Text(excluded or "remains", "dim" if excluded else "bold")
        )
    console.print(table)
    chosen = Table("explanation", "left [mm]", "probability", box=box.SIMPLE_HEAD, padding=(0, 1))
    for explanation in found.explanations[:_LISTED]:
        name = " and ".join(one.title for one in explanation.suspects) or "nothing"
        chosen.add_row(name, f"{explanation.left:.2f}", f"{100 * explanation.probability:.0f} %")
    console.print(chosen)
    best = found.outcomes[0]
    share = f"{100 * best.expected_probability:.0f} %"
    console.print(f"would have told: {best.measurement.title} ({share})", markup=False, highlight=False)


def document(found: Answer) -> dict[str, Any]:
    """Return the answer for JSON."""
    return {
        "table_2": vars(found.wanted),
        "suspects": [
            {
                "id": one.suspect.id,
                "place": one.suspect.place,
                **vars(one.pattern),
                "excluded_by": list(one.verdict.excluded_by),
                "size_needed": one.verdict.size,
                "size_unit": None if one.suspect.free is None else one.suspect.free.unit,
            }
            for one in found.made
        ],
        "explanations": [
            {
                "suspects": [own.id for own in one.suspects],
                "probability": one.probability,
                "left_mm": one.left,
                "sizes": one.sizes,
            }
            for one in found.explanations
        ],
        "involved": {suspect(name).id: share for name, share in involved(found.explanations).items()},
        "measurements": {one.measurement.id: one.expected_probability for one in found.outcomes},
    }
