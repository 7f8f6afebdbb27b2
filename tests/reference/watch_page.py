"""Write the tables of docs/watch.md: the settings, and what benches/watch.json and watch_noises.json have.

python tests/reference/watch_page.py --write
"""

import importlib.util
import json
import re
import sys
from pathlib import Path

from echocal.watch import WatchSettings

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "watch.md"


def settings() -> str:
    """The numbers that decide, as a table."""
    lines = ["| name | value | unit | meaning and source |", "|---|---|---|---|"]
    for name, value, unit, source in WatchSettings.listed():
        shown = ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:g}"
        lines.append(f"| `{name}` | {shown} | {unit} | {source} |")
    return "\n".join(lines) + "\n"


def measured(name: str) -> str:
    """The table of a bench."""
    path = ROOT / "benches" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"bench_of_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    bench = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = bench
    spec.loader.exec_module(bench)
    return str(bench.table(json.loads(path.with_suffix(".json").read_text())))


def page(text: str) -> str:
    """The page with fresh tables."""
    tables = {"settings": settings(), "delays": measured("watch"), "quiet": measured("watch_noises")}
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
