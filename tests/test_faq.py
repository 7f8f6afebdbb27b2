"""The figures of the FAQ are those of the pages that measure them."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
FAQ = " ".join((DOCS / "faq.md").read_text().split())


def cells(page: str, line: str, number: int = 1) -> list[str]:
    """Cells of the line of a table that begins with these words: the one of this number."""
    lines = [row for row in (DOCS / page).read_text().splitlines() if row.startswith(f"| {line} |")]
    return [cell.strip() for cell in lines[number - 1].strip("|").split("|")]


def test_power_and_claims() -> None:
    power = cells("diagnosis-benchmark.md", "power at snr sqrt(N) = 5")
    a, b = (f"{100 * float(power[place].split()[0]):.0f} %" for place in (1, 4))
    assert f"found in {a} of tables with 26 rows at one distance, and in {b} of tables with 400" in FAQ
    right = cells("diagnosis-benchmark.md", "alias class right, if claimed")
    parts = [100 * float(right[place].split()[0]) for place in (1, 4, 7)]
    assert f"right in {min(parts):.0f} to {max(parts):.0f} % of the claims" in FAQ


def test_names_in_real_records() -> None:
    worse, named, able = (cells("honesty.md", "**all**", number) for number in (1, 2, 3))
    again, asked = (float(text) for text in re.findall(r"^([\d.]+).*; (\d+)\)$", named[3])[0])
    assert f"{again * asked:.0f} of {asked:.0f} were given again by another window" in FAQ
    again, asked = (float(text) for text in re.findall(r"^([\d.]+).*; (\d+)\)$", able[1])[0])
    assert f"{asked - again * asked:.0f} of {asked:.0f} that could did not name it" in FAQ
    assert f"{100 * float(worse[4].split()[0]):.0f} % of the other windows" in FAQ


def test_drawn_tables_and_times() -> None:
    page = (DOCS / "honesty.md").read_text()
    named = re.search(r"Named without an effect: (.*)\.\n", page)
    assert named is not None
    count = sum(int(text) for text in re.findall(r"` (\d+)", named[1]))
    tables = re.search(r"\| all \|.*?; (\d+)\)", page)
    assert tables is not None
    assert f"On {int(tables[1]):,} drawn tables without an effect, {count} got the name of a cause" in FAQ
    thousand, million = (
        float(cells("diagnose-speed.md", rows)[2].replace(",", "")) for rows in ("1,000", "1,000,000")
    )
    seconds = re.search(r"([\d.]+) s for a million rows, ([\d.]+) s for a thousand", FAQ)
    assert seconds is not None
    assert abs(float(seconds[1]) - million / 1000) <= 0.2
    assert abs(float(seconds[2]) - thousand / 1000) <= 0.05
