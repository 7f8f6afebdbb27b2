"""Rotation nulls: a real residual against its own columns, turned by whole days. Nothing may be named.

Every stretch without a gap and without a change of the level by more than 0.1 m is a circle of whole days.
A turned residual keeps its noise, its steps and its mean day; readings are rounded again. The mean day stays
in phase with sun and temperature, so a cause of that phase can be true. `no mean day` takes the mean of each
time of the day off.
"""

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from common import SURE, Record, run, save, share, text, told

import numpy as np  # isort: skip  (common limits the threads first)
import pandas as pd
import records
import typer
from numpy.typing import NDArray
from records import EXTRA, RECORDS, Kind
from rich.console import Console
from rich.table import Table

import echocal

Column = NDArray[np.float64]

_JUMP = 0.1  # m, of the level: no circle goes across it
_NEAR = 12  # rows on each side that tell the level
_DAY = pd.Timedelta(days=1)


@dataclass(frozen=True)
class Stretch:
    """Whole days of a record without a gap.

    Attributes
    ----------
    table : DataFrame
    residual : ndarray
        Reading of the base less its level [m].
    ratio : ndarray
        What the base makes of a reading of 1 m [1].
    level : float
        [m]
    per_day : int
        Rows of a day.
    step : float
        Resolution of the readings [m]. A turned reading has it too.
    """

    name: str
    table: pd.DataFrame
    residual: Column
    ratio: Column
    level: float
    per_day: int
    step: float

    @property
    def days(self) -> int:
        return len(self.residual) // self.per_day

    def turned(self, days: int, *, whole: bool) -> pd.DataFrame:
        """The table with its residual turned by some days, with its mean day or without it."""
        residual = self.residual if whole else self.residual - self.mean_day()
        reading = (self.level + np.roll(residual, days * self.per_day)) / self.ratio
        reading = np.round(reading / self.step) * self.step
        return self.table.assign(**{_reading(self.name): reading})

    def mean_day(self) -> Column:
        """Mean residual of each time of the day, less the level [m]."""
        by_day = self.residual.reshape(self.days, self.per_day)
        return np.tile(np.nanmean(by_day, axis=0) - np.nanmean(by_day), self.days)


def stretches(name: str) -> Iterator[Stretch]:
    """The stretches of a record with three days or more."""
    kind, table = RECORDS[name], records.load(name)
    column = _reading(name)
    own = records.corrected(table, _base(kind), name)
    ratio = records.corrected(table.assign(**{column: 1.0}), _base(kind), name)
    times = pd.to_datetime(table[kind.time])
    step = times.diff().median()
    per_day = round(_DAY / step)
    series = pd.Series(own)
    around = {"window": _NEAR, "min_periods": 1}
    jump = series[::-1].rolling(**around).median()[::-1] - series.rolling(**around).median().shift()
    far = jump.abs().to_numpy() > _JUMP
    peak = far & (jump.abs() == jump.abs().rolling(2 * _NEAR, center=True, min_periods=1).max()).to_numpy()
    resolution = float(np.diff(np.unique(table[column].dropna().round(6))).min())
    begins = np.flatnonzero((times.diff() > 1.5 * step).to_numpy() | peak)
    for rows in np.split(np.arange(len(table)), begins):
        days = len(rows) // per_day
        if days < 3:
            continue
        rows = rows[: days * per_day]
        values = own[rows]
        level = float(np.nanmedian(values))
        values = np.where(np.abs(values - level) > _JUMP, np.nan, values)
        part = table.iloc[rows].reset_index(drop=True)
        yield Stretch(name, part, values - level, ratio[rows], level, per_day, resolution)


def _reading(name: str) -> str:
    columns = RECORDS[name].columns
    return next((column for column, role in columns.items() if role == "reading_m"), "reading_m")


def _base(kind: Kind) -> echocal.Model:
    return echocal.Model(kind.options.get("base", "linear"))


def independent(stretch: Stretch) -> float:
    """Effective number of independent turns of a stretch.

    The sum of residual times column is a series over the turns. Its autocorrelation is the product of
    those of the two, here of daily means. The column that remembers most decides.
    """
    kind = RECORDS[stretch.name]
    words = {key for key, role in kind.columns.items() if role not in ("time", "ignore", "reading_m")}
    words = words or {"temperature_C", "humidity_percent"}
    daily = _by_lag(_days(stretch.residual, stretch.per_day))
    least = float(stretch.days - 1)
    for word in sorted(words):
        column = stretch.table[word].to_numpy(dtype=float)
        product = daily * _by_lag(_days(column, stretch.per_day))
        end = next((i for i, value in enumerate(product) if value <= 0.0), len(product))
        least = min(least, (stretch.days - 1) / (1.0 + 2.0 * float(product[1:end].sum())))
    return max(least, 1.0)


