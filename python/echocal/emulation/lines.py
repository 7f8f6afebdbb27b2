"""From the lines of a sketch to columns."""

import re
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from echocal.errors import DataError, DataWarning
from echocal.observations import read_observations
from echocal.silicon import Played

_SILENT = "no echo"
_SHOWN = 80  # characters of a line in a message
_LONG = re.compile(rf"\S{{{_SHOWN + 1},}}")


def columns_of(played: Played) -> pd.DataFrame:
    """Return what a sketch of this package prints: a header, and one line of numbers for each row."""
    if not played.before:
        message = "the sketch printed no header before its first row: are its echoes too short to be seen?"
        raise DataError(message)
    names = played.before[-1].split(",")
    rows = [(lines[0].split(",") if lines else []) for lines in played.rows]
    filled = [row if len(row) == len(names) else [""] * len(names) for row in rows]
    table = pd.DataFrame(filled, columns=names)
    return table.assign(**{name: pd.to_numeric(table[name], errors="coerce") for name in names})


def understood(played: Played, columns: Mapping[str, str]) -> pd.DataFrame:
    """Return what any sketch prints, read as a log of a serial monitor.

    `columns` tells what columns hold, as in `echocal.read_observations`. Raises `DataError` if neither a
    reading nor an echo time is found in each row.
    """
    printed = [", ".join(line for line in lines if line.strip()) for lines in played.rows]
    if not any(printed):
        said = next((line for line in played.lines if line.strip()), "")
        raise DataError(
            f"the sketch prints no line for any of {len(printed)} echoes{_shown(said)}: end the line of each "
            "measurement with Serial.println"
        )
    first = next(filter(None, printed))
    rows = [line or _SILENT for line in printed]
    text = "\n".join([*_header(played, first), *rows, ""])
    with tempfile.TemporaryDirectory(prefix="echocal-") as name, warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # rows without an echo are counted elsewhere
        path = Path(name) / "lines of the sketch"
        path.write_text(text, encoding="utf-8")
        try:
            found = read_observations(path, columns, reading_speed=343.0)  # only what is printed is taken
        except DataError as error:
            reason = str(error).partition("; echocal inspect")[0].replace(f"{path} ", "its output ")
            reason = _LONG.sub(lambda match: _cut(match[0]), reason)
            silent = printed.count("")
            some = f"; {silent} of {len(printed)} echoes have no line: print one for each" if silent else ""
            message = f"the lines of the sketch are not understood{_shown(first)}: {reason}{some}"
            raise DataError(message) from None
    if len(found) != len(rows):
        raise DataError(
            f"the sketch prints {len(found)} rows of values for {len(rows)} echoes{_shown(first)}: print "
            "one line for each measurement"
        )
    humidity = found.conditions.get("relative_humidity")
    told = {
        "echo_us": found.echo_time * 1e6 if "echo_time" in found.source_names else None,
        "reading_m": found.reading,
        "temperature_C": found.conditions.get("temperature"),
        "humidity_percent": None if humidity is None else 100.0 * humidity,
    }
    kept = {name: np.round(values, 9) for name, values in told.items() if values is not None}
    return pd.DataFrame(kept)


def _shown(line: str) -> str:
    """Return a line for a message."""
    return f", as '{_cut(line)}'" if line else ""


def _cut(line: str) -> str:
    return line if len(line) <= _SHOWN else f"{line[:_SHOWN]}..."


def _header(played: Played, first: str) -> list[str]:
    """Return the last line before the rows, if it has as many fields as these and is no row itself."""
    above = played.before[-1] if played.before else ""
    signs = [sign for sign in ",;\t" if sign in first]
    fits = bool(signs) and above.count(signs[0]) == first.count(signs[0])
    return [above] if fits and not any(letter.isdigit() for letter in above.split(signs[0])[0]) else []
