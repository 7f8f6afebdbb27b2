"""The code names every equation of the pages of the method, with its page, and none that is not there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CORE = "docs/method.md"
PAGES = [ROOT / CORE, *sorted((ROOT / "docs" / "method").glob("*.md"))]
TAG = re.compile(r"\\tag\{(\d+[a-d]?)\}")
LIST = r"\d+[a-d]?(?:(?:, | and | to )\d+[a-d]?)*"
CITED = re.compile(rf"\bEq\. ({LIST})")
WITH_PAGE = re.compile(rf"((?:docs/)?method(?:/[a-z-]+)?\.md)\b[^`\"\n]{{0,30}}?\bEq\. ({LIST})")


def numbered(text: str) -> set[str]:
    """Numbers of a list, as in "5 and 9" and "11 to 14"."""
    found: set[str] = set()
    for first, last in re.findall(r"(\d+[a-d]?)(?: to (\d+[a-d]?))?", text):
        found.add(first)
        if last:
            low, high = (int(number.rstrip("abcd")) for number in (first, last))
            found |= {str(number) for number in range(low + 1, high + 1)}
    return found


def unwrapped(text: str) -> str:
    """A text whose comments have no line ends."""
    return re.sub(r"\s*\n\s*(?://[/!] ?)?", " ", text)


def cited(text: str) -> set[str]:
    """Numbers of the equations that a text names, as in "Eq. 3", "Eq. 5 and 9" and "Eq. 11 to 14"."""
    return set().union(*(numbered(each) for each in CITED.findall(unwrapped(text))))


def cited_with_page(text: str) -> set[tuple[str, str]]:
    """Pages and numbers of the equations that a text names with their page."""
    found = WITH_PAGE.findall(unwrapped(text))
    return {(f"docs/{page.removeprefix('docs/')}", number) for page, of in found for number in numbered(of)}


def page_of() -> dict[str, str]:
    """Page of each equation."""
    found: dict[str, str] = {}
    for path in PAGES:
        for number in TAG.findall(path.read_text(encoding="utf-8")):
            assert number not in found, f"Eq. {number} is on two pages"
            found[number] = path.relative_to(ROOT).as_posix()
    return found


def computing() -> list[Path]:
    """Files that compute."""
    rust = (ROOT / "rust" / "infer" / "src").rglob("*.rs")
    package = ROOT / "python" / "echocal"
    python = [file for room in ("diagnose", "fleet", "watch") for file in (package / room).rglob("*.py")]
    return sorted([*rust, *python])


def named() -> dict[str, list[Path]]:
    """Files that compute, by the equations that they name."""
    found: dict[str, list[Path]] = {}
    for path in computing():
        for number in cited(path.read_text(encoding="utf-8")):
            found.setdefault(number, []).append(path.relative_to(ROOT))
    return found


def test_numbers_are_read_as_they_are_written() -> None:
    assert cited("docs/method.md, Eq. 3") == {"3"}
    assert cited("Eq. 5 and 9, and see Eq. 2a.") == {"5", "9", "2a"}
    assert cited("/// docs/method.md, Eq. 11 to 14") == {"11", "12", "13", "14"}
    assert cited("//! method.md, Eq. 18\n//! and 20 to 22") == {"18", "20", "21", "22"}
    assert cited("Eq. 16, of 3 rows") == {"16"}
    assert cited_with_page("docs/method.md, Eq. 3, and\n/// docs/method/noises.md, Eq. 4.") == {
        ("docs/method.md", "3"),
        ("docs/method/noises.md", "4"),
    }


def test_every_equation_is_named_where_it_is_computed() -> None:
    pages, found = page_of(), named()
    assert len(pages) >= 69
    missing = [number for number in pages if number not in found]
    assert not missing, f"no code names the equations {', '.join(missing)}"
    wrong = {number: paths for number, paths in found.items() if number not in pages}
    assert not wrong, f"no page has the equations {wrong}"


def test_a_reference_names_the_page_of_its_equation() -> None:
    """An equation without a page is one of the core page, or the file names its page elsewhere."""
    pages = page_of()
    tests = [path for path in (ROOT / "tests").rglob("*.py") if path != Path(__file__)]
    for path in [*computing(), *tests]:
        text = path.read_text(encoding="utf-8")
        for page, number in cited_with_page(text):
            assert pages[number] == page, f"{path}: Eq. {number} is on {pages[number]}"
        if path in tests:
            continue
        for number in cited(text):
            assert pages[number] == CORE or pages[number] in unwrapped(text), f"{path}: page of Eq. {number}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_table_of_a_page_has_each_equation_and_its_files(page: Path) -> None:
    text, found = page.read_text(encoding="utf-8"), named()
    listed: set[str] = set()
    rooms = ("python/echocal/diagnose", "python/echocal", "rust/infer/src")
    for row in re.findall(rf"^\| ({LIST}) \| ([^\n]*\.(?:py|rs)`[^\n]*)\|$", text, re.MULTILINE):
        numbers, files = numbered(row[0]), re.findall(r"`([\w/]+\.(?:py|rs))`", row[1])
        if any(file.startswith("tests/") for file in files):
            continue
        listed |= numbers
        computed = {path for number in numbers for path in found[number]}
        for file in files:
            assert any(Path(room) / file in computed for room in rooms), f"{page.name}: {file}, {row[0]}"
    assert listed == set(TAG.findall(text))


def test_the_core_page_can_be_read_in_half_an_hour() -> None:
    """Each other page is named there, with its equations."""
    text = (ROOT / CORE).read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 400
    assert len(TAG.findall(text)) <= 32
    for path in PAGES[1:]:
        (row,) = re.findall(rf"^\| \[[^\]]+\]\(method/{path.name}\) \|.*\| ([^|]+) \|$", text, re.MULTILINE)
        assert numbered(row) == set(TAG.findall(path.read_text(encoding="utf-8"))), path.name


def test_figures_of_the_benchmark_are_those_of_its_page() -> None:
    text = (ROOT / CORE).read_text(encoding="utf-8")
    bench = (ROOT / "docs" / "diagnosis-benchmark.md").read_text(encoding="utf-8")
    names = {
        "false alarms (0.02)": "false alarms",
        r"power at snr $\sqrt n$ = 5 (0.9)": "power at snr sqrt(N) = 5",
        "right class, if claimed (0.92)": "alias class right, if claimed",
        "coverage of the 95 % set (0.94 to 0.99)": "95 % set: coverage",
        "error of the probabilities, known priors (0.03)": "ECE, known priors",
    }
    for told, name in names.items():
        (there,) = re.findall(rf"^\| {re.escape(name)} \|(.*)\|$", bench, re.MULTILINE)
        values = [cell.split()[0] for cell in there.split("|")[::3]]
        assert f"| {told} | {' | '.join(values)} |" in text, told
