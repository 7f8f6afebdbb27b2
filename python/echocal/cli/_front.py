"""``echocal LOG``: inspect a log, ask what it does not say, diagnose it, report, and say what comes next."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._brief import follow_up, print_brief, print_commands, without_evidence
from echocal.cli._console import Console
from echocal.cli._options import from_stdin, options_text, written_by_us
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, this_command, written
from echocal.cli._several import tables_bar
from echocal.cli._tables import AS_IT_IS, Given, Json, noted, reading_options, write_json
from echocal.cli.diagnose import (
    Base,
    ConstantDistance,
    Details,
    MattersMm,
    Placements,
    ReferenceDistance,
    base_of,
)
from echocal.diagnose import diagnose
from echocal.diagnose.preprocess.plateaus import distances_of
from echocal.diagnose.preprocess.reference import refuse_distance
from echocal.errors import DataError, DomainWarning, UsageError, writing
from echocal.keywords import command_line, keyword
from echocal.observations.at import parsed
from echocal.observations.inspection import Inspection, inspect_log
from echocal.observations.misspelled import misspelled
from echocal.observations.mount import is_level
from echocal.observations.plan import read_columns
from echocal.outputs import replace_text
from echocal.report import print_diagnosis


@dataclass(frozen=True)
class _Question:
    """What a log does not say."""

    what: str  # in a list
    text: str  # for a person at a terminal
    flags: str  # the flags that answer it
    quantity: str = ""  # what is asked for, where a column whose name is misspelled may hold it


@dataclass
class _Answers:
    """How the log is read and diagnosed, as far as it is known."""

    reading: Given
    reference_distance: float | None
    constant_distance: bool
    elsewhere: bool = False
    """Whether the distances come from another log, or from the user for each plateau."""


@reading_options()
def command(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="A log of any kind (docs/logs.md); - is stdin.")],
    base: Base = "linear",
    reference_distance: ReferenceDistance = None,
    constant_distance: ConstantDistance = False,
    placements: Placements = None,
    matters_mm: MattersMm = None,
    yes: Annotated[
        bool, typer.Option("--yes", "-y", help="Accept what the values of columns without a clear name say.")
    ] = False,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="DIR", help="Folder for report, model and options.")
    ] = Path(),
    reading: Given = AS_IT_IS,
    details: Details = False,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Say what is wrong with the readings of a log and what to do next; write a report and a model.

    It asks what the log does not say, if a person is at the terminal; else it names the flags that answer.
    """
    name = "stdin" if str(log) == "-" else log.name.removesuffix(".gz").rpartition(".")[0] or log.name
    source = from_stdin(log)
    if source.is_dir():
        raise UsageError(
            f"{log} is a folder: {command_line('diagnose', log, by='COLUMN', out='verdicts.csv')}"
        )
    page, model, toml = (out / f"{name}-{what}" for what in ("report.html", "model.json", "options.toml"))
    check_outputs(
        Output("--out", page, _made_by.report("diagnose", log)),
        Output("--out", model, _made_by.model("diagnose", source)),
        Output("--out", toml, written_by_us),
        Output("--json", json, _made_by.result("echocal.diagnosis")),
        inputs=[source, *([base] if base.endswith(".json") else []), *reading.files],
        folder=out,
        force=force,
    )
    if placements is not None:
        distances_of(placements)  # refused before a question
    known = _Answers(reading, reference_distance, constant_distance)
    known.elsewhere = placements is not None or reading.reference is not None
    found = _settled(source, known, yes, Console(stderr=True))
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    with tables_bar(quiet) as shown, noted(quiet, DomainWarning):
        task = shown.add_task("reading", total=None)
        diagnosis = diagnose(
            source,
            base=base_of(base),
            reference_distance=known.reference_distance,
            constant_distance=known.constant_distance,
            placements=placements,
            matters_mm=matters_mm,
            progress=lambda what, done, total: shown.update(
                task, description=what, completed=done, total=total
            ),
            **known.reading.given(),
        )
    said = {
        "base": None if base == "linear" else base,
        "reference_distance": known.reference_distance,
        "constant_distance": known.constant_distance or None,
        "placements": placements,
        "matters_mm": matters_mm,
    }
    said |= known.reading.given()
    said = {name: value for name, value in said.items() if value or value == 0.0}
    if said:
        replace_text(toml, options_text(log, toml, said))
    _made_by.sign(diagnosis.model, "diagnose", source, model).save(model)
    from echocal.report.html import save_report

    commands = follow_up(diagnosis, log, model, {"options": toml} if said else {})
    save_report(diagnosis, page, log.name, this_command(), model, without_evidence(commands))
    write_json(diagnosis.to_dict(), json)
    if quiet or json == "-":
        return
    console = Console(highlight=False)
    if details:
        print_diagnosis(diagnosis, console)
    print_brief(diagnosis, console, written(), "", f"{page}, or --details")
    console.print(f"\nread as: {_read_as(found)}", markup=False, soft_wrap=True, style="dim")
    print_commands(console, commands)


