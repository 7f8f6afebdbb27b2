"""The tables of docs/firmware.md are what their generator makes of the figures, which still hold."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest

from echocal import silicon

STALE = "run `python benches/firmware.py` and read what changed in docs/firmware.md"
BENCHES = Path(__file__).parents[2] / "benches"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, BENCHES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHES)
    return load("firmware")


def test_the_page_is_fresh() -> None:
    page = load("firmware_page")
    text = page.PAGE.read_text()
    assert text == page.fresh(text, json.loads(page.RESULTS.read_text()))


@pytest.mark.slow
def test_rows_measured_again_are_as_stated(bench: ModuleType) -> None:
    """The quickest of theirs and of ours, on a core each; a change of the generator shows here."""
    stated = json.loads((BENCHES / "firmware.json").read_text())
    for row in stated["ours"][:1] + stated["ours"][4:5]:
        (case,) = [case for case in bench.OURS if asked(row) == (*case[:4], f"{case[4] * 1e3:g} mm")]
        again = bench.ours(*case, air="dry")
        assert {key: again[key] for key in row} == row, STALE
    beside = bench.firmware.generate(bench.Model("cramer"), assume=bench.DRY, temperature=bench.DS18B20)
    float_row = next(row for row in stated["theirs"] if row["core"] == "cortex-m4f")
    found = bench.theirs(bench.FORMULAS[1], beside, "cortex-m4f")
    assert found == float_row, STALE


def asked(row: dict[str, str]) -> tuple[str, ...]:
    """Core, target, what is saved, options and bound, as the label tells."""
    target, prefer, options, bound = row["label"].split(", ")
    return (row["core"], target.strip("`"), prefer, options, bound)


def test_every_core_has_a_row_of_each() -> None:
    stated = json.loads((BENCHES / "firmware.json").read_text())
    for rows in (stated["theirs"], stated["ours"]):
        assert {row["core"] for row in rows} == set(silicon.CORES)
