"""Transfer on real records: a model from one window of a record corrects every other window."""

import itertools
import json
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

from common import LIKELY, Record, run, save, share, text, told

import numpy as np  # isort: skip  (common limits the threads first)
import records
import recurrence
import typer
from numpy.typing import NDArray
from records import RECORDS, Asked
from rich.console import Console
from rich.table import Table

import echocal

Column = NDArray[np.float64]


def main(
    names: Annotated[str, typer.Option(help="Records, by comma.")] = ",".join(RECORDS),
    most: Annotated[int, typer.Option(help="Most windows of a length.")] = 1000,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    write: Annotated[bool, typer.Option("--write", help="Write transfer.json.")] = False,
    details: Annotated[Path | None, typer.Option(help="Write every window and pair here, as JSON.")] = None,
) -> None:
    """Diagnose every window, correct every other one with its model, and report."""
    tasks = [
        (name, days, i, table)
        for name in names.split(",")
        for days in RECORDS[name].days
        for i, table in enumerate(records.windows(name, days)[:most])
    ]
    answers = run(tasks, _ask, "windows", processes)
    groups = {key: list(part) for key, part in itertools.groupby(range(len(tasks)), lambda k: tasks[k][:2])}
    jobs = [
        (name, i, j, [(tasks[k][3], answers[k]) for k in (part[i], part[j])])
        for (name, _), part in groups.items()
        for i, j in itertools.permutations(range(len(part)), 2)
    ]
    found = iter(run(jobs, _pair, "pairs", processes))
    outcome: Record = {}
    for (name, days), part in groups.items():
        label = f"{name}, {days} d"
        windows = [answers[k].said for k in part]
        pairs = [next(found) for _ in itertools.permutations(range(len(part)), 2)]
        outcome[label] = {"extra": name in records.EXTRA, "windows": windows, "pairs": pairs}
    summary = summarize(outcome)
    show(summary, Console(width=150))
    if details:
        details.write_text(json.dumps(outcome, indent=1) + "\n", encoding="utf-8")
    if write:
        save("transfer", summary)


def _ask(task: tuple[str, int, int, Any]) -> Asked:
    return records.ask(task[3], task[0])


def _pair(job: tuple[str, int, int, list[tuple[Any, Asked]]]) -> Record:
    """Variance of one window by the model of another one, and by the base [m^2]."""
    name, source, target, ((_, giver), (table, own)) = job
    models = {"model": giver.model, "with_shape": giver.with_shape}
    before = records.corrected(table, giver.base, name)[own.rows]
    record: Record = {"source": source, "target": target, "changes": bool(giver.model.effects)}
    for key, model in models.items():
        if model is None or (key == "model" and not model.effects):
            record[key] = None
            continue
        try:
            after = records.corrected(table, model, name)[own.rows]
        except echocal.DataError as error:
            record[key] = {"refused": str(error)}
            continue
        known = np.isfinite(before) & np.isfinite(after)
        record[key] = {
            level: {
                "base": variance(before[known], group[known]),
                "model": variance(after[known], group[known]),
            }
            for level, group in (("segments", own.groups), ("window", np.zeros_like(own.groups)))
        } | {"lost_rows": int(np.sum(np.isfinite(before) & ~known))}
    record["questions"] = recurrence.questions(table, name, giver, own, before)
    return record


def variance(values: Column, groups: NDArray[np.int64]) -> float:
    """Variance about the mean of each group [m^2]."""
    _, place = np.unique(groups, return_inverse=True)
    means = np.bincount(place, values) / np.bincount(place)
    return float(np.mean((values - means[place]) ** 2))


def removed(pair: Record, key: str = "model", level: str = "segments") -> float | None:
    """Share of the variance that a model removes; 0 where it is the base, None where it cannot be used."""
    figures = pair[key]
    if figures is None:
        return 0.0
    if "refused" in figures:
        return None
    return 1.0 - figures[level]["model"] / figures[level]["base"]


def summarize(outcome: Record) -> Record:
    """Figures of every record and window, and of all."""
    figures = {label: _figures([part]) for label, part in outcome.items()}
    figures["all but extra"] = _figures([part for part in outcome.values() if not part["extra"]])
    return {"figures": figures, "windows": {label: _windows(part) for label, part in outcome.items()}}


