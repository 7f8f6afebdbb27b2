"""Blocks for many units: from a folder of model files to a folder of blocks and a table of them."""

import csv
import io
import math
import os
import re
import secrets
import shutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from echocal.errors import DataError, EchocalError, UsageError, writing
from echocal.keywords import exact
from echocal.model import Model
from echocal.outputs import spreadsheet_safe
from echocal.per_unit.block import Block
from echocal.per_unit.box import PARAMETERS, Box

TABLE = "units.csv"
"""Name of the table in a folder of blocks."""

_COLUMNS = ("file", "status", "number", "block_file", "block", "delay_us", "frequency_error", "model_hash")
_INDEX = "index.json"  # of a folder of models of a fleet; not a unit's
_MOST = 2**32 - 1

Progress = Callable[[int, int], object]


@dataclass(frozen=True)
class Written:
    """What `write_units` did with each file.

    Attributes
    ----------
    folder : Path
        Where blocks and table are.
    written : int
        Number of blocks.
    refused : dict of str to str
        The reason by the file that has no block.
    """

    folder: Path
    written: int
    refused: Mapping[str, str]


def block_of(unit: Model, number: int, box: Box, base: Model | None, whose: str) -> Block:
    """Return the block of a unit.

    Parameters
    ----------
    unit : Model
        Model of the unit.
    number : int
        Its number.
    box : Box
        Allowed parameters.
    base : Model or None
        Model of the firmware. The unit's agrees with it in all that no block holds. None: not compared.
    whose : str
        Name of the unit in messages.

    Raises
    ------
    DataError
        If a parameter is outside the box, or differs from that of the firmware. The message names the
        parameter, both sides and the way out.

    Examples
    --------
    >>> from echocal import Model
    >>> model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    >>> block_of(model, 7, Box.widest(model), None, "unit 7")
    Block(number=7, delay=992, rate=0)
    """
    if not 0 <= number <= _MOST:
        raise DataError(f"{whose}: number {number} is outside 0 .. {_MOST}, what four bytes hold")
    if unit.shape is not None:
        message = f"{whose}: unit data have no room for an unexplained term: Model.without_shape() removes it"
        raise DataError(message)
    if base is not None:
        _refuse_other(unit, base, whose)
    box.refuse_outside(unit, whose)
    delay, rate = (side.parameter.stored(side.parameter.of(unit)) for side in box.sides)
    return Block(number, delay, rate)


def _refuse_other(unit: Model, base: Model, whose: str) -> None:
    """Raise `DataError` if a unit's model differs from that of the firmware in what no block holds."""
    theirs, ours = _fixed(unit), _fixed(base)
    for name in [*ours, *(name for name in theirs if name not in ours)]:
        one, other = theirs.get(name), ours.get(name)
        same = one == other
        if isinstance(one, float) and isinstance(other, float):
            same = math.isclose(one, other, rel_tol=1e-9)
        if not same:
            has, wants = ("absent" if value is None else exact(value) for value in (one, other))
            raise DataError(
                f"{whose}: {name} is {has}, and in the firmware's model {wants}. A block holds "
                f"{' and '.join(parameter.key for parameter in PARAMETERS)}: calibrate the unit with the "
                "others fixed, or generate a firmware for this model"
            )


def _fixed(model: Model) -> dict[str, str | float]:
    """Return what a model has beside the parameters of a unit, by its name."""
    own = {parameter.effect for parameter in PARAMETERS}
    effects = ((id_, values) for id_, values in model.effects.items() if id_ not in own)
    found: dict[str, str | float] = {"the law": model.law}
    return found | {
        f"{id_}.{name}": float(value) for id_, values in effects for name, value in values.items()
    }


def number_of(file: Path) -> int | None:
    """Return the number of a unit: the digits at the end of its file's name; None where there are none.

    Examples
    --------
    >>> number_of(Path("unit_00017.json")), number_of(Path("tank.json"))
    (17, None)
    """
    found = re.search(r"([0-9]+)$", file.stem)
    return int(found[1]) if found else None


