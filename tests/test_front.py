"""``echocal LOG``: five lines first, questions for a person only, and commands that run as they stand."""

import json
import os
import pty
import re
import select
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import _front, app
from echocal.diagnose.results.brief import brief
from echocal.errors import UsageError
from echocal.observations.inspection import inspect_log

Run = Callable[..., tuple[int, str]]
LABELS = ["what is wrong", "by how much", "how sure", "written", "what next"]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")

    def run(*words: str) -> tuple[int, str]:
        done = CliRunner().invoke(app, [*words])
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            return getattr(done.exception, "exit_code", 99), str(done.exception)
        return done.exit_code, done.output

    return run


def speed(temperature: np.ndarray) -> np.ndarray:
    return 331.4 + 0.6 * temperature


def log(random: np.random.Generator, name: str, *, delay: float = 0.0, ruler: bool = True) -> None:
    """A bench at three distances, each in air of all temperatures; echo times in us."""
    warm = random.uniform(5.0, 30.0, 240)
    away = np.tile([0.5, 1.2, 2.5], 80)
    echo = 2e6 * away / speed(warm) + 1e6 * delay + random.normal(0.0, 2.0, 240)
    columns = {"echo_us": echo.round(2), "temperature_C": warm.round(2), "distance_m": away}
    names = [one for one in columns if ruler or one != "distance_m"]
    rows = zip(*(columns[one] for one in names), strict=True)
    Path(name).write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]) + "\n")


