"""docs/speed.md is what its generator makes of the measured results."""

import importlib.util
import json
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_the_page_is_fresh() -> None:
    spec = importlib.util.spec_from_file_location("render", ROOT / "benches" / "render.py")
    assert spec is not None
    assert spec.loader is not None
    render = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(render)
    results = json.loads((ROOT / "benches" / "results.json").read_text())
    assert (ROOT / "docs" / "speed.md").read_text() == render.page(results)
