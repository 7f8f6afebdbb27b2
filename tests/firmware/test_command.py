"""``echocal firmware``: files, report, exit codes, one clear line for a mistake."""

import json
import re
import shlex
import sys
from pathlib import Path
from typing import Any

import pytest
from toolchain import build, hash_of_all

from echocal import Model, firmware, silicon
from echocal.cli import main
from echocal.firmware import Firmware

FAST = ("--temperature-lsb", "0.5", "--echo-max-us", "30000")


@pytest.fixture
def model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "model.json"
    Model("cramer", {"fixed_delay": {"delay": 31e-6}}, air={"relative_humidity": 0.3}).save(path)
    return path


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["echocal", "firmware", *words])
    with pytest.raises(SystemExit) as stopped:
        main()
    return int(stopped.value.code or 0)


def test_files_report_and_summary(
    model: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, str(model), *FAST, "--json", "-", "-o", "made") == 0
    out, summary = capsys.readouterr()
    report = json.loads(out)
    assert report == json.loads(Path("made/report.json").read_text())
    assert report["schema"] == "echocal.firmware/1"
    assert report["model_hash"] == Model.load(model).hash
    assert report["flash_bytes"] is None, "not measured, so not stated"
    assert "mm at most, up to 4 m (requested 0.5 mm)" in summary
    assert "relative_humidity 0.3" in summary
    names = [
        "SHA256SUMS",
        "echocal_correction.c",
        "echocal_correction.h",
        "echocal_golden.csv",
        "report.json",
        "selftest",
    ]
    assert sorted(path.name for path in Path("made").iterdir()) == names


def test_the_recorded_command_runs_as_printed(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    third = "0.020833333333333332"  # more than 12 digits
    words = ("--temperature-lsb", third, "--temperature-range", "0:1.3333333333333333", "--echo-max-us=9000")
    assert run(monkeypatch, str(model), *words, "--max-error-mm", "0.3", "--quiet", "-o", "first") == 0
    command = shlex.split(json.loads(Path("first/report.json").read_text())["provenance"]["command"])
    assert third in command
    assert "0.3" in command
    assert run(monkeypatch, *command[2:]) == 0
    for path in Path("first").rglob("*.*"):
        assert path.read_bytes() == Path("firmware", path.relative_to("first")).read_bytes()


@pytest.mark.slow
def test_the_recorded_command_makes_the_same_files(
    model: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ("--temperature-zero", "0.25", "--assume", "pressure=90000", "--prefer", "speed", "--quiet")
    options += ("--package", "arduino", "--echo-lsb-us", "0.5", "--output-unit", "mm")
    options += ("--humidity-lsb", "0.1", "--humidity-range=0:0.9", "--humidity-zero=-0.05")
    assert run(monkeypatch, str(model), *FAST, *options, "--max-error-mm", "2", "-o", "first") == 0
    assert capsys.readouterr() == ("", ""), "--quiet is quiet"
    report = json.loads(Path("first/report.json").read_text())
    command = shlex.split(report["provenance"]["command"])
    assert command[:3] == ["echocal", "firmware", "model.json"]
    assert run(monkeypatch, *command[2:], "-o", "second") == 0
    files = [path.relative_to("first") for path in Path("first").rglob("*.*")]
    assert Path("library.properties") in files
    for path in files:
        assert ("first" / path).read_bytes() == ("second" / path).read_bytes()


def test_a_bound_out_of_reach_exits_with_4_and_one_line(
    model: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, str(model), *FAST, "--max-error-mm", "0.0001", "-o", "made") == 4
    lines = [line for line in capsys.readouterr().err.splitlines() if line.strip()]
    assert len(lines) == 1, lines
    assert "the best reachable is 0.00" in lines[0]
    assert not Path("made").exists()


@pytest.mark.slow
def test_the_best_reachable_is_measured_where_that_is_wanted(
    model: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (
        str(model),
        *FAST,
        "--target",
        "avr",
        "--form",
        "polynomial",
        "--max-error-mm",
        "0.0001",
        "-o",
        "made",
    )
    told = []
    for more in ((), ("--measure",)):
        assert run(monkeypatch, *words, *more) == 4
        told.append(" ".join(capsys.readouterr().err.split()))
    assert re.search(r"takes about \d+ bytes of flash and \d+ cycles, by the cost model", told[0])
    enough = re.search(r"ask for ([0-9.]+) mm", told[1])
    assert enough is not None
    request: dict[str, Any] = {"temperature": (0.5, -20.0, 60.0), "echo": 30_000, "form": "polynomial"}
    made = firmware.generate(Model.load(model), "avr", max_error=float(enough[1]) * 1e-3, **request)
    found = silicon.measure(made, "avr")
    assert found is not None
    assert f"takes {found.flash_bytes} bytes of flash and {found.cycles} cycles, measured on avr" in told[1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--temperature-range=-20",), "give LOW:HIGH"),
        (("--humidity-range=0:1",), "--humidity-range needs --humidity-lsb"),
        (("--temperature-range=60:-20",), "low <= high"),
        (("--assume", "relative_humidity"), "give NAME=VALUE"),
        (("--sensor", "SHT31"), "--temperature-zero -45 and --temperature-shift 4 of the sensor would stay"),
        (
            ("--sensor", "SHT31", "--temperature-zero=0", "--temperature-shift=0", "--humidity-lsb", "0.01"),
            "--humidity-shift 8 of the sensor would stay: give --humidity-shift, too",
        ),
        (("--target", "pdp11"), "unknown target 'pdp11'"),
        (("--accept", "no_such_effect"), "unknown effect 'no_such_effect'"),
        (
            ("--json", "absent/folder/report.json"),
            "absent/folder/report.json cannot be written: there is no folder",
        ),
        (("-o", "model.json"), "model.json is a file; name a folder"),
    ],
)
def test_a_mistake_exits_with_2_and_one_line(
    words: tuple[str, ...],
    message: str,
    model: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(monkeypatch, str(model), *FAST, "--quiet", "-o", "made", *words) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.strip()]
    assert len(lines) == 1, lines
    assert message in lines[0]


def test_a_file_name_cannot_end_the_comment(tmp_path: Path) -> None:
    made: Firmware = firmware.generate(
        Model("linear"), temperature=(1.0, 0.0, 40.0), model_name="a*/ int x; /*??/ \n.json"
    )
    assert hash_of_all(build(made, tmp_path)) == made.report["output_hash"]


def test_a_report_warns_of_the_domain_once_at_most(
    model: Path, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    words = ("--temperature-lsb", "1", "--echo-max-us", "5000", "--assume", "relative_humidity=1", "--quiet")
    assert run(monkeypatch, str(model), *words, "--report", "page.html", "-o", "made") == 0
    assert not recwarn.list


def test_the_note_of_a_sensor_is_told(
    model: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Saturated air would be refused on the device."""
    words = (
        "--sensor",
        "sht40",
        "--temperature-range=15:25",
        "--humidity-shift",
        "11",
        "--max-error-mm",
        "5",
    )
    assert run(monkeypatch, str(model), *words, "-o", "made") == 0
    told = " ".join(capsys.readouterr().err.split())
    assert "codes of sht40: above 100 % the codes go on: pass at most the last accepted humidity code" in told
