"""What difference matters: it decides what is told, and nothing else."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.diagnose.results.brief import brief
from echocal.errors import UsageError

ROOM = ("matters_mm", "matters_because", "good_enough", "seconds")


def bench(
    random: np.random.Generator, delay: float, tick: float = 0.0, noise: float = 1e-6, rows: int = 400
) -> dict[str, np.ndarray]:
    """Echo times at three distances, late by a delay [s], in ticks of a timer [s]."""
    warm = random.uniform(5.0, 30.0, rows)
    away = random.choice([0.5, 1.2, 2.5], rows)
    echo = 2.0 * away / (331.4 + 0.6 * warm) + delay + random.normal(0.0, noise, rows)
    echo = np.round(echo / tick) * tick if tick else echo
    return {"echo_s": echo, "temperature_C": warm.round(2), "distance_m": away}


def test_a_base_that_is_right_to_a_tenth_of_a_millimeter_is_good_enough(
    random: np.random.Generator,
) -> None:
    """In nearly all draws: an error of 0.1 mm is detected, and told to be too small to matter."""
    found = [echocal.diagnose(bench(random, 0.6e-6, noise=0.3e-6)) for _ in range(20)]
    seen = [one for one in found if one.verdict != "nothing"]
    assert len(seen) >= 15, "the effect is large enough to be detected"
    for one in seen:
        assert one.good_enough, one.explain()
        assert brief(one).next == "nothing to correct."
        assert one.explain().startswith("The base is good enough: ")
        assert "does not matter" in one.explain().splitlines()[2]
    assert not any(one.good_enough for one in found if one.verdict == "nothing"), (
        "nothing is no proof of good"
    )


def test_an_error_that_matters_is_never_told_to_be_good_enough(random: np.random.Generator) -> None:
    for delay in (3e-6, -5e-6, 20e-6, 85e-6):  # 0.5 to 15 mm
        one = echocal.diagnose(bench(random, delay))
        assert not one.good_enough, one.explain()
        assert one.causes[0].contribution_m == pytest.approx(170.0 * abs(delay), rel=0.2)


def test_it_changes_what_is_told_and_nothing_else(random: np.random.Generator) -> None:
    table = bench(random, 20e-6)
    usual, coarse = (echocal.diagnose(table, matters_mm=mm) for mm in (None, 10.0))
    assert not usual.good_enough
    assert coarse.good_enough
    one, other = usual.to_dict(), coarse.to_dict()
    for said in (one, other):
        for name in ROOM:
            said.pop(name)
        for cause in said["causes"]:
            cause.pop("matters")
    assert one == other
    assert usual.model.hash == coarse.model.hash


def test_several_effects_count_together(random: np.random.Generator) -> None:
    """Two of 2.5 mm and more are not good enough where 4 mm matter, if together they make 5 mm."""
    two = 0
    for _ in range(10):
        table = bench(random, 15e-6)
        table["echo_s"] *= 1.0 + 2.5e-3 / 2.5
        one = echocal.diagnose(table)
        each = [cause.contribution_m for cause in one.causes if cause.in_model and cause.contribution_m]
        if one.verdict == "named" and len(each) == 2:  # in nearly all draws
            two += 1
            between = 1e3 * (max(each) + sum(each)) / 2.0
            assert not echocal.diagnose(table, matters_mm=between).good_enough
            assert echocal.diagnose(table, matters_mm=1e3 * sum(each) * 1.01).good_enough
    assert two >= 2


def test_the_default_comes_from_the_steps_of_the_readings_or_from_a_datasheet(
    random: np.random.Generator,
) -> None:
    fine, coarse = (echocal.diagnose(bench(random, 85e-6, tick)) for tick in (0.0, 58e-6))
    assert (fine.matters_mm, fine.matters_because) == (0.3, "a tenth of the 3 mm of an HC-SR04's datasheet")
    assert coarse.matters_mm == pytest.approx(58e-6 * 171.0 / 12**0.5 * 1e3, rel=0.05)
    assert "in steps of " in coarse.matters_because
    stated = echocal.diagnose(bench(random, 85e-6), matters_mm=2)
    assert (stated.matters_mm, stated.matters_because) == (2.0, "stated: matters_mm=2")


@pytest.mark.parametrize("given", [0, -1.0, float("nan"), float("inf"), "1"])
def test_a_difference_that_is_no_length_is_refused(given: object, random: np.random.Generator) -> None:
    with pytest.raises(UsageError, match="in mm, above 0"):
        echocal.diagnose(bench(random, 0.0), matters_mm=given)


def test_the_command_says_it_and_json_keeps_the_verdict(
    tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    table = bench(random, 20e-6)
    rows = np.column_stack([1e6 * table["echo_s"], table["temperature_C"], table["distance_m"]])
    np.savetxt("t.csv", rows, delimiter=",", header="echo_us,temperature_C,distance_m", comments="")
    done = CliRunner().invoke(app, ["diagnose", "t.csv", "--matters-mm", "10"])
    assert "good enough: fixed_delay" in done.output
    assert "(stated: --matters-mm 10)" in done.output
    said = json.loads(
        CliRunner().invoke(app, ["diagnose", "t.csv", "--matters-mm", "10", "--json", "-"]).stdout
    )
    without = json.loads(CliRunner().invoke(app, ["diagnose", "t.csv", "--json", "-"]).stdout)
    assert (said["verdict"], said["good_enough"], said["matters_mm"]) == (without["verdict"], True, 10.0)
