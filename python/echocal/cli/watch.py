"""``echocal watch``: correct rows as they come, and tell when a sensor changes."""

import json as json_
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli._models import Effects, model_of
from echocal.cli._outputs import Force, Output, check_outputs
from echocal.cli._tables import (
    At,
    Columns,
    Missing,
    Options,
    Quiet,
    ReadingSpeed,
    TimeFormat,
    TimeZone,
    Trust,
    options_of,
    toml_files,
)
from echocal.errors import UsageError
from echocal.watch import Event, Fleet, Reference, State, WatchSettings, models_of
from echocal.watch.mqtt import Broker
from echocal.watch.output import Growing, Stream, Table
from echocal.watch.source import Files, Lines, Source

_USUAL = WatchSettings()
_BROKERS = ("mqtt://", "mqtts://")


def command(
    source: Annotated[
        str,
        typer.Argument(
            help="A growing file (CSV, TSV, JSON lines), a folder of them, - for stdin, or mqtt://HOST/TOPIC."
        ),
    ],
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model file; default: a law alone.")
    ] = None,
    models: Annotated[
        Path | None, typer.Option(metavar="DIR", help="One model file per sensor: DIR/ID.json; needs --by.")
    ] = None,
    by: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Column with the id of the sensor.")
    ] = None,
    law: Annotated[
        str | None, typer.Option(help="Law or expression, in place of a model; default cramer.")
    ] = None,
    effect: Effects = None,
    reference_distance: Annotated[
        float | None, typer.Option(metavar="M", help="Distance of the target in every row, in m.")
    ] = None,
    constant_distance: Annotated[
        bool, typer.Option("--constant-distance", help="The target does not move; its distance is not known.")
    ] = False,
    same_target: Annotated[
        str | None,
        typer.Option(
            metavar="COLUMN",
            help="Sensors with the same value watch one target: compare them with each other.",
        ),
    ] = None,
    within: Annotated[
        float, typer.Option(metavar="S", help="With --same-target: age up to which a row is compared, in s.")
    ] = 900.0,
    reference_later: Annotated[
        bool, typer.Option("--reference-later", help="Reference distances come now and then.")
    ] = False,
    correct_only: Annotated[bool, typer.Option("--correct-only", help="Test nothing.")] = False,
    out: Annotated[
        str | None,
        typer.Option(
            "--out", "-o", metavar="OUT", help="Corrected rows: .csv, .jsonl, or - for JSON lines on stdout."
        ),
    ] = None,
    state: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Keep the state here: a restart continues.")
    ] = None,
    false_alarms: Annotated[
        float, typer.Option(metavar="N", help="False alarms per sensor and year.")
    ] = _USUAL.false_alarms,
    learn: Annotated[
        int, typer.Option(metavar="ROWS", help="Rows from which each sensor's usual errors are learned.")
    ] = _USUAL.learn,
    interval: Annotated[
        float | None,
        typer.Option(
            metavar="S", help="Time between rows of a sensor, in s; default: learned from their times."
        ),
    ] = None,
    once: Annotated[bool, typer.Option("--once", help="End with the rows that there are now.")] = False,
    poll: Annotated[float, typer.Option(metavar="S", help="Wait between two looks at files, in s.")] = 2.0,
    client: Annotated[
        str, typer.Option(metavar="NAME", help="MQTT: name for which the broker keeps messages.")
    ] = "",
    column: Columns = None,
    missing: Missing = None,
    trust: Trust = None,
    reading_speed: ReadingSpeed = None,
    time_zone: TimeZone = "UTC",
    at: At = None,
    time_format: TimeFormat = None,
    file_of_options: Options = None,
    json: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write events as JSON lines; - is stdout.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Correct rows as they come, and tell when a sensor changes, since when, and what it is like."""
    _refuse_contradictions(models, by, model or law or effect, out, json)
    reference = Reference(
        distance=reference_distance,
        constant=constant_distance,
        target=same_target,
        within=within,
        later=reference_later,
        none=correct_only,
    )
    settings = WatchSettings(false_alarms=false_alarms, learn=learn)
    one = None if models is not None else model_of(law, model, effect)
    options = options_of(
        column, missing, trust, at, reading_speed=reading_speed, time_zone=time_zone, time_format=time_format
    )
    named = [("-o", out), ("--json", json)]
    for option, path in named if state is not None else []:
        if path not in {None, "-"} and Path(str(path)).resolve() == Path(str(state)).resolve():
            message = f"{option} and --state both name {path}; choose two names"
            raise UsageError(message)
    with ExitStack() as at_end:
        kept = State(state)
        at_end.callback(kept.close)
        _check_files(source, out, json, state, [model, *toml_files(column)], kept, force=force)
        kept.check(
            {
                "reference": reference.kind,
                "false_alarms": false_alarms,
                "learn": learn,
                "by": by,
            }
        )
        own = models is not None
        fleet = Fleet(models_of(one, models), by, reference, settings, kept, options, interval, own)
        rows = _source(source, kept, poll, client, once=once)
        if isinstance(rows, Broker):
            at_end.callback(rows.close)
        table = _table(out, kept)
        events = None if json in {None, "-"} else Growing(Path(str(json)), kept)
        told = 0
        with _until_stopped():
            for batch, wrong in rows.batches():
                for why in dict.fromkeys(wrong):
                    _say(f"note: {why}", quiet)
                if not batch and not wrong:
                    continue
                corrected, news = fleet.take(batch)
                if table is not None:
                    table.write(corrected)
                    table.done(kept)
                if events is not None:
                    events.write("".join(_json(event) for event in news))
                    events.done(kept)
                rows.done(kept)
                kept.commit()
                if isinstance(rows, Broker):
                    rows.acknowledge()
                told += sum(event.kind == "change" for event in news)
                _tell(news, json, quiet or out == "-")
        _say(f"{fleet.rows} rows, {fleet.corrected} corrected; {told} changes told", quiet)


def _refuse_contradictions(
    models: Path | None, by: str | None, one: Any, out: str | None, json: str | None
) -> None:
    if models is not None and by is None:
        raise UsageError("--models holds one model per sensor: name the column of the sensor's id with --by")
    if models is not None and one:
        raise UsageError("give --models, or one model for all sensors, not both")
    if out == "-" and json == "-":
        raise UsageError("-o - and --json - both write to stdout: give one of them a file")
    if out not in {None, "-"} and Path(str(out)).suffix.lower() not in {".csv", ".jsonl", ".ndjson"}:
        message = f"cannot write {out} as rows come; endings: .csv, .jsonl, .ndjson"
        raise UsageError(message)


def _check_files(
    source: str,
    out: str | None,
    json: str | None,
    state: Path | None,
    inputs: list[Any],
    kept: State,
    *,
    force: bool,
) -> None:
    """Refuse outputs that would destroy a file, or would be read again as rows."""

    def ours(file: Path) -> bool:
        if kept.position(f"output {file.resolve()}") is not None:
            return True
        with file.open(encoding="utf-8", errors="replace") as stream:
            first = stream.readline()
        return "corrected_distance_m" in first or '"echocal.event/1"' in first

    file = None if source == "-" or source.startswith(_BROKERS) else Path(source)
    check_outputs(
        Output("--out", out, ours), Output("--json", json, ours), inputs=[*inputs, file], force=force
    )
    for option, path in (("--out", out), ("--json", json), ("--state", state)):
        inside = path not in {None, "-"} and file is not None and file.is_dir()
        if inside and file is not None and file.resolve() in Path(str(path)).resolve().parents:
            message = f"{option} {path} lies in the folder that is watched; choose another place"
            raise UsageError(message)


def _source(source: str, kept: State, poll: float, client: str, *, once: bool) -> Source:
    if source == "-":
        return Lines(sys.stdin.buffer, poll)
    if source.startswith(_BROKERS):
        return Broker(source, client, poll)
    return Files(Path(source), kept, poll, once=once)


def _table(out: str | None, kept: State) -> Table | Stream | None:
    if out is None:
        return None
    return Stream(sys.stdout) if out == "-" else Table(Path(out), kept)


def _json(event: Event) -> str:
    return json_.dumps(event.to_dict(), allow_nan=False) + "\n"


def _tell(news: list[Event], json: str | None, quiet: bool) -> None:
    for event in news:
        if json == "-":
            sys.stdout.write(_json(event))
        elif not quiet:
            sys.stdout.write(event.line() + "\n")
    sys.stdout.flush()


def _say(text: str, quiet: bool) -> None:
    if not quiet:
        sys.stderr.write(text + "\n")


@contextmanager
def _until_stopped() -> Iterator[None]:
    """End at Ctrl-C or a request to terminate, without a traceback; the last commit stands."""

    def stop(number: int, _frame: Any) -> None:
        raise SystemExit(128 + number)

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
