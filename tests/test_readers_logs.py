"""Each kind of log is read with at most one flag, or refused with the one that mends it."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from realistic_logs import drawn
from realistic_logs_more import LOGS

import echocal
from echocal.cli import main

Run = Callable[..., tuple[int, str, str]]
FIXED = ("--constant-distance", "--reading-speed", "343")


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    """Run a command line in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def command(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["echocal", *words])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command


@pytest.mark.parametrize("kind", LOGS)
def test_a_log_is_read_with_at_most_one_flag(kind: str, shell: Run, random: np.random.Generator) -> None:
    truth = drawn(random)
    made = LOGS[kind](truth)
    Path(made.name).write_bytes(made.content)
    guessed = made.flags == ["--options"]
    code, out, err = shell(
        "inspect", made.name, "-o", "log.toml", "--json", "-", *([] if guessed else made.flags)
    )
    assert code == 0, err
    found = json.loads(out)
    assert found["usable"] is not None, found["refusal"]
    flags = made.flags
    if guessed:  # only its owner can say: refused, and the message has the flag
        code, _, err = shell("diagnose", made.name, *FIXED, "-q")
        assert code == 3
        assert "--column" in err
        assert "inspect LOG -o log.toml" in err
        flags = ["--options", "log.toml"]
    code, out, err = shell("diagnose", made.name, *FIXED, "--json", "-", *flags)
    assert code == 0, err
    document = json.loads(out)
    rows = made.readings * len(truth.seconds)
    assert rows <= document["rows"]["total"] <= rows + 1
    assert document["rows"]["used"] >= rows - 2
    level = 1e-3 if made.temperature else 0.1  # the base explains the readings where the air is known
    assert document["gain"]["rms_before_m"] < 3 * level
    if made.time:
        assert found["clock"]["usual_step_s"] == pytest.approx(600.0)


@pytest.mark.parametrize("kind", LOGS)
def test_what_is_read_is_what_was_written(kind: str, random: np.random.Generator, tmp_path: Path) -> None:
    truth = drawn(random)
    made = LOGS[kind](truth)
    (tmp_path / made.name).write_bytes(made.content)
    options: dict[str, Any] = {"reading_speed": 343, "columns": {}}
    if made.flags[:1] == ["--column"]:
        options["columns"] = dict([made.flags[1].split("=")])
    elif made.flags[:1] == ["--encoding"]:
        options["encoding"] = made.flags[1]
    elif made.flags == ["--options"]:
        from echocal.observations.inspection import inspect_log

        options["columns"] = inspect_log(tmp_path / made.name).requests
    data = _quietly(tmp_path / made.name, **options)
    usable = data.usable
    if made.readings == 1 and len(data) == len(truth.distance):
        distance = data.echo_time * 343.0 / 2.0
        assert np.abs(distance - truth.distance)[usable].max() < 1e-3
        if made.temperature:
            assert np.abs(data.conditions["temperature"] - truth.temperature)[usable].max() < 0.06
        if made.time:
            assert data.conditions["elapsed_time"][usable].tolist() == pytest.approx(
                truth.seconds[usable], abs=1.0
            )
        if data.time is not None:
            assert abs(data.time[0] - np.datetime64(truth.start.replace(tzinfo=None))) < np.timedelta64(
                1, "s"
            )
    assert usable.sum() >= made.readings * len(truth.distance) - 2


def _quietly(path: Path, **options: Any) -> echocal.Observations:
    import warnings

    with warnings.catch_warnings(action="ignore"):
        return echocal.read_observations(path, **options)