def _days(values: Column, per_day: int) -> Column:
    return np.nanmean(values.reshape(-1, per_day), axis=1)


def _by_lag(values: Column) -> Column:
    """Circular autocorrelation at lags of 0 to half of the circle."""
    power = np.abs(np.fft.rfft(values - values.mean())) ** 2
    series = np.fft.irfft(power, len(values))
    return series[: len(values) // 2 + 1] / (series[0] or 1.0)


def cut(table: pd.DataFrame, per_day: int, days: int) -> list[pd.DataFrame]:
    """The table in equal parts of whole days, each of about so many days."""
    count = len(table) // per_day
    number = max(1, round(count / days))
    return [
        table.iloc[rows[0] * per_day : (rows[-1] + 1) * per_day].reset_index(drop=True)
        for rows in np.array_split(np.arange(count), number)
    ]


def _ask(task: tuple[str, int, bool, pd.DataFrame]) -> Record:
    name, turn, whole, table = task
    return {"turn": turn, "whole": whole, **records.ask(table, name).said}


def main(
    names: Annotated[str, typer.Option(help="Records, by comma.")] = ",".join(
        n for n in RECORDS if n not in EXTRA
    ),
    turns: Annotated[int, typer.Option(help="Most turns of a stretch, evenly spaced.")] = 24,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    write: Annotated[bool, typer.Option("--write", help="Write rotation.json.")] = False,
    details: Annotated[Path | None, typer.Option(help="Write every answer here, as JSON.")] = None,
) -> None:
    """Turn, ask and report."""
    tasks, counts = [], {}
    for name in names.split(","):
        parts = list(stretches(name))
        days = max(RECORDS[name].days)
        chosen, effective, windows = 0, 0.0, 0
        for part in parts:
            some = np.unique(np.linspace(1, part.days - 1, min(turns, part.days - 1)).round().astype(int))
            pieces = max(1, round(part.days / days))
            chosen, windows = chosen + len(some), windows + pieces
            effective += pieces * min(len(some), independent(part))
            tasks += [
                (name, int(turn), whole, piece)
                for whole in (True, False)
                for turn in some
                for piece in cut(part.turned(int(turn), whole=whole), part.per_day, days)
            ]
        counts[name] = {
            "stretches": len(parts),
            "windows": windows,
            "turns": chosen,
            "independent": effective,
        }
    answers = run(tasks, _ask, "turned windows", processes)
    found = [{"record": task[0], **answer} for task, answer in zip(tasks, answers, strict=True)]
    summary = summarize(found, counts)
    show(summary, Console(width=150))
    if details:
        details.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    if write:
        save("rotation", summary)


def summarize(found: list[Record], counts: Record) -> Record:
    """Figures of every record, with the mean day and without it."""
    rows = {}
    for name in counts:
        for whole in (True, False):
            own = [one for one in found if one["record"] == name and one["whole"] == whole]
            rows[f"{name}, {'whole' if whole else 'no mean day'}"] = _figures(own)
    for whole in (True, False):
        own = [one for one in found if one["whole"] == whole]
        rows[f"all, {'whole' if whole else 'no mean day'}"] = _figures(own)
    return {"rounded": True, "counts": counts, "figures": rows}


def _figures(own: list[Record]) -> Record:
    names = Counter(cause["id"] for one in own for cause in told(one["causes"]))
    believed = [
        any(c["kind"] == "effect" and c["in_model"] and c["probability"] > SURE for c in one["causes"])
        for one in own
    ]
    return {
        "named": share(sum(bool(told(one["causes"])) for one in own), len(own)),
        "believed": share(sum(believed), len(own)),
        "verdict_named": share(sum(one["verdict"] == "named" for one in own), len(own)),
        "names": dict(names.most_common()),
        "verdicts": dict(Counter(one["verdict"] for one in own)),
    }


def show(summary: Record, console: Console) -> None:
    """Print the figures."""
    table = Table("record", "a cause named", "above 0.9, named or not", "verdict named", "names")
    for label, row in summary["figures"].items():
        names = ", ".join(f"{key} {count}" for key, count in row["names"].items())
        table.add_row(label, text(row["named"]), text(row["believed"]), text(row["verdict_named"]), names)
    console.print(table)
    for name, count in summary["counts"].items():
        console.print(f"{name}: {count}")


if __name__ == "__main__":
    typer.run(main)
