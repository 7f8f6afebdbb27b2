"""`echocal.watch`: correct rows as they come, and tell when a sensor changes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

from echocal.correct.needed import refuse_no_model
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.observations.given import READ_OPTIONS, refuse_keywords
from echocal.observations.options import ReadOptions
from echocal.watch.events import Event
from echocal.watch.fleet import Fleet
from echocal.watch.parser import Arrival, Batch, Parser
from echocal.watch.reference import Reference, models_of
from echocal.watch.rows import Row
from echocal.watch.settings import WatchSettings
from echocal.watch.source import Files
from echocal.watch.state import State


def watch(
    source: str | Path | Iterable[Row] | Iterable[str],
    model: Model | None = None,
    *,
    models: str | Path | None = None,
    by: str | None = None,
    reference: Reference | None = None,
    settings: WatchSettings | None = None,
    interval: float | None = None,
    state: str | Path | None = None,
    follow: bool = False,
    poll: float = 2.0,
    mark_rows: bool = True,
    uncertainties: Sequence[str] | Mapping[str, float] = (),
    **options: Any,
) -> Iterator[tuple[list[Row], list[Event]]]:
    """Correct rows as they come, each with the model of its sensor, and test them for changes.

    The command ``echocal watch`` does the same, writes files, and reads messages of a broker.

    Parameters
    ----------
    source : path, or iterable of mapping or of str
        A file (.csv, .tsv, .jsonl, .ndjson) or a folder of them; rows by name of the column; or lines of
        text, of which the first is the header. Each row of an iterable is dealt with before the next is asked
        for.
    model : Model, optional
        The model of all sensors.
    models : path, optional
        Folder of models, one for each sensor, in place of `model`; needs `by`.
    by : str, optional
        Column with the id of the sensor.
    reference : Reference, optional
        What a corrected distance is compared with: ``Reference(reference_distance=1.5)`` [m],
        ``Reference(constant_distance=True)``, ``Reference(correct_only=True)``. Default: the column
        ``distance_m``.
    settings : WatchSettings, optional
        Rows to learn from, false alarms, and the other numbers that decide.
    interval : float, optional
        Time between rows of a sensor [s], where they have no time.
    state : path, optional
        File that keeps what was learned. A file or a folder as source is continued behind its last row. The
        state is committed when the next result is asked for.
    follow : bool
        Whether to wait for more lines of a file; default: end with those that there are.
    poll : float
        Time between two looks at files [s].
    mark_rows, uncertainties
        As in `echocal.correct`.
    **options
        Further arguments of `echocal.read_observations`: ``columns``, ``missing``, ...

    Yields
    ------
    rows : list of mapping
        Rows with ``corrected_distance_m`` [m] (``corrected_level_m`` where the table holds a level),
        ``distance_standard_uncertainty_m`` [m] and ``status``. Rows whose marks look at later rows come when
        these have come; the last at the end.
    events : list of Event
        What there is to tell: ``learned``, ``change``, ``verdict``, ``note``, ...

    Raises
    ------
    UsageError
        If the request contradicts itself, or the source is a table.
    DataError
        If the first rows lack what every row needs, or no row comes at all.

    Examples
    --------
    >>> import echocal
    >>> from echocal.watch import Reference
    >>> rows = ({"time_s": 600 * i, "reading_m": 1.0, "temperature_C": 20.0 + i % 2} for i in range(3))
    >>> nothing = Reference(correct_only=True)
    >>> for corrected, events in echocal.watch(rows, echocal.Model("linear"), reference=nothing):
    ...     print(corrected[0]["corrected_distance_m"], len(events))
    1.0 0
    1.0 0
    1.0 0
    """
    refuse_keywords(watch, options, READ_OPTIONS)
    if (model is None) == (models is None):
        raise UsageError("give one model, or a folder of models with `models` and `by`")
    if models is not None and by is None:
        raise UsageError("`models` has one model for each sensor: name the column of its id with `by`")
    if model is not None:
        refuse_no_model(model)
    if isinstance(source, Mapping | bytes) or hasattr(source, "columns") or hasattr(source, "data_vars"):
        raise UsageError(
            f"watch takes rows as they come, got a {type(source).__name__}; give an iterable of rows: "
            "table.to_dict('records')"
        )
    how = ReadOptions(**options)
    kept = State(None if state is None else Path(state))
    fleet = Fleet(
        models_of(model, None if models is None else Path(models)),
        by,
        reference or Reference(),
        settings or WatchSettings(),
        kept,
        how.given(),
        interval,
        own_models=models is not None,
        mark_rows=mark_rows,
        uncertainties=uncertainties,
        decimal=how.decimal,
    )
    if isinstance(source, str | Path):
        files = Files(Path(source), kept, poll, once=not follow, layout=how.layout)
        return _watched(fleet, files.batches(), files)
    return _watched(fleet, _batches(source, how), None)


def _watched(
    fleet: Fleet, batches: Iterable[Batch], files: Files | None
) -> Iterator[tuple[list[Row], list[Event]]]:
    with closing(fleet.state) as state:
        for batch in batches:
            if not batch:
                continue
            rows, whys = [one.row for one in batch.rows], [one.why for one in batch.rows]
            corrected, events = fleet.take(rows, batch.decimal, batch.units, whys)
            said = [*batch.notes, *(f"{one.source}: {one.reason}" for one in batch.unread)]
            yield corrected, [*(Event("note", "", None, 0, text) for text in said), *events]
            if files is not None:
                files.done(state)
            state.commit()
        if not state.fact("begun"):
            raise DataError("no row has come" if files is None else files.empty())
        corrected, events = fleet.finish()
        if corrected or events:
            yield corrected, events
        state.commit()


def _batches(source: Iterable[Any], how: ReadOptions) -> Iterator[Batch]:
    """Rows one by one; lines as soon as they make a row."""
    items = iter(source)
    first = next(items, None)
    if isinstance(first, str):
        parser, rest = Parser("line", replace(how.layout, encoding=ReadOptions.encoding)), b""
        for line in chain([first], items, [None]):
            rest += b"" if line is None else line.rstrip("\r\n").encode() + b"\n"
            for batch, size in parser.batches(rest, final=line is None):
                rest = rest[size:]
                yield batch
        return
    for row in chain([] if first is None else [first], items):
        if not isinstance(row, Mapping):
            raise UsageError(f"a row is a mapping of columns to values, got a {type(row).__name__}")
        yield Batch([Arrival({str(name): value for name, value in row.items()}, b"", "row")])
