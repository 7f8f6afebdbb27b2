"""How a table is read is said once: the same options, with the same defaults, for all who read."""

import inspect
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from typer.main import get_command

import echocal
from echocal.cli import app
from echocal.correct.batch import job_of
from echocal.correct.job import Job
from echocal.correct.rows import Reading
from echocal.observations.given import READ_OPTIONS
from echocal.observations.options import ReadOptions

PACKAGE = Path(echocal.__file__).parent
ALL: dict[str, Any] = {
    "columns": {"R": "level_m below 2.6 m"},
    "reading_speed": "343",
    "missing": {"R": ["-1"]},
    "trust": ("R",),
    "time_zone": "Europe/Copenhagen",
    "skip_lines": 2,
    "decimal": ",",
    "encoding": "latin-1",
    "time_format": "%d.%m.%Y %H:%M",
    "at": {"temperature": "20+-2"},
    "sheet": "log",
    "mount_height": 2.6,
    "reference": "gauge.csv",
    "reference_join": "nearest",
}
WITHOUT = {"correct": {"sheet"}, "watch": {"sheet", "reference", "reference_join"}}


@pytest.mark.parametrize("name", ["diagnose", "verify", "calibrate", "correct", "watch", "inspect"])
def test_a_command_has_a_flag_for_each_option(name: str) -> None:
    command: Any = get_command(app)
    with command.make_context("echocal", [], resilient_parsing=True) as context:
        flags = {flag.name: flag for flag in command.get_command(context, name).params}
    for option in READ_OPTIONS:
        if option in WITHOUT.get(name, set()):
            continue
        usual = getattr(ReadOptions, option)
        given = flags[option].default
        assert given == usual if isinstance(usual, str | int) else not given, option


def test_keywords_and_options_are_the_same() -> None:
    keywords = inspect.signature(echocal.read_observations).parameters
    assert list(keywords)[1:] == list(READ_OPTIONS) == list(ALL)
    assert all(keywords[name].default == getattr(ReadOptions, name) for name in READ_OPTIONS)
    found = [
        f"{path.name}: {line.strip()}"
        for path in PACKAGE.rglob("*.py")
        for line in path.read_text().splitlines()
        if re.search(r'(time_)?zone"?[:,\w ]*[=:,] "UTC"', line)
    ]
    assert found == ['options.py: time_zone: str = "UTC"']


def test_a_worker_is_told_all_options() -> None:
    options = ReadOptions(**ALL)
    assert options.given() == ALL
    assert ReadOptions(**options.plain()) == options
    assert ReadOptions().given() == ReadOptions().plain() == {}
    reading = Reading.of(ALL, ["echo_us=10"], mark_rows=False)
    job = job_of(echocal.Model("linear"), None, None, reading, None)
    from echocal.engines.worker import models_digest

    task = {"job": job, "digest": models_digest(job["models"])}
    assert Job.of(task).reading == reading
    assert {one.name for one in fields(Reading)} - set(ALL) == {
        "layout",
        "requests",
        "mark_rows",
        "uncertainties",
    }


def test_every_verb_takes_all_options(tmp_path: Path) -> None:
    """A log that needs most of them: `correct` refused `at`, `correct_files` knew no `skip_lines`."""
    log = tmp_path / "log.csv"
    log.write_text(
        "logger\n\nZeit;R\n1.2.2026 08:30;1,5\n1.2.2026 08:40;-1\n1.2.2026 08:50;1,6\n", encoding="latin-1"
    )
    how = {**ALL, "columns": {"R": "reading_m", "Zeit": "time"}}
    for own in ("sheet", "mount_height", "reference", "reference_join"):
        del how[own]
    model = echocal.Model("343", {"zero_error": {"offset": 0.1}})
    with pytest.warns(echocal.DataWarning, match="1 of 3 rows cannot be used: 1 R missing"):
        read = echocal.read_observations(log, **how)
    table = echocal.correct(log, model, **how).table
    echocal.correct_files(log, tmp_path / "out.csv", model, **how)
    written = pd.read_csv(tmp_path / "out.csv", sep=";", decimal=",", skiprows=2, encoding="latin-1")
    for found in (table, written):
        assert found["corrected_distance_m"].round(6).tolist()[::2] == [1.4, 1.5]
        assert found["status"].fillna("").tolist() == read.unusable.tolist()
