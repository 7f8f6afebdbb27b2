"""docs/diagnose-speed.md is what its generator makes of the measured results."""

import importlib
import importlib.util
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def test_the_page_is_fresh() -> None:
    where = ROOT / "benches" / "diagnose_speed_page.py"
    spec = importlib.util.spec_from_file_location("diagnose_speed_page", where)
    assert spec is not None
    assert spec.loader is not None
    render = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(render)
    results = json.loads((ROOT / "benches" / "diagnose_speed.json").read_text())
    assert (ROOT / "docs" / "diagnose-speed.md").read_text() == render.page(results)


def test_every_stage_is_where_the_clock_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benches"))
    clock = importlib.import_module("diagnose_speed")
    for owner, name, stage in clock.STAGES:
        assert hasattr(owner, name), stage
