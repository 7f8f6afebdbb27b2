"""The code names every equation of docs/method.md, and none that is not there."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "method.md"
TAG = re.compile(r"\\tag\{(\d+[ab]?)\}")
CITED = re.compile(r"\bEq\. (\d+[ab]?(?:(?:, | and | to )\d+[ab]?)*)")


def cited(text: str) -> set[str]:
    """Numbers of the equations that a text names, as in "Eq. 3", "Eq. 5 and 9" and "Eq. 11 to 14"."""
    found: set[str] = set()
    unwrapped = re.sub(r"\s*\n\s*(?://[/!] ?)?", " ", text)
    for numbers in CITED.findall(unwrapped):
        for first, last in re.findall(r"(\d+[ab]?)(?: to (\d+[ab]?))?", numbers):
            found.add(first)
            if last:
                found |= {
                    str(number) for number in range(int(first.rstrip("ab")) + 1, int(last.rstrip("ab")) + 1)
                }
    return found


def named() -> dict[str, list[Path]]:
    """Files that compute, by the equations that they name."""
    found: dict[str, list[Path]] = {}
    rust = (ROOT / "rust" / "infer" / "src").rglob("*.rs")
    package = ROOT / "python" / "echocal"
    python = [file for room in ("diagnose", "fleet", "watch") for file in (package / room).rglob("*.py")]
    for path in sorted([*rust, *python]):
        for number in cited(path.read_text()):
            found.setdefault(number, []).append(path.relative_to(ROOT))
    return found


def test_numbers_are_read_as_they_are_written() -> None:
    assert cited("docs/method.md, Eq. 3") == {"3"}
    assert cited("Eq. 5 and 9, and see Eq. 2a.") == {"5", "9", "2a"}
    assert cited("/// docs/method.md, Eq. 11 to 14") == {"11", "12", "13", "14"}
    assert cited("//! method.md, Eq. 18\n//! and 20 to 22") == {"18", "20", "21", "22"}
    assert cited("Eq. 16, of 3 rows") == {"16"}


def test_every_equation_is_named_where_it_is_computed() -> None:
    equations, found = TAG.findall(PAGE.read_text()), named()
    assert len(equations) == len(set(equations)) >= 32
    missing = [number for number in equations if number not in found]
    assert not missing, f"no code names the equations {', '.join(missing)} of docs/method.md"
    wrong = {number: paths for number, paths in found.items() if number not in equations}
    assert not wrong, f"docs/method.md has no such equations: {wrong}"