def write_units(
    units: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    model: Model | None = None,
    per_unit: Iterable[str] | Mapping[str, tuple[float, float]] = (),
    progress: Progress | None = None,
) -> Written:
    """Write a block for each model file of a folder, and a table of all.

    The new folder is complete or absent. A file that is refused has a row with the reason, and no block.

    Parameters
    ----------
    units : path
        Folder with a file ``*.json`` for each unit. The digits at the end of a name are the unit's number.
    out : path
        Folder to make. An earlier one of this function is replaced; one with other files is refused.
    model : Model, optional
        Model of the firmware; default: the first unit's.
    per_unit : iterable of str, or mapping
        Box of the firmware, as of `generate_per_unit`. Default: with `model` the default box of both
        parameters, without it all that a model can hold.
    progress : callable, optional
        Called with the number of files done and of all.

    Raises
    ------
    UsageError
        If the folder has no units or `out` cannot be written.
    DataError
        If a file's name has no number, or two have the same.
    """
    folder, target = Path(units), Path(out)
    files = _files(folder)
    numbers = _numbers(files)
    _refuse_target(target, folder)
    rows = []
    effects = per_unit or [parameter.effect for parameter in PARAMETERS]
    box = None if model is None else Box.around(model, effects)
    unfinished = target.with_name(f".{target.name}.{secrets.token_hex(8)}.unfinished")
    with writing(target):
        unfinished.mkdir(parents=True)
        try:
            for done, file in enumerate(files):
                row, unit = _read(file, numbers[file])
                if unit is not None:
                    if model is None or box is None:
                        model, box = unit, Box.around(unit, per_unit) if per_unit else Box.widest(unit)
                    row = _written(unit, row, box, model, unfinished)
                rows.append(row)
                if progress is not None:
                    progress(done + 1, len(files))
            (unfinished / TABLE).write_text(_table(rows), encoding="utf-8", newline="")
            os.sync()
            _put(unfinished, target)
        finally:
            shutil.rmtree(unfinished, ignore_errors=True)
    refused = {str(row["file"]): str(row["status"]) for row in rows if row["block"] == ""}
    return Written(target, len(rows) - len(refused), refused)


def _read(file: Path, number: int) -> tuple[dict[str, object], Model | None]:
    """Return a row of the table without a block, and the model; none where it cannot be read."""
    row: dict[str, object] = {**dict.fromkeys(_COLUMNS, ""), "file": file.name, "number": number}
    try:
        return row, Model.load(file)
    except EchocalError as error:
        return {**row, "status": str(error)}, None


def _written(unit: Model, row: dict[str, object], box: Box, base: Model, folder: Path) -> dict[str, object]:
    """Write the block of a unit, and return its row; without a block where the unit is refused."""
    name = str(row["file"])
    try:
        data = block_of(unit, int(str(row["number"])), box, base, name).to_bytes()
    except DataError as error:
        return {**row, "status": str(error)}
    block_file = f"{name.removesuffix('.json')}.bin"
    (folder / block_file).write_bytes(data)
    delay, clock = (parameter.of(unit) for parameter in PARAMETERS)
    block = {"status": "written", "block_file": block_file, "block": data.hex(" "), "model_hash": unit.hash}
    return {**row, **block, "delay_us": exact(delay * 1e6), "frequency_error": exact(clock)}


def _files(folder: Path) -> list[Path]:
    if not folder.is_dir():
        raise UsageError(f"{folder} is no folder: give one with a model file for each unit")
    files = sorted(file for file in folder.glob("*.json") if file.name != _INDEX)
    if not files:
        raise UsageError(f"{folder} has no file *.json: give a folder with a model file for each unit")
    return files


def _numbers(files: list[Path]) -> dict[Path, int]:
    numbers: dict[Path, int] = {}
    taken: dict[int, Path] = {}
    for file in files:
        number = number_of(file)
        if number is None:
            raise DataError(
                f"{file.name}: its name does not end in the number of the unit: rename it, unit_00017.json"
            )
        if number in taken:
            raise DataError(f"{taken[number].name} and {file.name} are both unit {number}: rename one")
        numbers[file] = number
        taken[number] = file
    return numbers


def _refuse_target(target: Path, units: Path) -> None:
    if target.resolve() == units.resolve() or target.resolve() in units.resolve().parents:
        raise UsageError(f"{target} holds the models of the units: give another folder for the blocks")
    if not target.exists():
        return
    if not target.is_dir():
        raise UsageError(f"{target} is no folder; choose another name")
    others = sorted({path.name for path in target.iterdir()} - set(_known(target)))
    if others:
        raise UsageError(
            f"{target} has {others[0]}, which no earlier run made, and the folder is replaced as a whole: "
            "choose another folder, or move that file"
        )


def _known(folder: Path) -> list[str]:
    """Return the files that the table of an earlier run names."""
    try:
        with (folder / TABLE).open(encoding="utf-8", newline="") as lines:
            return [TABLE, *(row["block_file"] for row in csv.DictReader(lines))]
    except (OSError, KeyError, ValueError):
        return []


def _table(rows: list[dict[str, object]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, _COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: spreadsheet_safe(str(value)) for name, value in row.items()} for row in rows)
    return text.getvalue()


def _put(unfinished: Path, target: Path) -> None:
    """Put a complete folder in the place of an earlier one."""
    if not target.exists():
        unfinished.rename(target)
        return
    earlier = unfinished.with_suffix(".earlier")
    target.rename(earlier)
    try:
        unfinished.rename(target)
    except OSError:
        earlier.rename(target)
        raise
    shutil.rmtree(earlier)