def _settled(log: Path, known: _Answers, yes: bool, console: Console) -> Inspection:
    """Settle what the log does not say: by flags, else by the person; as many questions as it takes.

    Raises `DataError` if a question is open and nobody is there, with all flags that answer; or if the log
    cannot be read.
    """
    person = sys.stdin is not None and sys.stdin.isatty()
    found = inspect_log(log, known.reading)
    open_: list[_Question] = []
    if not (_has(found, known, "reading") or _has(found, known, "echo_time")) and found.refusal:
        raise DataError(found.refusal)  # the other questions come when there is something to ask about

    def settle(question: _Question, answer: Callable[[], None]) -> None:
        if person:
            console.print(question.text, markup=False, highlight=False)
            answer()
        else:
            open_.append(question)

    for name in [name for name in found.sensors if name not in known.reading.requests][:1]:
        settle(_about_sensors(log, name, found.sensors[name]), partial(_one_sensor, log, name, known))
    guesses = [column for column in found.columns if column.proposal.guess]
    if guesses or found.missing:
        if yes or not guesses:
            _accept(found, known)
        else:
            settle(_about_guesses(found), lambda: _confirm(found, known))
    if not _has(found, known, "temperature"):
        settle(_TEMPERATURE, lambda: _ask_temperature(known))
    is_stated = known.elsewhere or known.constant_distance or known.reference_distance is not None
    if not is_stated and not _has(found, known, "reference_distance"):
        settle(_DISTANCE, lambda: _ask_distance(known))
    if open_:
        flags = "; ".join(f"{one.what} ({one.flags})" for one in open_)
        names = [column.name for column in found.columns]
        hints = [misspelled(one.quantity, names) for one in open_ if one.quantity]
        hint = next((one for one in hints if "did you mean" in one), "")
        raise DataError(f"{log.name} does not say, and nobody is at the terminal to ask: {flags}{hint}")
    return inspect_log(log, known.reading)


_MOVED = "moved"
_TEMPERATURE = _Question(
    "the temperature of the air",
    "What temperature had the air, in degC? Its uncertainty after +-, such as 20+-2",
    '--at "temperature=20+-2", or --column "NAME=temperature_C"',
    "temperature",
)
_DISTANCE = _Question(
    "the distance of the target",
    "How far was the target, in m? If nobody measured it: press Enter if it did not move, else type moved",
    "--reference-distance M; --constant-distance if it did not move and nobody measured it; "
    'or --column "NAME=distance_m"',
    "reference_distance",
)


def _about_sensors(log: Path, name: str, count: int) -> _Question:
    each = command_line("diagnose", log, by=name)
    what = f"whether the {count} values of {name!r} are as many sensors"
    text = f"{name!r} has {count} values, as where each is a sensor. Are all rows of one sensor?"
    return _Question(what, text, f'each alone: {each}; if they are one: --column "{name}=extra"')


def _one_sensor(log: Path, name: str, known: _Answers) -> None:
    if not typer.confirm("yes", default=False, err=True):
        raise UsageError(f"each sensor alone: {command_line('diagnose', log, by=name)}")
    columns = {**read_columns(known.reading.columns), name: "extra"}
    known.reading = replace(known.reading, columns=columns)


def _about_guesses(found: Inspection) -> _Question:
    guesses = [column for column in found.columns if column.proposal.guess]
    told = [f"{column.name!r} as {column.proposal.request} ({column.proposal.reason})" for column in guesses]
    told += [f"{', '.join(codes)} in {name!r} as no value" for name, codes in found.missing.items()]
    pairs = " ".join(f'--column "{column.name}={column.proposal.request}"' for column in guesses)
    level = any(is_level(column.name, column.proposal.request) for column in guesses)
    height = f" {keyword('mount_height', 'METERS')}, the height of the sensor above the zero" if level else ""
    read = f"right to read {'; '.join(told)}"
    return _Question(f"whether it is {read}", f"Is it {read}?", f"--yes, or {pairs}{height}")


def _confirm(found: Inspection, known: _Answers) -> None:
    if not typer.confirm("yes", default=True, err=True):
        raise UsageError('say what the columns hold: --column "NAME=reading_cm", --column "NAME=ignore"')
    _accept(found, known)


def _accept(found: Inspection, known: _Answers) -> None:
    columns = {**found.requests, **read_columns(known.reading.columns)}
    known.reading = replace(known.reading, columns=columns, missing=found.missing)


def _ask_temperature(known: _Answers) -> None:
    text = _asked("temperature [degC]", lambda text: parsed({"temperature": text}))
    known.reading = replace(known.reading, at={**(known.reading.at or {}), "temperature": text})


def _refuse_answer(distance: str) -> None:
    if distance in ("", _MOVED):
        return
    try:
        given = float(distance)
    except ValueError:
        raise UsageError(
            f"'{distance}' is no distance: type a number of meters such as 1.2, or moved, or press Enter"
        ) from None
    refuse_distance(given)


def _ask_distance(known: _Answers) -> None:
    text = _asked("distance [m]", _refuse_answer, "")
    if text == _MOVED:
        raise DataError("a target that moves needs its distance in a column: --column NAME=distance_m")
    known.reference_distance = float(text) if text else None
    known.constant_distance = not text


def _asked(label: str, check: Callable[[str], Any], default: str | None = None) -> str:
    """An answer that makes sense; else the question again, with the reason."""

    def convert(text: str) -> str:
        try:
            check(text)
        except (ValueError, UsageError) as error:
            raise typer.BadParameter(str(error)) from None
        return text.strip()

    found: str = typer.prompt(label, default=default, show_default=False, value_proc=convert, err=True)
    return found


def _has(found: Inspection, known: _Answers, quantity: str) -> bool:
    """Whether a column holds a quantity, or the user states it."""
    stated = parsed(known.reading.at or {})
    return quantity in stated or any(column.proposal.quantity == quantity for column in found.columns)


def _read_as(found: Inspection) -> str:
    none = ("", "extra", "ignore")
    held = [f"{c.name} as {c.proposal.request}" for c in found.columns if c.proposal.request not in none]
    usable = "" if found.usable is None else f"; {found.usable} of {found.rows} rows can be used"
    return f"{', '.join(held)}{usable}"
