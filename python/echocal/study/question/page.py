"""The answer to the study's question as a page, on a terminal and as JSON."""

import re
import textwrap
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from echocal.study.question import words
from echocal.study.question.answer import Answer, Made
from echocal.study.question.explanations import LIMIT, Explanation, involved
from echocal.study.question.investigation import NEAR
from echocal.study.question.laws import suspect
from echocal.study.question.measurements import MEASUREMENTS, separation

_ON_TERMINAL = 6

FIGURES = ("study-question.png", "study-question-next.png")
"""Figures of the page."""

_LISTED = 12  # explanations
_PROSE = r"^[^\n|#<`! ][^\n]*(?:\n(?!- |\d+\. )[^\n|#<`!][^\n]*)*"
"""A line of prose or an item, and the lines that continue it."""
_INVOLVED = 0.02
_WHY = {
    "sign": "sign",
    "size": "size",
    "slope": "slope",
    "step": "step of the readings",
    "absent": "not in Tinkercad",
}


def render(found: Answer) -> str:
    """Write the page in Markdown."""
    parts = (
        words.head(found),
        _members(found),
        _suspects(found),
        _pairs(found),
        _scatter(found),
        _next(found),
        _told(found),
        words.limits(),
    )
    return filled("\n".join(parts))


def filled(text: str) -> str:
    """Fill paragraphs and items to lines of 118 characters; tables, headings and commands stay."""
    return re.sub(_PROSE, lambda found: _wrapped(found.group()), text, flags=re.MULTILINE)


def _wrapped(item: str) -> str:
    sign = re.match(r"- |\d+\. |", item)
    indent = " " * len(sign.group()) if sign else ""
    text = " ".join(item.split())
    return textwrap.fill(text, 118, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]], right: int = 0) -> str:
    """Make a table; the last columns are aligned to the right."""
    rule = ["---"] * (len(heads) - right) + ["---:"] * right
    return "".join(f"| {' | '.join(line)} |\n" for line in (heads, rule, *rows))


def _excluded(verdict: Sequence[str]) -> str:
    return ", ".join(_WHY[one] for one in verdict) if verdict else "**remains**"


def _members(found: Answer) -> str:
    rows = [
        [f"`{one.id}`", one.size, _excluded(() if one.verdict == "remains" else (one.verdict,)), one.why]
        for one in found.members
        if one.verdict
    ]
    heads = ["cause", "size that Table 2 needs", "excluded by", "because"]
    return f"""## What the diagnosis says

Verdict: {found.diagnosis.verdict}. At one distance the diagnosis cannot tell these {len(found.members)}
causes apart, and says so. What is known of Tinkercad excludes most of them.

{_table(heads, rows)}"""


def _size(one: Made) -> str:
    free, verdict = one.suspect.free, one.verdict
    if free is None or verdict.size is None or verdict.size_error is None:
        return ""
    return f"{verdict.size:+.2f} ± {verdict.size_error:.2f} {free.unit}"


def _suspects(found: Answer) -> str:
    rows = []
    for one in found.made:
        if one.suspect.place in ("setting", "none"):
            continue
        own = one.pattern
        cells = [_size(one), "", "", ""]
        if one.suspect.free is None:
            cells = [
                "",
                f"{round(own.mean, 1) + 0.0:+.1f}",
                f"{words.away(one, found):.1f}",
                f"{own.slope:+.3f}",
            ]
        rows.append([one.suspect.title, one.suspect.place, *cells, _excluded(one.verdict.excluded_by)])
    heads = ["suspect", "place", "size that Table 2 needs", "mean [mm]", "standard errors from Table 2"]
    heads += ["slope [mm/K]", "excluded by"]
    explained = "\n".join(f"- *{one.suspect.title}*: {one.suspect.says}" for one in found.made)
    ranges = "\n".join(
        f"- *{one.title}*: {one.free.low:g} to {one.free.high:g} {one.free.unit} ({one.free.why})."
        for one in (own.suspect for own in found.made)
        if one.free is not None
    )
    return f"""## Suspects on the emulated board

Each suspect is one change of the program or of the scene. The program runs on an emulated Arduino UNO for
all 27 temperatures. Mean and slope are those of its readings less the calculation of Table 2. A suspect is
excluded where it differs by more than {LIMIT:g} standard errors. A suspect without a fixed size has the
size that the table needs instead.

{_table(heads, rows)}
With nothing changed, the board differs from the calculation by {found.of("nothing").pattern.mean:+.2f} mm
on average: so neither the converter nor the single precision nor the rounding matters.

What they are:

{explained}

What is possible for the free sizes, uniformly:

{ranges}
"""


