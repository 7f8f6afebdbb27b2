"""``--explore``: the Pareto front, measured if the tools are installed, else by the cost model."""

import json
import re
import shlex
import sys
from pathlib import Path

import pytest

from echocal import Model, silicon
from echocal.cli import main
from echocal.errors import BoundError
from echocal.explore import FORMS, Choice, explore

CODES = {"temperature": (1.0, 0.0, 40.0), "echo": 5000, "n_threads": 2}


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["echocal", "firmware", *words])
    with pytest.raises(SystemExit) as stopped:
        main()
    return int(stopped.value.code or 0)


@pytest.fixture(scope="module")
def choices() -> list[Choice]:
    return explore(Model("cramer"), "avr", **CODES)


@pytest.mark.slow
def test_the_front_has_no_dominated_choice(choices: list[Choice]) -> None:
    assert len(choices) > 3
    for axis in ("flash", "steps", "error"):
        assert len({getattr(one, axis) for one in choices}) > 2, "there is something to choose"
    assert not any(one.dominates(other) for one in choices for other in choices)


@pytest.mark.slow
def test_figures_are_measured(choices: list[Choice]) -> None:
    for one in choices:
        found = silicon.measure(one.made, "avr")
        assert found is not None
        assert (one.flash, one.steps, one.core, one.figures) == (
            found.flash_bytes,
            found.cycles,
            "avr",
            "measured",
        )
        assert one.error == one.made.report["error_proven_m"]


def test_without_tools_figures_are_named_as_those_of_the_cost_model(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(silicon, "measure", lambda *_: None)
    for one in explore(Model("cramer"), "avr", **CODES):
        assert (one.core, one.figures) == (None, "cost model")
        assert (one.flash, one.steps) == one.made.ranked_by()
        assert one.to_dict()["unit"] == "cycles", "of the target"


def test_a_bound_beyond_every_form_is_refused_as_ever() -> None:
    with pytest.raises(BoundError, match="the best reachable is"):
        explore(Model("cramer"), "avr", max_error=1e-9, **CODES)


@pytest.mark.slow
def test_the_command_writes_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Model("cramer").save("model.json")
    words = (
        "--temperature-lsb",
        "1",
        "--temperature-range",
        "0:40",
        "--echo-max-us",
        "5000",
        "--target",
        "avr",
    )
    assert run(monkeypatch, "model.json", *words, "--explore", "--json", "-", "-o", "made") == 0
    out, shown = capsys.readouterr()
    assert "error [mm]" in shown, "a unit is no markup"
    answer = json.loads(out)
    assert answer == json.loads(Path("made/choices.json").read_text())
    assert Path("made/choices.png").read_bytes().startswith(b"\x89PNG")
    assert "measured on avr" in shown
    first = answer["choices"][0]
    assert run(monkeypatch, *shlex.split(first["command"])[2:], "--measure", "-o", "first") == 0
    report = json.loads(Path("first/report.json").read_text())
    assert report["error_proven_m"] == first["error_proven_m"]
    assert (report["flash_bytes"], report["cycles"]) == (first["flash_bytes"], first["steps"])


def test_options_that_make_no_sense_together_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Model("cramer").save("model.json")
    for more in (["--measure"], ["--prefer", "speed"]):
        assert run(monkeypatch, "model.json", "--explore", *more, "-o", "made") == 2
        told = " ".join(capsys.readouterr().err.split())
        assert "leave out --prefer, --form, --measure, --uncertainty, --per-unit, --median, " in told


def test_every_form_of_the_core_is_tried() -> None:
    files = Path(__file__).parents[2] / "firmware_gen" / "src" / "form"
    rooms = (files / "temperature.rs").read_text(), (files / "mod.rs").read_text().partition("BENT_FORMS:")[2]
    listed = re.findall(r"(\w+)::NAME, \w+::propose", "".join(rooms))
    assert sorted(listed) == sorted(FORMS)