def _windows(part: Record) -> list[Record]:
    """Each window: what it names, what it reports, and the share that its model removes in the others."""
    return [
        {
            "verdict": said["verdict"],
            "named": [cause["id"] for cause in told(said["causes"])],
            "in_model": [c["id"] for c in said["causes"] if c["kind"] == "effect" and c["in_model"]],
            "reported": said["gain"],
            "removed": [removed(pair) for pair in part["pairs"] if pair["source"] == i],
        }
        for i, said in enumerate(part["windows"])
    ]


def _figures(parts: list[Record]) -> Record:
    pairs = [pair for part in parts for pair in part["pairs"]]
    acting = [pair for pair in pairs if pair["changes"] or pair["with_shape"] is not None]
    names = Counter(
        cause["id"] for part in parts for said in part["windows"] for cause in told(said["causes"])
    )
    gains = [said["gain"] for part in parts for said in part["windows"] if told(said["causes"])]
    return {
        "windows": sum(len(part["windows"]) for part in parts),
        "verdicts": dict(Counter(said["verdict"] for part in parts for said in part["windows"])),
        "names": dict(names.most_common()),
        "refused": sum(removed(pair) is None for pair in pairs),
        "worse": _worse(pairs),
        "worse_of_changed": _worse([pair for pair in pairs if pair["changes"]]),
        "worse_of_named": _worse(_named(parts)),
        "mean_removed_of_named": _mean([removed(pair) for pair in _named(parts)]),
        "worse_one_level": _worse(pairs, level="window"),
        "mean_removed": _mean([removed(pair) for pair in pairs]),
        "mean_removed_of_changed": _mean([removed(pair) for pair in pairs if pair["changes"]]),
        "mean_removed_one_level": _mean([removed(pair, level="window") for pair in pairs]),
        "mean_reported_gain_where_named": _mean(gains),
        "with_shape": {
            "pairs": sum(pair["with_shape"] is not None for pair in pairs),
            "worse": _worse([pair for pair in acting if pair["with_shape"] is not None], "with_shape"),
            "mean_removed": _mean([removed(p, "with_shape") for p in acting if p["with_shape"] is not None]),
        },
        "recurrence": _recurrence(parts),
    }


def _named(parts: list[Record]) -> list[Record]:
    """Pairs whose source names a cause."""
    return [
        pair for part in parts for pair in part["pairs"] if told(part["windows"][pair["source"]]["causes"])
    ]


def _worse(pairs: list[Record], key: str = "model", level: str = "segments") -> Record | None:
    values = [value for pair in pairs if (value := removed(pair, key, level)) is not None]
    return share(sum(value < -1e-9 for value in values), len(values))


def _mean(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _recurrence(parts: list[Record]) -> Record:
    """How often a cause that one window names is named, or probable, in another one of the same record."""
    counts: Counter[str] = Counter()
    for part in parts:
        for one, other in itertools.permutations(part["windows"], 2):
            for cause in told(one["causes"]):
                counts["asked"] += 1
                own = {cause["id"], *cause["indistinguishable_from"]}
                effects = [c for c in other["causes"] if c["kind"] == "effect"]
                likely = [c for c in effects if c["probability"] > LIKELY and c["in_model"]]
                counts["named"] += cause["id"] in {c["id"] for c in told(effects)}
                counts["named_class"] += any(own & _class(c) for c in told(effects))
                counts["likely"] += cause["id"] in {c["id"] for c in likely}
                counts["likely_class"] += any(own & _class(c) for c in likely)
    keys = ("named", "named_class", "likely", "likely_class")
    every = [question for part in parts for pair in part["pairs"] for question in pair["questions"]]
    return {key: share(counts[key], counts["asked"]) for key in keys} | recurrence.counted(every)


def _class(cause: Record) -> set[str]:
    return {cause["id"], *cause["indistinguishable_from"]}


def show(summary: Record, console: Console) -> None:
    """Print the figures."""
    table = Table("record", "verdicts", "named", "worse", "share removed", "changed pairs", "recurs (class)")
    for label, row in summary["figures"].items():
        worse, changed = row["worse"], row["worse_of_changed"]
        mean = "-" if row["mean_removed"] is None else f"{row['mean_removed']:+.3f}"
        of_changed = row["mean_removed_of_changed"]
        table.add_row(
            label,
            ", ".join(f"{key} {count}" for key, count in row["verdicts"].items()),
            ", ".join(f"{key} {count}" for key, count in row["names"].items()),
            text(worse),
            mean,
            text(changed) + ("" if of_changed is None else f" {of_changed:+.3f}"),
            text(row["recurrence"]["named_class"]),
        )
    console.print(table)


if __name__ == "__main__":
    typer.run(main)
