"""Generate the table of instruments and that of the coverage in docs/budget.md.

python tests/reference/budget_page.py            prints the tables
python tests/reference/budget_page.py --write    writes them into the page, between their markers
"""

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from echocal.budget.instruments import INSTRUMENTS, Limits
from echocal.quantities import QUANTITIES

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "budget.md"
COVERAGE = ROOT / "benches" / "honesty" / "coverage.json"


def instruments() -> Iterator[str]:
    """Lines of the table of instruments."""
    yield "| statement | limits of error | resolution | source |"
    yield "|---|---|---|---|"
    for kind, own in INSTRUMENTS.items():
        yield from (f"| `{kind}={limits.name}` | {_cells(limits)} |" for limits in own.values())


def _cells(limits: Limits) -> str:
    shown = QUANTITIES[limits.quantity].shown
    unit = {"degC": "K"}.get(QUANTITIES[limits.quantity].unit, shown.unit)
    several = len(limits.ranges) > 1 or limits.quantity == "temperature"
    scale = "°C" if limits.quantity == "temperature" else unit
    factor = 1.0 if limits.quantity == "temperature" else shown.factor
    ranges = "; ".join(
        f"±{half * shown.factor:g} {unit}"
        + (f" from {low * factor:g} to {high * factor:g} {scale}" if several else "")
        for low, high, half in limits.ranges
    )
    step = f"{limits.resolution * shown.factor:g} {unit}" if limits.resolution else "not stated"
    return f"{ranges} | {step} | {limits.source}"


def coverage() -> Iterator[str]:
    """Lines of the table of the coverage."""
    yield "| design | tables | within U | the lowest 5 % of the tables |"
    yield "|---|---:|---:|---:|"
    for name, own in json.loads(COVERAGE.read_text(encoding="utf-8"))["designs"].items():
        mean, error = own["within_U"]
        yield f"| {name} | {own['count']} | {mean:.3f} +/- {error:.3f} | {own['lowest']:.2f} |"


def replaced(page: str) -> str:
    """Return the page with both tables renewed."""
    for name, lines in (("instruments", instruments()), ("coverage", coverage())):
        block = f"<!-- {name} -->\n" + "\n".join(lines) + f"\n<!-- /{name} -->"
        page, count = re.subn(
            rf"<!-- {name} -->\n.*?<!-- /{name} -->", lambda _, b=block: b, page, flags=re.DOTALL
        )
        assert count == 1, name
    return page


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    else:
        print("\n".join([*instruments(), "", *coverage()]))
