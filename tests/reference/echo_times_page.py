"""Write the tables of docs/echo-times.md from what benches/echo_times.json has.

python tests/reference/echo_times_page.py --write
"""

import importlib.util
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "echo-times.md"
RESULTS = ROOT / "benches" / "echo_times.json"


def page(text: str) -> str:
    """The page with fresh tables."""
    spec = importlib.util.spec_from_file_location("bench_of_echo_times", ROOT / "benches" / "echo_times.py")
    assert spec is not None
    assert spec.loader is not None
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    results = json.loads(RESULTS.read_text())
    tables = {
        "errors": bench.table(results),
        "right": bench.right(results),
        "world": bench.physics(results),
        "speed": bench.rates(results),
    }
    for name, table in tables.items():
        found = re.compile(rf"(<!-- {name} -->\n)\n?(?:\|.*\n)*\n?")
        assert found.search(text), name
        text = found.sub(lambda match, table=table: f"{match[1]}\n{table}\n", text)  # type: ignore[misc]
    return text


if __name__ == "__main__":
    fresh = page(PAGE.read_text())
    if "--write" in sys.argv:
        PAGE.write_text(fresh)
    else:
        print(fresh)
