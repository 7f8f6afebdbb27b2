"""A diagnosis on the terminal."""

from collections.abc import Iterable, Iterator

from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.table import Column, Table
from rich.text import Text

from echocal.diagnose import Cause, Diagnosis, Gain
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.sentences import enumerated, shifted_text
from echocal.diagnose.results.explain import (
    further_notes,
    lead,
    minor_text,
    parameter_text,
    place_text,
    probability_text,
    proposal_text,
    rivals_of,
    without_a_cause,
)
from echocal.diagnose.results.grouped import LEAST, grouped, in_common

STYLE = {
    "named": "bold green",
    "ambiguous": "bold yellow",
    "unknown": "bold magenta",
    "nothing": "bold cyan",
}
_LONGEST = 28  # characters of a bar, where the terminal has them
_LINES = 6
_EXACTLY = "probability that exactly these causes act"


def listed(title: str | Text, left: Iterable[str], right: Iterable[str] = ()) -> Table:
    """A table with the heads of columns of texts and of numbers; a unit in brackets is no markup."""
    texts = [Column(Text(head)) for head in left]
    numbers = [Column(Text(head), justify="right") for head in right]
    return Table(*texts, *numbers, title=title, title_justify="left")


def print_diagnosis(diagnosis: Diagnosis, console: Console) -> None:
    """Print a diagnosis for a person."""
    console.print(Panel(Group(*_head(diagnosis)), title="diagnosis", title_align="left", expand=False))
    for cause in diagnosis.causes:
        console.print(_cause(cause))
    if diagnosis.unexplained is not None:
        console.print(Text.assemble(("unexplained  ", "magenta"), diagnosis.unexplained.description))
        console.print()
    for text in without_a_cause(diagnosis):
        console.print(Text.assemble(("without a cause  ", "magenta"), text))
        console.print()
    if diagnosis.gain is not None:
        console.print(_gain(diagnosis.gain, _bars(console)))
    if len(diagnosis.posterior) > 1:
        console.print(_posterior(diagnosis, _bars(console)))
    for label, lines in (
        ("note", further_notes(diagnosis)),
        ("next", [proposal_text(proposal) for proposal in diagnosis.next_measurements]),
    ):
        for line in lines:
            console.print(Text.assemble((f"{label}  ", "dim"), line))


def _bars(console: Console) -> int:
    """Characters of the longest bar, so that the terminal cuts off none."""
    return min(_LONGEST, max(4, (console.width - 12) // 3))


def _head(diagnosis: Diagnosis) -> Iterator[RenderableType]:
    said = lead(diagnosis)
    yield Text.assemble((diagnosis.verdict, STYLE[diagnosis.verdict]), f": {said[0].lower()}{said[1:]}")
    rows = diagnosis.rows
    speed = diagnosis.base["device_speed"]
    base = diagnosis.base["law"] if speed is None else f"{speed:g} m/s at any temperature"
    yield Text(f"{rows['used']} of {rows['total']} rows used; base {base}; {diagnosis.seconds:.2f} s")
    for reason, count in rows["unusable"].items():
        yield Text(f"  left out: {count} x {reason}", style="dim")


def _cause(cause: Cause) -> RenderableType:
    if not cause.matters:
        return Group(Text(f"{place_text(cause)}{minor_text(cause)}"), Text())
    sizes = ", ".join(
        parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in cause.parameters
    )
    lines = [
        Text.assemble(
            place_text(cause),
            (cause.id, "bold"),
            f"  {sizes}  ",
            (probability_text(cause), "green"),
        ),
        Text(f"  {find_cause(cause.id).sentence}"),
        Text(f"  check: {cause.because}", style="italic"),
    ]
    if cause.doubt:
        lines.append(Text(f"  doubt: {cause.doubt}", style="yellow"))
    if cause.indistinguishable_from:
        lines.append(Text(f"  not separable from: {', '.join(rivals_of(cause))}", style="yellow"))
    return Group(*lines, Text())


def _gain(gain: Gain, longest: int) -> RenderableType:
    title = f"error on {gain.held_out_rows} {gain.judged_rows} ({gain.scheme})"
    table = listed(title, ["model"], ["RMS [mm]"])
    table.add_column("", no_wrap=True)
    rungs = [(" + ".join(("base", *ids)), rms) for ids, rms in gain.ladder]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m))
    rungs.append(("all recorded columns (floor)", gain.rms_floor_m))
    largest = max(rms for _, rms in rungs)
    for name, rms in rungs:
        bar = "━" * max(1, round(longest * rms / largest))
        table.add_row(name, f"{1e3 * rms:.2f}", Text(bar, style="cyan"))
    lines: list[RenderableType] = [table]
    if len(gain.ladder) > 1:
        low, high = (1e3 * end for end in gain.interval_95)
        part = gain.fraction_of_reachable
        reached = "" if part is None else f"; {100 * part:.0f} % of the reachable mean square error"
        least, most = (100 * end for end in gain.variance_removed_interval_95)
        after = f"on rows that neither choice nor fit has seen: {1e3 * gain.rms_after_m:.2f} mm"
        share = f"{100 * gain.variance_removed:.0f} % of the mean square error ({least:.0f} to {most:.0f} %)"
        lines.append(Text(f"{after}; gain {low:.2f} to {high:.2f} mm, {share} (95 % intervals){reached}"))
        lines += [Text(shifted_text(one)) for one in gain.shifted]
    return Group(*lines, Text())


def _posterior(diagnosis: Diagnosis, longest: int) -> RenderableType:
    """Sets of causes, inseparable ones in one line; the causes that all sets have are above."""
    groups = [group for group in grouped(diagnosis) if group.probability >= LEAST][:_LINES]
    common = in_common(groups)
    title = f"does a further cause act beside {enumerated(sorted(common))}?" if common else _EXACTLY
    table = Table(title=title, title_justify="left", show_header=False)
    for group in groups:
        bar = "━" * max(1, round(longest * group.probability))
        table.add_row(group.beyond(common), f"{group.probability:.3f}", Text(bar, style="green"))
    return Group(table, Text())