def test_the_first_five_lines_answer_five_questions(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv", delay=85e-6)
    code, said = run("bench.csv")
    assert code == 0
    lines = said.splitlines()
    assert [line[:13].strip() for line in lines[:5]] == LABELS
    wrong, size, sure, written, after = lines[:5]
    assert "named: " in wrong
    assert re.search(r"\d\(\d+(\.\d+)?\) (us|mm)", size), "a size with its uncertainty"
    assert "probability" in sure
    assert "240 of 240 rows" in sure
    assert "correct" in after
    for name in ("bench-report.html", "bench-model.json"):
        assert name in written
        assert Path(name).is_file()
    commands = [line for line in lines if line.startswith("echocal ")]
    assert 2 <= len(commands) <= 3
    for command in commands:
        _, *words = shlex.split(command)
        assert run(*words)[0] == 0, command
    assert Path("bench-corrected.csv").is_file()


def test_it_may_run_again_and_replaces_no_file_of_the_user(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv", delay=85e-6)
    assert run("bench.csv", "-q") == (0, "")
    assert run("bench.csv", "-q") == (0, "")
    Path("bench-report.html").write_text("mine")
    code, said = run("bench.csv", "-q")
    assert code == 2
    assert "bench-report.html exists" in said


def test_json_on_stdout_is_alone(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv")
    done = CliRunner().invoke(app, ["bench.csv", "--json", "-"])
    assert json.loads(done.stdout)["schema"] == "echocal.diagnosis/1"
    assert "wrote bench-report.html, bench-model.json" in done.stderr


def test_nobody_at_the_terminal_is_asked_nothing(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv", ruler=False)
    code, said = run("bench.csv")
    assert code == 3
    assert "--constant-distance" in said
    assert "--reference-distance" in said
    Path("unnamed.csv").write_text("\n".join(f"{1200 + n % 7},{20 + n / 50}" for n in range(60)) + "\n")
    code, said = run("unnamed.csv")
    assert code == 3
    assert "--yes" in said
    assert "--constant-distance" in said
    assert '--at "temperature=20+-2"' in said
    assert run("unnamed.csv", "--yes", "--constant-distance", "--at", "temperature=20+-2")[0] == 0


def test_a_misspelled_name_is_told_with_the_question(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv")
    text = Path("bench.csv").read_text()
    for right, wrong in (("temperature_C", "temprature_C"), ("distance_m", "distnce_m")):
        Path("typo.csv").write_text(text.replace(right, wrong, 1))
        code, said = run("typo.csv")
        assert code == 3
        assert f'did you mean: --column "{wrong}={right}"' in said


def test_a_person_is_asked_and_the_answer_is_kept(tmp_path: Path, random: np.random.Generator) -> None:
    """The options file has the answers: the commands that follow need no question."""
    os.chdir(tmp_path)
    log(random, "tank.csv", ruler=False)
    near = np.loadtxt("tank.csv", delimiter=",", skiprows=1)[::3]
    np.savetxt("tank.csv", near, delimiter=",", header="echo_us,temperature_C", comments="", fmt="%.2f")
    said = typed("tank.csv", "one meter\n0.5\n")
    assert "How far was the target" in said
    assert "'one meter'" in said, "what is no number is asked again"
    assert "reference-distance = 0.5" in Path("tank-options.toml").read_text()
    assert "--options tank-options.toml" in said


def typed(log: str, answers: str) -> str:
    """What a person at a terminal sees who types these answers, each when the prompt is there."""
    master, slave = pty.openpty()
    words = [sys.executable, "-m", "echocal", log]
    shell = {**os.environ, "COLUMNS": "300", "TERM": "dumb"}
    process = subprocess.Popen(words, stdin=slave, stdout=slave, stderr=slave, env=shell)
    os.close(slave)
    seen, waiting = "", answers.splitlines(keepends=True)
    while select.select([master], [], [], 120.0)[0]:
        try:
            part = os.read(master, 4096)
        except OSError:
            break
        if not part:
            break
        seen += part.decode()
        if waiting and seen.endswith("distance [m] []: ".replace(" []", "")):
            os.write(master, waiting.pop(0).encode())
    assert process.wait(60) == 0, seen
    return seen


def test_a_word_that_is_neither_command_nor_file_is_told(run: Run) -> None:
    for word, hint in (("dignose", "did you mean 'diagnose'?"), ("absent.csv", "no file absent.csv")):
        code, said = run(word)
        assert code in (2, 3)
        assert hint in said


def test_a_folder_is_no_log(run: Run, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    code, said = run("logs")
    assert code == 2
    assert "echocal diagnose logs --by" in said


@pytest.mark.parametrize("words", [[], ["diagnose"], ["effects", "show"], ["log.csv"]])
def test_h_is_help(run: Run, words: list[str]) -> None:
    code, said = run(*words, "-h")
    assert code == 0
    assert "Usage:" in said


@pytest.mark.parametrize(
    ("typed_so_far", "offered"),
    [
        ("diagnose log.csv --base c", "cramer"),
        ("calibrate log.csv --fit fixed_d", "fixed_delay.delay"),
        ("firmware m.json --target cortex-m4", "cortex-m4f"),
        ("effects show hum", "humidity"),
    ],
)
def test_values_are_completed(typed_so_far: str, offered: str) -> None:
    words = {"COMP_WORDS": f"echocal {typed_so_far}", "COMP_CWORD": str(len(typed_so_far.split()))}
    asked = {**os.environ, **words, "_ECHOCAL_COMPLETE": "complete_bash"}
    call = "from echocal.cli import app; app(prog_name='echocal')"
    done = subprocess.run(
        [sys.executable, "-c", call], env=asked, capture_output=True, text=True, check=False
    )
    assert offered in done.stdout.split()


@pytest.mark.parametrize(
    "words",
    [
        ["diagnose", "bench.csv", "--report", "OUT.html"],
        ["diagnose", "bench.csv", "--json", "OUT.json", "--details"],
        ["sweep", "--temperature", "0:10:5", "--distance", "1", "-o", "OUT.csv"],
        ["calibrate", "bench.csv", "--fit", "fixed_delay", "-o", "OUT.json"],
        ["inspect", "bench.csv", "-o", "OUT.toml"],
        ["verify", "bench.csv", "--maximum-permissible-error-mm", "30", "--json", "OUT.json"],
        ["correct", "bench.csv", "-o", "OUT.csv"],
        ["simulate", "--design", "quick", "-o", "OUT.csv"],
        ["effects", "list", "--json", "OUT.json"],
    ],
    ids=lambda words: words[0],
)
def test_every_command_says_what_it_wrote(run: Run, random: np.random.Generator, words: list[str]) -> None:
    log(random, "bench.csv")
    code, said = run(*words)
    assert code == 0, said
    (file,) = [word for word in words if word.startswith("OUT")]
    assert said.count(file) >= 1
    assert Path(file).is_file()
    assert not words[0].startswith("c") or run(*words, "-q") == (0, "")


def test_a_folder_that_cannot_be_made_is_told_before_the_diagnosis(
    run: Run, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise FileNotFoundError(2, "No such file or directory")

    log(random, "bench.csv")
    monkeypatch.setattr(Path, "mkdir", refuse)  # as in /proc, where a superuser seems to be allowed
    monkeypatch.setattr("echocal.cli._front.diagnose", lambda *_, **__: pytest.fail("diagnosed first"))
    code, said = run("bench.csv", "--out", "made")
    assert (code, "made cannot be written" in said) == (2, True), said


def test_a_word_is_no_distance() -> None:
    with pytest.raises(UsageError, match="'d' is no distance: type a number of meters"):
        _front._refuse_answer("d")


def test_a_file_with_a_dash_is_named_in_its_folder(run: Run, random: np.random.Generator) -> None:
    log(random, "-dash.csv")
    code, said = run("./-dash.csv")
    assert (code, "echocal diagnose ./-dash.csv" in said) == (0, True), said
    assert " -dash.csv" not in said


def test_no_smaller_error_than_what_matters_is_proposed(run: Run, random: np.random.Generator) -> None:
    log(random, "bench.csv", delay=85e-6)
    code, said = run("bench.csv", "--matters-mm", "50")
    assert code == 0
    assert "good enough" in said
    assert "a permissible error of 50 mm" in said
    assert "--maximum-permissible-error-mm 50 " in said


def test_help_does_not_give_linear_another_line(run: Run) -> None:
    said = " ".join(run("diagnose", "--help")[1].split())
    assert "linear: 331.4+0.6*T" in said
    assert "331.3+0.606*T (linear" not in said


def test_a_column_in_another_unit_is_to_be_mended_and_not_corrected(run: Run) -> None:
    """Before, it proposed a `correct` that is refused, and said "None of 27 rows can be used"."""
    table = pd.read_csv(Path(__file__).parents[1] / "examples" / "study_table2.csv", comment="#")
    table["reading_m"] *= 1000.0
    table.to_csv("mm.csv", index=False)
    code, said = run("mm.csv")
    assert (code, "unit_mixup" in said) == (0, True), said
    assert "mend the program or the table" in " ".join(said.split())
    assert "echocal correct" not in said
    assert "factor = 1000" in " ".join(said.split())
    assert "None" not in said


def test_what_stands_in_the_beam_is_told_with_its_place_and_what_to_do(random: np.random.Generator) -> None:
    distance = np.repeat([0.4, 0.8, 1.2, 1.6, 2.0], 12)
    celsius = random.uniform(15.0, 25.0, 60)
    reading = np.minimum(distance, 1.7) + random.normal(0.0, 1e-3, 60)
    echo_us = 1e6 * echocal.time_of_flight(reading, celsius, law="linear")
    table = {"echo_us": echo_us, "temperature_C": celsius, "distance_m": distance}
    said = brief(echocal.diagnose(table))
    (at,) = re.findall(r"distance = ([0-9.]+)\([0-9]+\) mm", said.size)
    assert float(at) == pytest.approx(1700.0, abs=1.5)
    assert "look along the beam" in said.next


def raw(random: np.random.Generator, count: int = 120) -> pd.DataFrame:
    """Echo, the device's own distance and temperature, 15 mm too long, with what a ruler says."""
    true = np.repeat(random.uniform(0.4, 3.0, count // 10), 10)
    air = 15.0 + 5.0 * np.sin(np.arange(count) / 17.0)
    device = echocal.Model("linear")
    echo = device.time_of_flight(true + 15e-3 + random.normal(0.0, 1e-3, count), temperature=air)
    reading = device.distance(echo, temperature=air)
    return pd.DataFrame(
        {
            "echo_us": (1e6 * echo).round(),
            "distance_mm": (1e3 * reading).round(),
            "temperature_C": air.round(2),
            "true_mm": (1e3 * true).round(),
        }
    )


def test_what_a_device_computes_is_no_reference(random: np.random.Generator) -> None:
    table = raw(random)
    both = {one.name: one.proposal.request for one in inspect_log(table).columns}
    assert (both["distance_mm"], both["true_mm"]) == ("reading_mm", "distance_mm")
    alone = inspect_log(table.drop(columns="true_mm")).columns[1].proposal
    assert (alone.request, alone.guess) == ("reading_mm", True)
    assert "follows from 'echo_us'" in alone.reason
    ruler = table.drop(columns="distance_mm").rename(columns={"true_mm": "distance_mm"})
    assert inspect_log(ruler).columns[2].proposal.request == "distance_mm"


def test_a_log_of_several_sensors_is_not_taken_for_one(tmp_path: Path, random: np.random.Generator) -> None:
    parts = [raw(random).drop(columns="distance_mm").assign(sensor=name) for name in "AB"]
    pd.concat(parts).rename(columns={"true_mm": "distance_mm"}).to_csv(tmp_path / "two.csv", index=False)
    told = str(CliRunner().invoke(app, [str(tmp_path / "two.csv"), "--yes"]).exception)
    assert "whether the 2 values of 'sensor' are as many sensors" in told
    assert "--by sensor" in told
    words = [str(tmp_path / "two.csv"), "--column", "sensor=extra", "-o", str(tmp_path / "out")]
    assert CliRunner().invoke(app, words).exit_code == 0


@pytest.mark.parametrize("name", ["Sollabstand [cm]", "Referenzabstand (cm)"])
def test_compounds_are_their_words(name: str, random: np.random.Generator) -> None:
    table = raw(random)[["distance_mm", "temperature_C"]].rename(columns={"distance_mm": "Messwert [mm]"})
    table[name] = raw(random)["true_mm"] / 10
    proposed = {one.name: one.proposal.request for one in inspect_log(table).columns}
    assert proposed[name] == "distance_cm"
    assert proposed["Messwert [mm]"] == "reading_mm"


def test_a_gauge_beside_a_level_is_no_reading(tmp_path: Path, random: np.random.Generator) -> None:
    level = 0.8 + 0.5 * np.sin(np.arange(200) / 30) + random.normal(0.0, 0.01, 200)
    table = {"Water level [m]": level.round(3), "Staff gauge [m]": level.round(2), "Air temp [°C]": 15.0}
    pd.DataFrame(table).to_csv(tmp_path / "pegel.csv", index=False)
    told = str(CliRunner().invoke(app, [str(tmp_path / "pegel.csv"), "--yes"]).exception)
    assert '--column "Water level [m]=level_m" --mount-height METERS' in told


def test_an_error_that_no_row_can_show_is_not_denied() -> None:
    celsius, scatter = np.linspace(5.0, 35.0, 60), 1e-3 * np.sin(np.arange(60.0) ** 2)
    table = {"reading_m": 1.215 + scatter, "temperature_C": celsius}
    said = brief(echocal.diagnose(table, constant_distance=True))
    assert "an error that is the same in all rows cannot show" in said.wrong
    assert said.next.startswith("measure a distance with a ruler")
    known = brief(echocal.diagnose({**table, "reading_m": 1.2 + scatter}, reference_distance=1.2))
    assert known.wrong == "these rows show no systematic error of the base (linear)."
    assert known.next == "nothing to correct."
