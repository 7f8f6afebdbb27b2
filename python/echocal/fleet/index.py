"""The first pass: which sensor has how many rows in which file. Only the columns of the keys are read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from echocal.correct.inputs import Source, find_inputs
from echocal.errors import DataError, among
from echocal.fleet.tables import Opened, label, opened, polars
from echocal.observations.file import is_parquet
from echocal.observations.layout import Layout


@dataclass
class Sensor:
    """Where the rows of a sensor are."""

    key: str
    kind: str = ""  # empty: all sensors are of one kind
    files: list[tuple[Source, int]] = field(default_factory=list)
    """Each file with rows of the sensor, and their number."""

    @property
    def rows(self) -> int:
        """Its rows in all files."""
        return sum(rows for _, rows in self.files)


@dataclass(frozen=True)
class Index:
    """All sensors of a fleet."""

    sensors: list[Sensor]  # in the order of their keys
    notes: tuple[str, ...]
    unlabeled: int  # rows without a key
    broken: Mapping[str, str]  # files that cannot be read, with the reasons


def indexed(files: Sequence[Source], by: str | None, kind: str | None, layout: Layout) -> Index:
    """Look where the rows of each sensor are.

    Raises `DataError` if no file has a sensor, or the files of a sensor have different kinds. `by` and
    `kind` are columns, or levels of the folders. Without `by` each file is the log of one sensor.
    """
    sensors: dict[str, Sensor] = {}
    kinds: dict[str, set[str]] = {}
    broken: dict[str, str] = {}
    unlabeled = 0
    names = _names(files) if by is None else {}
    for file in files:
        try:
            counted = _counted(file, by, kind, names.get(file.file), layout)
        except DataError as error:
            broken[str(file.file)] = str(error)
            continue
        for key, own, rows in counted:
            if key is None:
                unlabeled += rows
                continue
            sensor = sensors.setdefault(key, Sensor(key))
            kinds.setdefault(key, set()).add(own or "")
            if sensor.files and sensor.files[-1][0] == file:  # two kinds in one file
                sensor.files[-1] = (file, sensor.files[-1][1] + rows)
            else:
                sensor.files.append((file, rows))
    if not sensors:
        first = next(iter(broken.values()), f"column '{by}' is empty in every row of {len(files)} files")
        raise DataError(first)
    notes = []
    for key, found in kinds.items():
        if len(found - {""}) > 1:
            message = f"sensor {key} has several kinds in '{kind}': {', '.join(sorted(found))}; give it one"
            raise DataError(message)
        sensors[key].kind = max(found)
    if unlabeled:
        notes.append(f"{unlabeled} rows have no '{by}' and belong to no sensor")
    notes += [f"set aside: {text}" for text in broken.values()]
    return Index([sensors[key] for key in sorted(sensors, key=_order)], tuple(notes), unlabeled, broken)


def _counted(
    file: Source, by: str | None, kind: str | None, name: str | None, layout: Layout
) -> list[tuple[str | None, str | None, int]]:
    """Key, kind and rows of each sensor of a file."""
    pl = polars()
    path = file.partition
    if by is None or by in path:
        own = name if by is None else path[by].strip() or None
        if kind is None or kind in path:
            return [(own, path.get(kind or ""), _rows(file.file, layout))]
        table = opened(file.file, layout, compare=False)
        found = table.read([_label(table, kind).alias("kind")])
        counts = found.group_by("kind").len().sort("kind", nulls_last=True)
        return [(own, value, rows) for value, rows in counts.iter_rows()]
    table = opened(file.file, layout, compare=False)
    wanted = [_label(table, by).alias("key")]
    wanted.append(
        _label(table, kind).alias("kind") if kind and kind not in path else pl.lit(None).alias("kind")
    )
    counts = table.read(wanted).group_by("key", "kind").len().sort("key", "kind", nulls_last=True)
    return [(key, path.get(kind or "", own), rows) for key, own, rows in counts.iter_rows()]


def _label(table: Opened, column: str) -> Any:
    if column not in table.schema:
        raise DataError(
            f"{table.path} has no column '{column}', and no folder of its path is named {column}=..."
            f"{among(column, table.schema)}"
        )
    return label(column, table.schema[column])


def _rows(file: Path, layout: Layout) -> int:
    """Rows of a file whose path has the key: of text it is only known that there are some."""
    if not is_parquet(file):
        return max(file.stat().st_size // 40, 1)  # a guess of the size of a row, which divides the work only
    return opened(file, layout, compare=False).height


def _names(files: Sequence[Source]) -> dict[Path, str]:
    """Stems of files, or as much of their paths as makes them differ."""
    stems = {file.file: file.file.name.partition(".")[0] for file in files}
    if len(set(stems.values())) < len(stems):
        return {file.file: file.place.as_posix() for file in files}
    return stems


def _order(key: str) -> tuple[int, int, str]:
    """Numbers in their order, before other keys."""
    number = key.isascii() and key.isdigit() and len(key) < 19
    return (0, int(key), key) if number else (1, 0, key)


@dataclass(frozen=True)
class Files:
    """The files of a fleet."""

    sources: tuple[Source, ...]  # each file once, in the order of the inputs and of their names
    notes: tuple[str, ...]  # what is left out


def files_of(inputs: Sequence[str | Path]) -> Files:
    """Find the files of paths, folders and globs.

    Raises `DataError` if a path does not exist, or has no table.
    """
    sources: dict[Path, Source] = {}
    notes: list[str] = []
    for given in inputs:
        found = find_inputs(given)
        if found.single and not found.files[0].file.exists():
            raise DataError(f"no file {given}")
        for source in found.files:
            sources.setdefault(source.file.resolve(), source)
        notes += found.left_out()
    return Files(tuple(sources.values()), tuple(notes))
