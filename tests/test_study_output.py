"""The command, its JSON, its figures and its page."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from echocal import UsageError
from echocal.cli import app
from echocal.study import run
from echocal.study.diagnosed import ask
from echocal.study.diagnosed import render as render_diagnosed
from echocal.study.figures import FIGURES
from echocal.study.report import render

DIAGNOSED = Path(__file__).parents[1] / "docs" / "study-diagnosis.md"
PAGE = Path(__file__).parents[1] / "docs" / "study.md"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp("study")
    result = CliRunner().invoke(app, ["study", "--out", str(folder), "--json", str(folder / "study.json")])
    assert result.exit_code == 0, result.output
    return folder, result.output


def test_page_is_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == render(run()), "run: echocal study --out docs --quiet"


def test_page_of_the_diagnosis_is_fresh_and_its_sentences_stand() -> None:
    answers = ask()
    assert [answer.question.title for answer in answers if not answer.holds] == []
    fresh = render_diagnosed(answers)
    assert DIAGNOSED.read_text(encoding="utf-8") == fresh, "run: echocal study --out docs --quiet"


def test_a_sentence_that_no_longer_stands_is_taken_back() -> None:
    (answer, *_) = ask()
    stale = replace(answer, question=replace(answer.question, finds=("drift",)))
    assert answer.question.means in render_diagnosed([answer])
    assert answer.question.means not in render_diagnosed([stale])


@pytest.mark.slow
def test_terminal_report(written: tuple[Path, str]) -> None:
    text = written[1]
    for part in ("30 reproduced", "Table 1 as printed", "10-bit converter", "latency", "331.300 ✗"):
        assert part in text


def test_json(written: tuple[Path, str]) -> None:
    found = json.loads((written[0] / "study.json").read_text(encoding="utf-8"))
    assert found["schema"] == "echocal.study/1"
    assert found["verdicts"] == {"reproduced": 30, "not reproduced": 13, "physically wrong": 10}
    claim = found["claims"][0]
    assert (claim["id"], claim["verdict"], len(claim["cells"])) == ("table1-speed", "not reproduced", 26)
    assert claim["cells"][5]["printed"] == "337.420"
    assert {alternative["cause"] for alternative in found["alternatives"]} >= {"fixed_delay.delay"}


def test_figures(written: tuple[Path, str]) -> None:
    for name in FIGURES:
        data = (written[0] / name).read_bytes()
        width, height = struct.unpack(">II", data[16:24])
        assert data[:8] == b"\x89PNG\r\n\x1a\n"
        assert (width, height) > (1000, 600)
        assert (PAGE.parent / name).exists()


@pytest.mark.slow
def test_quiet_and_stdout() -> None:
    quiet = CliRunner().invoke(app, ["study", "--quiet"])
    assert quiet.output.strip() == "30 reproduced, 13 not reproduced, 10 physically wrong"
    piped = CliRunner().invoke(app, ["study", "--quiet", "--json", "-"])
    assert json.loads(piped.stdout)["schema"] == "echocal.study/1"


def test_a_folder_that_cannot_be_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    result = CliRunner().invoke(app, ["study", "--quiet", "--out", str(tmp_path / "taken")])
    assert isinstance(result.exception, UsageError)
    assert "taken cannot be written" in str(result.exception)
