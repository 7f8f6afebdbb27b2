"""``measure=True``: figures that were counted, with the versions of what counted them; nothing otherwise."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from echocal import EchocalError, Model, UsageError, firmware, silicon
from echocal.cli import main

MODEL = Model("cramer")
CODES: dict[str, Any] = {"temperature": (1.0, -20.0, 60.0), "echo": 10_000}


@pytest.mark.slow
@pytest.mark.parametrize("core", silicon.CORES)
def test_report_and_header_state_what_was_measured(core: str) -> None:
    target = {"cortex-m4f": "c99", "rv32e": "c99"}.get(core, core)
    made = firmware.generate(MODEL, target, measure=True, **CODES)
    (found,) = (found for found in made.report["measured"] if found["core"] == core)
    alone = silicon.measure(made, core)
    assert alone is not None
    assert found == alone.to_dict()
    unit = "cycles" if core == "avr" else "instructions"
    for line in (
        f"{core}, {alone.compiler} -Os, {alone.simulator}: {alone.flash_bytes} bytes of flash",
        unit,
    ):
        assert line in made.files["echocal_correction.h"]
    assert 10 < alone.own_flash_bytes <= alone.flash_bytes < 400
    assert alone.ram_bytes == 0
    assert all(part[0].isdigit() for part in (alone.compiler.split()[-1], alone.simulator.split()[-1]))
    if target == core:
        assert [made.report[key] for key in ("flash_bytes", "ram_bytes", "stack_bytes", unit)] == [
            *(found[key] for key in ("flash_bytes", "ram_bytes", "stack_bytes")),
            found[unit],
        ]
    else:
        assert made.report["flash_bytes"] is None, "c99 is no core"


def test_the_code_is_the_same_measured_or_not() -> None:
    plain, measured = (firmware.generate(MODEL, "avr", measure=measure, **CODES) for measure in (False, True))
    assert plain.files["echocal_correction.c"] == measured.files["echocal_correction.c"]
    assert plain.report["measured"] == []
    assert [plain.report[key] for key in ("flash_bytes", "cycles", "instructions", "stack_bytes")] == [
        None
    ] * 4
    assert " --measure " in measured.report["provenance"]["command"]


@pytest.mark.slow
def test_more_work_costs_more() -> None:
    """A table of every code is quick and large on any core, Horner's rule is neither."""
    quick = firmware.generate(MODEL, "c99", form="full_table", **CODES)
    small = firmware.generate(MODEL, "c99", form="polynomial", max_error=1e-5, **CODES)
    for core in silicon.CORES:
        fast, slow = silicon.measure(quick, core), silicon.measure(small, core)
        assert fast is not None
        assert slow is not None
        assert fast.steps < slow.steps
        assert fast.own_flash_bytes > 162 + 10


def test_where_a_tool_is_missing_nothing_is_stated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    MODEL.save(tmp_path / "model.json")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    words = ("--target", "avr", "--temperature-lsb", "1", "--echo-max-us", "9000", "--measure", "-o", "made")
    monkeypatch.setattr(sys, "argv", ["echocal", "firmware", "model.json", *words])
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit) as stopped:
        main()
    assert not stopped.value.code
    assert "not measured on avr: no avr-gcc, gcc" in capsys.readouterr().err
    report = json.loads((tmp_path / "made" / "report.json").read_text())
    assert (report["measured"], report["flash_bytes"], report["cycles"]) == ([], None, None)


def test_a_tool_that_fails_is_told_in_one_line(tmp_path: Path) -> None:
    made = firmware.generate(MODEL, "avr", **CODES)
    made.files["echocal_correction.c"] += "\n#error spoiled\n"
    with pytest.raises(EchocalError, match=r"avr-gcc .* #error spoiled"):
        silicon.measure(made, "avr")


@pytest.mark.parametrize(
    ("request_", "message"),
    [({"package": "micropython"}, "contains none"), ({"target": "z80"}, "unknown target 'z80'")],
)
def test_what_cannot_be_measured_is_refused(request_: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        firmware.generate(MODEL, measure=True, **request_, **CODES)
    with pytest.raises(UsageError, match="unknown core 'z80'; this version has avr, cortex-m0"):
        silicon.missing("z80")
