"""Gather the log of each sensor of a task from its files, in the order of time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.fleet.store import KEY, PLACE, broken_files, pieces
from echocal.fleet.tables import Frame, label, opened, polars
from echocal.observations.layout import Layout
from echocal.observations.plan import make


@dataclass(frozen=True)
class Log:
    """The rows of a sensor."""

    columns: Any  # the table, or nothing where it cannot be read
    repeated: int = 0  # rows that stand in two files and are used once
    notes: tuple[str, ...] = ()
    error: str = ""  # why there is no table; else empty


def logs(
    sensors: Sequence[Mapping[str, Any]],
    by: str | None,
    kind: str | None,
    requests: Mapping[str, str],
    layout: Layout,
    time_zone: str,
    bucket: tuple[Path, int] | None = None,
) -> Iterator[tuple[Mapping[str, Any], Log]]:
    """Read the files of some sensors once each, and yield the log of every sensor.

    `sensors` has the ``key`` and the ``files`` of each: path, whether it has the key, and its place among
    all. The columns `by` and `kind` are no columns of a log. Rows that were divided before are in a
    `bucket`; see `echocal.fleet.store`.
    """
    read = _Read({}, {})
    if bucket is not None:
        for place, key, frame in pieces(*bucket, [sensor["key"] for sensor in sensors]):
            before = read.parts.get((place, key))
            read.parts[place, key] = frame if before is None else polars().concat([before, frame])
        read.broken.update(broken_files(bucket[0]))
    _read_files(read, sensors, by, kind, layout, divided=bucket is not None)
    for sensor in sensors:
        key, places = sensor["key"], [place for _, _, place in sensor["files"]]
        own = [read.parts.pop((place, key)) for place in places if (place, key) in read.parts]
        failed = [read.broken[place] for place in places if place in read.broken]
        if failed:
            yield sensor, Log({}, error=failed[0])
            continue
        try:
            yield sensor, _joined(own, requests, time_zone)
        except DataError as error:
            yield sensor, Log({}, error=str(error))


@dataclass(frozen=True)
class _Read:
    """Rows by the place of their file and their key, and files that cannot be read with the reasons."""

    parts: dict[tuple[int, str], Frame]
    broken: dict[int, str]


def _read_files(
    read: _Read,
    sensors: Sequence[Mapping[str, Any]],
    by: str | None,
    kind: str | None,
    layout: Layout,
    *,
    divided: bool,
) -> None:
    """Read the files once each; of divided ones, only those whose path has the key."""
    wanted: dict[int, tuple[str, bool, set[str]]] = {}
    for sensor in sensors:
        for file, in_path, place in sensor["files"]:
            if in_path or not divided:
                whole = in_path or by is None
                wanted.setdefault(place, (file, whole, set()))[2].add(sensor["key"])
    for place, (file, whole, keys) in wanted.items():
        try:
            for key, frame in _parts(Path(file), keys, None if whole else by, kind, layout):
                read.parts[place, key] = frame
        except DataError as error:
            read.broken[place] = str(error)


def _parts(
    file: Path, keys: set[str], by: str | None, kind: str | None, layout: Layout
) -> Iterator[tuple[str, Frame]]:
    """Rows of each wanted sensor of a file."""
    pl = polars()
    table = opened(file, layout)
    columns = [name for name in table.schema if name not in {by, kind}]
    if by is None:
        yield next(iter(keys)), table.read([pl.col(columns)])
        return
    key = label(by, table.schema[by])
    frame = table.read([pl.col(columns), key.alias(KEY)], key.is_in(sorted(keys)))
    for (own,), part in frame.partition_by(KEY, as_dict=True, maintain_order=True).items():
        yield own, part.drop(KEY)


def _joined(frames: list[Frame], requests: Mapping[str, str], time_zone: str) -> Log:
    """One table of several, in the order of time; a row that stands in two files is used once."""
    pl = polars()
    if len(frames) == 1:
        return Log(_arrays(frames[0]))
    try:
        whole = pl.concat(
            [frame.with_columns(pl.lit(place, pl.Int32).alias(PLACE)) for place, frame in enumerate(frames)],
            how="diagonal_relaxed",
        )
    except pl.exceptions.PolarsError as error:
        raise DataError(f"its files have columns of different types: {str(error).splitlines()[0]}") from None
    notes = []
    columns = [name for name in whole.columns if name != PLACE]
    lacking = [name for name in columns if any(name not in frame.columns for frame in frames)]
    if lacking:
        notes.append(f"some of its {len(frames)} files have no column {', '.join(map(repr, lacking))}")
    rows = len(whole)
    times = _times(whole, columns, requests, time_zone)
    if times is None:
        notes.append(f"there is no time, so its {len(frames)} files are joined in the order of their paths")
        whole = whole[_once(whole, columns)]
    elif _apart(times, whole[PLACE].to_numpy()):
        whole = whole[np.argsort(times, kind="stable")] if np.any(np.diff(times) < 0) else whole
    else:
        kept = _once(whole, columns)
        whole = whole[kept]
        order = np.argsort(times[kept], kind="stable")  # a time that is not known comes last
        moved = int(np.sum(np.diff(whole[PLACE].to_numpy()[order]) != 0)) + 1
        whole = whole[order]
        if moved > len(frames):
            notes.append(f"its files overlap in time: their rows change {moved - 1} times from file to file")
    if repeated := rows - len(whole):
        notes.append(f"{repeated} rows stand in two of its files and are used once")
    return Log(_arrays(whole.drop(PLACE)), repeated, tuple(notes))


def _once(whole: Frame, columns: Sequence[str]) -> NDArray[np.intp]:
    """Places of the rows without those that stand in an earlier file, too.

    Rows that are alike within one file stay: a log may have two readings in one second.
    """
    pl = polars()
    if len(whole.unique(columns)) == len(whole):
        return np.arange(len(whole))
    nth = pl.int_range(pl.len()).over(*columns, PLACE).alias("_nth")
    again = whole.with_columns(nth, pl.int_range(pl.len()).alias("_row"))
    kept = again.unique([*columns, "_nth"], keep="first", maintain_order=True)
    return np.asarray(kept["_row"].to_numpy(), dtype=np.intp)


def _apart(times: NDArray[np.float64], place: NDArray[np.int32]) -> bool:
    """Whether each file, in the order of time, ends before the next one begins, and has its rows in order."""
    starts = np.flatnonzero(np.diff(place, prepend=-1))
    own = np.split(times, starts[1:])
    if not all(np.all(np.diff(part) >= 0) for part in own):  # nor where a time is not known
        return False
    ends = sorted((part[0], part[-1]) for part in own)
    return all(before[1] < after[0] for before, after in pairwise(ends))


def _times(
    whole: Frame, columns: Sequence[str], requests: Mapping[str, str], time_zone: str
) -> NDArray[np.float64] | None:
    """Time of each row; None where no column has it."""
    planned = make(list(columns), {name: r for name, r in requests.items() if name in columns})
    held = planned.assignments.get("elapsed_time")
    if held is None:
        return None
    time = whole[held.column]
    if time.dtype.is_numeric():
        return np.asarray(time.to_numpy(), dtype=np.float64)
    from echocal.observations.clock import instants

    known = instants(time.to_pandas(), held.column, time_zone)[0]
    return np.where(np.isnat(known), np.nan, known.astype(np.int64).astype(np.float64))


def _arrays(frame: Frame) -> Any:
    """Columns as arrays, which are read soonest; NumPy has no times with a zone."""
    if any(getattr(kind, "time_zone", None) for kind in frame.dtypes):
        return frame
    return {name: frame[name].to_numpy() for name in frame.columns}
