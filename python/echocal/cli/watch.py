"""``echocal watch``: correct rows as they come, and tell when a sensor changes."""

import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from echocal._interrupt import after_imports
from echocal.cli._console import visible
from echocal.cli._models import Effects, Law, MarkRows, ModelFile, Uncertain, model_of
from echocal.cli._outputs import Force, Output, Quiet, check_outputs
from echocal.cli._tables import AS_IT_IS, Given, reading_options
from echocal.errors import UsageError
from echocal.observations.layout import Layout
from echocal.watch import Event, Fleet, Reference, State, WatchSettings, models_of
from echocal.watch.home_assistant import HomeAssistant
from echocal.watch.mqtt import Broker
from echocal.watch.output import Growing, Stream, Table
from echocal.watch.run import SCHEMA, Run
from echocal.watch.source import Files, Lines, Source

_USUAL = WatchSettings()
_BROKERS = ("mqtt://", "mqtts://")


@reading_options("sheet", "reference", "reference_join")
def command(
    source: Annotated[
        str,
        typer.Argument(
            help="A growing file (CSV, TSV, JSON lines), a folder of them, - for stdin, or mqtt://HOST/TOPIC."
        ),
    ],
    model: ModelFile = None,
    models: Annotated[
        Path | None, typer.Option(metavar="DIR", help="One model file per sensor: DIR/ID.json; needs --by.")
    ] = None,
    by: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Column with the id of the sensor.")
    ] = None,
    law: Law = None,
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
    dead_letters: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="What is no row goes here with its reason, as JSON lines; with MQTT always, by default "
            "beside --out or --state.",
        ),
    ] = None,
    home_assistant: Annotated[
        str | None,
        typer.Option(
            metavar="URL", help="Broker of Home Assistant, mqtt://HOST: it finds the sensors there by itself."
        ),
    ] = None,
    mark_rows: MarkRows = True,
    uncertainties: Uncertain = None,
    reading: Given = AS_IT_IS,
    json: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write events as JSON lines; - is stdout.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Correct rows as they come, and tell when a sensor changes, since when, and what it is like."""
    _refuse_contradictions(models, by, model or law or effect, out, json)
    if dead_letters == "-":
        raise UsageError("--dead-letters needs a file, for stdout has the rows or the events")
    reference = Reference(
        reference_distance=reference_distance,
        constant_distance=constant_distance,
        same_target=same_target,
        within=within,
        reference_later=reference_later,
        correct_only=correct_only,
    )
    settings = WatchSettings(false_alarms=false_alarms, learn=learn)
    one = None if models is not None else model_of(law, model, effect)
    mixed = source.startswith(_BROKERS)
    letters = dead_letters or (_letters_beside(out, state) if mixed else None)
    _refuse_same(("-o", out), ("--json", json), ("--dead-letters", letters), ("--state", state))
    with ExitStack() as at_end:
        kept = State(state)
        at_end.callback(kept.close)
        files = {"--out": out, "--json": json, "--dead-letters": letters, "--state": state}
        _check_files(source, files, [model, *reading.files], kept, force=force)
        kept.check(
            {"reference": reference.kind, "false_alarms": false_alarms, "learn": learn, "by": by},
        )
        kept.check({"skip_lines": reading.skip_lines, "encoding": reading.encoding})
        fleet = Fleet(
            models_of(one, models),
            by,
            reference,
            settings,
            kept,
            reading.given(),
            interval,
            own_models=models is not None,
            mark_rows=mark_rows,
            uncertainties=uncertainties or (),
            decimal=reading.decimal,
            mixed=mixed,
        )
        rows = _source(source, kept, poll, client, reading.layout, once=once)
        if isinstance(rows, Broker):
            at_end.callback(rows.close)
        home = None if home_assistant is None else HomeAssistant(home_assistant, client, by)
        if home is not None:
            at_end.callback(home.close)
        run = Run(
            fleet,
            rows,
            _table(out, kept),
            None if json in {None, "-"} else Growing(Path(str(json)), kept),
            None if letters is None else Growing(Path(letters), kept, append=True),
            lambda news: _tell(news, json, quiet or out == "-"),
            lambda text: _say(f"note: {text}", quiet),
            None if home is None else home.publish,
        )
        kept.commit()
        _until_it_ends(run, rows, quiet)


def _until_it_ends(run: Run, rows: Source, quiet: bool) -> None:
    """Take batches until there are no more, or somebody asks to stop; a batch that has begun is finished."""
    asked: _Asked | None = None
    with _stopped() as stop:
        try:
            for batch in rows.batches():
                with stop.later():
                    if batch:
                        run.take(batch)
                    if isinstance(rows, Broker):
                        rows.acknowledge()
        except _Asked as request:
            asked, stop.asked = request, None
        with stop.later():
            run.end()
            _say(run.summary(), quiet)
    if asked is None:
        run.refuse_nothing(rows.empty())
    if asked is not None:
        raise asked


def _letters_beside(out: str | None, state: Path | None) -> str:
    """Where messages that are no rows go: beside the output, or the state."""
    beside = Path(str(out)) if out not in {None, "-"} else state
    return "dead-letters.jsonl" if beside is None else str(beside.with_suffix(".dead-letters.jsonl"))


def _refuse_same(*named: tuple[str, Any]) -> None:
    seen: dict[Path, str] = {}
    for option, path in named:
        if path in {None, "-"}:
            continue
        first = seen.setdefault(Path(str(path)).resolve(), option)
        if first != option:
            raise UsageError(f"{first} and {option} both name {path}; choose two names")


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
        raise UsageError(f"cannot write {out} as rows come; endings: .csv, .jsonl, .ndjson")


def _check_files(
    source: str, outputs: dict[str, Any], inputs: list[Any], kept: State, *, force: bool
) -> None:
    """Refuse outputs that would destroy a file, or would be read again as rows."""

    def ours(file: Path) -> bool:
        if kept.position(f"output {file.resolve()}") is not None:
            return True
        with file.open(encoding="utf-8", errors="replace") as stream:
            first = stream.readline()
        return any(mark in first for mark in ("corrected_distance_m", '"echocal.event/1"', f'"{SCHEMA}"'))

    file = None if source == "-" or source.startswith(_BROKERS) else Path(source)
    written = [Output(option, outputs[option], ours) for option in outputs if option != "--state"]
    check_outputs(*written, inputs=[*inputs, file], force=force)
    for option, path in outputs.items():
        inside = path not in {None, "-"} and file is not None and file.is_dir()
        if inside and file is not None and file.resolve() in Path(str(path)).resolve().parents:
            raise UsageError(f"{option} {path} lies in the folder that is watched; choose another place")


def _source(source: str, kept: State, poll: float, client: str, layout: Layout, *, once: bool) -> Source:
    if source == "-":
        return Lines(sys.stdin.buffer, poll, layout)
    if source.startswith(_BROKERS):
        return Broker(source, client, poll, kept)
    return Files(Path(source), kept, poll, once=once, layout=layout)


def _table(out: str | None, kept: State) -> Table | Stream | None:
    if out is None:
        return None
    return Stream(sys.stdout) if out == "-" else Table(Path(out), kept)


def _tell(news: Sequence[Event], json: str | None, quiet: bool) -> None:
    for event in news:
        if json == "-":
            sys.stdout.write(event.line_of_json())
        elif not quiet:
            sys.stdout.write(visible(event.line()) + "\n")
    sys.stdout.flush()


def _say(text: str, quiet: bool) -> None:
    if not quiet:
        sys.stderr.write(visible(text) + "\n")


class _Asked(SystemExit):
    """Somebody asked the watch to stop."""


class _Stop:
    """A request to stop: while it waits the watch ends at once, else when it has done what it does."""

    def __init__(self) -> None:
        self.asked: int | None = None
        self._busy = False

    def __call__(self, number: int, _frame: Any) -> None:
        first, self.asked = self.asked is None, number
        if not (self._busy and first):
            raise _Asked(128 + number)  # a library that is called meanwhile may swallow it: it is asked again

    @contextmanager
    def later(self) -> Iterator[None]:
        """Do something whole; a second request ends that, too."""
        self._busy = True
        try:
            yield
        finally:
            self._busy = False
        if self.asked is not None:
            raise _Asked(128 + self.asked)


@contextmanager
def _stopped() -> Iterator[_Stop]:
    """End at Ctrl-C or a request to terminate, without a traceback."""
    stop = _Stop()
    requests = [signal.SIGINT, signal.SIGTERM]
    closed = getattr(signal, "SIGHUP", None)  # the terminal; Windows has no such signal
    if closed is not None and signal.getsignal(closed) is not signal.SIG_IGN:  # as after nohup
        requests.append(closed)
    before = {number: signal.signal(number, after_imports(stop)) for number in requests}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
