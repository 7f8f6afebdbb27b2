"""The rooms of the firmware generator, as its ``lib.rs`` lists them: imports go to lower rooms only."""

import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "firmware_gen" / "src"
LIST = (SOURCE / "lib.rs").read_text()
FLOORS = {
    room: int(floor)
    for floor, line in re.findall(r"^//! (\d+)\. (.*)$", LIST, re.M)
    for room in re.findall(r"`(\w+)`", line)
}
FILES = sorted(path for path in SOURCE.rglob("*.rs") if path.name not in {"lib.rs", "tests.rs"})


def text(path: Path) -> str:
    """Return the code of a file, without comments, tests and re-exports."""
    code = path.read_text().partition("#[cfg(test)]\nmod tests {")[0]
    code = re.sub(r"//[^\n]*", "", code)
    return re.sub(r"pub(?:\([a-z: ]+\))? use [^;]*;", "", code)


def module(path: Path) -> tuple[str, ...]:
    """Return the path of a file's module inside the crate."""
    names = path.relative_to(SOURCE).with_suffix("").parts
    return names[:-1] if names[-1] == "mod" else names


MODULES = {module(path): path for path in FILES}


def imports(path: Path) -> set[Path]:
    """Return the files that a file names: by ``crate::``, ``super::``, or as submodules in ``use``."""
    here, code = module(path), text(path)
    found: set[tuple[str, ...]] = set()
    for root, names in re.findall(r"\b(crate|super|self)::((?:\w+::)*\w+|\{)", code):
        base = {"crate": (), "super": here[:-1], "self": here}[root]
        found.add((*base, *names.split("::")) if names != "{" else base)
    for child in re.findall(r"^use (\w+)::", code, re.M):
        found.add((*here, child))
    return {MODULES[longest] for name in found if (longest := _longest(name)) is not None} - {path}


def _longest(name: tuple[str, ...]) -> tuple[str, ...] | None:
    parts = (name[:length] for length in range(len(name), 0, -1))
    return next((part for part in parts if part in MODULES), None)


def test_every_room_has_a_floor() -> None:
    assert {module(path)[0] for path in FILES} == set(FLOORS)
    assert len(set(FLOORS.values())) == 8


@pytest.mark.parametrize("path", FILES, ids=lambda path: "/".join(module(path)))
def test_imports_go_down(path: Path) -> None:
    room = module(path)[0]
    above = {
        other.relative_to(SOURCE)
        for other in imports(path)
        if module(other)[0] != room and FLOORS[module(other)[0]] >= FLOORS[room]
    }
    assert not above, f"{room} is on floor {FLOORS[room]}"


def test_no_two_files_import_each_other() -> None:
    graph = {path: imports(path) for path in FILES}
    assert sum(map(len, graph.values())) > 100, "the imports were found"
    pairs = [(a, b) for a in graph for b in graph[a] if a < b and a in graph[b]]
    assert not [tuple(path.relative_to(SOURCE) for path in pair) for pair in pairs]
