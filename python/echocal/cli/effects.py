"""``echocal effects``: both registries, for people and for programs."""

import json
from collections.abc import Mapping
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from echocal.cli import _made_by
from echocal.cli._complete import causes as completed
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, pass_on
from echocal.cli._tables import Json
from echocal.diagnose.catalogue import causes, find_cause, irregularities
from echocal.diagnose.findings.facts import CauseFacts
from echocal.model.composition import Model
from echocal.quantities import QUANTITIES
from echocal.registry import Effect, effects

DISTANCE = 2.0  # [m]
TEMPERATURES = (0.0, 20.0, 40.0)  # [degC]

command = typer.Typer(
    help="Show what can deviate from the simulation, and how much.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@command.callback(invoke_without_command=True)
def default(context: typer.Context, json_: Json = None, quiet: Quiet = False, force: Force = False) -> None:
    """List the causes that echocal knows: effects in the order of the chain, then faults and noises."""
    if context.invoked_subcommand is None:
        list_(json_, quiet, force)


@command.command("list")
def list_(json_: Json = None, quiet: Quiet = False, force: Force = False) -> None:
    """List the causes that echocal knows: effects in the order of the chain, then faults and noises."""
    _write([cause.to_dict() for cause in causes()], json_, force=force)
    if not quiet and json_ != "-":
        hint = Text("echocal effects show ID shows all facts about one of these.", style="dim")
        Console().print(_overview(), _others(), hint)


@command.command()
def show(
    cause: Annotated[
        str,
        typer.Argument(
            metavar="ID", help="Id of an effect, a noise or a fault, e.g. humidity.", autocompletion=completed
        ),
    ],
    json_: Json = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Show all facts about one cause: formula or signature, parameters, typical size, check."""
    found = find_cause(cause)
    _write(found.to_dict(), json_, force=force)
    if not quiet and json_ != "-":
        Console().print(_summary(found) if isinstance(found, Effect) else _irregularity(found))


def _write(content: Any, target: str | None, *, force: bool) -> None:
    check_outputs(Output("--json", target, _made_by.causes()), force=force)
    pass_on(json.dumps(content, indent=2, allow_nan=False) + "\n", target)


def _overview() -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("effect", style="bold cyan", no_wrap=True)
    table.add_column("stage", style="dim")
    table.add_column("what it is", ratio=1)
    table.add_column(f"at {DISTANCE:g} m", justify="right", no_wrap=True)
    for effect in effects():
        typical = typical_errors(effect)[TEMPERATURES.index(20.0)]
        table.add_row(effect.id, effect.stage, effect.sentence, millimeters(typical, 1))
    table.caption = "typical size at 20 degC"
    return table


def _others() -> Table:
    """Causes that a diagnosis finds and no model has: faults and noises."""
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("cause", style="bold cyan", no_wrap=True)
    table.add_column("kind", style="dim")
    table.add_column("what it is", ratio=1)
    for cause in irregularities():
        table.add_row(cause.id, cause.kind, cause.sentence)
    table.caption = "found by echocal diagnose"
    return table


def _summary(effect: Effect) -> Group:
    title = Text.assemble((effect.id, "bold cyan"), (f"  {effect.stage}", "dim"))
    formula = Padding(Text(effect.formula, style="green"), (0, 2))
    parts: list[RenderableType] = [title, Text(effect.sentence), Text(), formula]
    parts += [_parameters(effect), _details(facts(effect))]
    return Group(*parts)


def _irregularity(cause: CauseFacts) -> Group:
    title = Text.assemble((cause.id, "bold cyan"), (f"  {cause.kind}", "dim"))
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("parameter", style="bold")
    table.add_column("unit")
    table.add_column("meaning")
    table.add_column("bounds")
    for quantity in cause.parameters:
        table.add_row(quantity.name, quantity.unit, quantity.meaning, quantity.range)
    return Group(title, Text(cause.sentence), table, _details(cause.details()))


def _details(named: Mapping[str, str]) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    for name, text in named.items():
        table.add_row(name, Text(text))
    return table


def _parameters(effect: Effect) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("parameter", style="bold")
    for name in ("unit", "role", "neutral", "typical", "bounds", "known"):
        table.add_column(name, justify="left" if name in {"unit", "role", "known"} else "right")
    for p in effect.parameters:
        bounds = f"{p.bounds[0]:g} .. {p.bounds[1]:g}"
        known = ", ".join(f"{value:g}" for value in p.known)
        table.add_row(p.name, p.unit, p.role, f"{p.neutral:g}", f"{p.prior_scale:g}", bounds, known)
    return table


def typical_errors(effect: Effect) -> tuple[float, ...]:
    """Return the error [m] that an effect of typical size makes at 2 m, at 0, 20 and 40 degC.

    The size is the one that theory knows, else one scale of the prior above neutral.

    Examples
    --------
    >>> from echocal.registry import find_effect
    >>> [round(1e3 * error, 2) for error in typical_errors(find_effect("fixed_delay"))]
    [4.97, 5.15, 5.33]
    """
    sizes = [parameter for parameter in effect.parameters if parameter.role == "size"]
    values = {p.name: p.known[0] if p.known else p.neutral + p.prior_scale for p in sizes}
    model = Model(effect.extends[0] if effect.extends else "linear", {effect.id: values})
    recorded = {name: QUANTITIES[name].example for name in effect.requires if name != "temperature"}
    indications = (model.indicate(DISTANCE, temperature=t, **recorded) for t in TEMPERATURES)
    return tuple(indication - DISTANCE for indication in indications)


def millimeters(error: float, digits: int) -> str:
    """Write an error [m] in mm with its sign; nothing is not negative."""
    return f"{round(1e3 * error, digits) + 0.0:+.{digits}f} mm"


def facts(effect: Effect) -> dict[str, str]:
    """Return what is known besides formula and parameters, in reading order; only what there is.

    Examples
    --------
    >>> from echocal.registry import find_effect
    >>> facts(find_effect("humidity"))["firmware"]
    'compensated where the device has relative_humidity'
    """
    typical = zip(typical_errors(effect), TEMPERATURES, strict=True)
    all_ = {
        f"typical at {DISTANCE:g} m": ", ".join(f"{millimeters(e, 2)} at {t:g} degC" for e, t in typical),
        "reads": ", ".join(effect.reads),
        "needs recorded": ", ".join(effect.requires),
        "only if not recorded": ", ".join(effect.excludes),
        "not with laws that read": effect.supplies or "",
        "only beside": ", ".join(f"law {law}" for law in effect.extends),
        "holds for": effect.domain,
        "check": effect.check,
        "prior": "" if effect.prior == 1.0 else f"{effect.prior:g} of that of other effects",
        "firmware": _on_a_device(effect),
        "source": effect.source,
    }
    return {name: text for name, text in all_.items() if text}


def _on_a_device(effect: Effect) -> str:
    """Say whether a firmware compensates the effect, and why not."""
    if effect.firmware == "folded":
        return "compensated within the tables"
    detail = str(effect.firmware_detail)
    if effect.firmware == "refused":
        return f"not compensated: {detail}"
    if QUANTITIES[detail].codes is None:
        return f"not compensated: it needs {detail} ({QUANTITIES[detail].why_no_codes})"
    return f"compensated where the device has {detail}"