def _explanation(one: Explanation) -> list[str]:
    sizes = []
    for own in one.suspects:
        if own.free is not None:
            value, error = one.sizes[own.id], one.size_errors[own.id]
            sizes.append(f"{own.free.name} {value:+.1f} ± {error:.1f} {own.free.unit}")
    return [
        " and ".join(own.title for own in one.suspects) or "nothing",
        ", ".join(sizes),
        f"{one.left:.2f}",
        f"{100 * one.probability:.1f} %",
    ]


def _pairs(found: Answer) -> str:
    rows = [_explanation(one) for one in found.explanations[:_LISTED]]
    shares, others = involved(found.explanations), involved(found.explanations_without_odd)
    both = [
        [suspect(name).title, f"{100 * share:.0f} %", f"{100 * others[name]:.0f} %"]
        for name, share in shares.items()
        if share >= _INVOLVED
    ]
    heads = ["explanation", "free sizes", "left [mm]", "probability"]
    return f"""## Alone and in pairs

All {len(found.explanations)} explanations with one suspect or two of different places, weighed by the
likelihood of the 27 rows. *Left* is the root mean square that stays. Beforehand, one cause and two causes
are equally probable, and so are all explanations of the same number; a free size is uniform in its range.
So the probabilities hold for this list of suspects, not for the world. Where the count of an echo begins
and how a reading is rounded differ in each run of the board. So a smooth curve through the rows stands for
each suspect, unless the suspect itself cuts off.

{_table(heads, rows, 2)}
How probable it is that a suspect is part of the truth:

{_table(["suspect", "27 rows", "without the row at 6 °C"], both, 2)}"""


def _scatter(found: Answer) -> str:
    chosen = [one for one in found.made if one.suspect.place == "setting"]
    chosen += [found.of(name) for name in ("time_steps", "whole_degrees", "pulse_in", "nothing")]
    rows = [
        [one.suspect.title, f"{one.scatter[1]:.2f}", f"{one.scatter[0]:.2f} to {one.scatter[2]:.2f}"]
        for one in chosen
    ]
    much = [
        f"*{one.suspect.title}* ({one.scatter[1]:.1f} mm)"
        for one in found.made
        if one.suspect.place != "setting" and one.scatter[1] > found.wanted.scatter / 2
    ]
    return f"""## The scatter

Table 2 scatters by {found.wanted.scatter:.1f} mm. Of the suspects above only these scatter by more than half
of that: {", ".join(much)}.

{_table(["what scatters", "standard deviation [mm]", "of all its tables"], rows, 2)}
{words.scatter(found)}
"""


def _next(found: Answer) -> str:
    first = found.explanations[0]
    others = [one for one in found.explanations[1:] if one.probability >= 0.01][:4]
    worth = {one.measurement.id: one.expected_probability for one in found.outcomes}
    rows = []
    for one in MEASUREMENTS:
        away = [f"{separation(one, (first, other), found.effects):.1f}" for other in others]
        rows.append([one.title, one.how, *away, f"{100 * worth[one.id]:.0f} %"])
    named = [" and ".join(own.title for own in one.suspects) or "nothing" for one in (first, *others)]
    heads = ["measurement", "how", *[f"1 from {place}" for place in range(2, len(named) + 1)]]
    heads += ["expected probability of what is true"]
    numbered = "\n".join(f"{place}. {name}" for place, name in enumerate(named, 1))
    return f"""## Which measurement would have told

The explanations that are left, and how far apart each measurement would set the first one and another, in
standard deviations:

{numbered}

{_table(heads, rows, len(others) + 1)}
{words.next_measurement(found)}

![Which measurement would have told]({FIGURES[1]})
"""


def _told(found: Answer) -> str:
    rows = []
    for one in found.told:
        lists = [
            f"{', '.join(f'`{name}`' for name in own) or 'nothing'}{'' if right else ' (wrong)'}"
            for own, right in zip((one.one_distance, one.two_distances), one.right, strict=True)
        ]
        rows.append([suspect(one.suspect).title, *lists])
    heads = ["what the board had", "named from 2 m", f"named from 2 m and {NEAR:g} m"]
    return f"""## Would the diagnosis have found it?

The board measured again, with one suspect and a potentiometer that a hand sets within 1 K, at 2 m and at
{NEAR:g} m. The diagnosis got these tables and nothing else.

{_table(heads, rows)}
{words.told()}
"""


def show(found: Answer, console: Console) -> None:
    """Print what each suspect makes, and the most probable explanations."""
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
    for explanation in found.explanations[:_ON_TERMINAL]:
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
