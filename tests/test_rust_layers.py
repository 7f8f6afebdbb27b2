"""Arrows between the rooms of the Rust crates point one way, and no two files import each other.

The test reads the `use` paths of every file. A path through a room's `mod.rs` counts as one to the
file that the name is re-exported from; a re-export itself is no arrow. Tests are left out: they may
use what stands above.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "rust"
CRATE_ORDER = ["echocal_core", "echocal_infer", "echocal_text", "echocal_py"]
CRATES = {crate: ROOT / crate.removeprefix("echocal_") for crate in CRATE_ORDER}
INFERENCE = ["numeric", "parallel", "gram", "columns", "noise", "solve", "search"]

Name = tuple[str, ...]  # crate, then modules

USE = re.compile(r"^[ \t]*(?P<public>pub(?:\([^)]*\))? )?use (?P<tree>[^;]+);", re.MULTILINE)
TESTS = re.compile(r"^#\[cfg\(test\)\]\nmod tests \{.*", re.MULTILINE | re.DOTALL)
TEST_FILES = {"tests", "testing", "conformance"}  # modules that exist in tests alone


@dataclass
class Module:
    path: Path
    name: Name
    imports: set[Name] = field(default_factory=set)
    reexports: dict[str, Name] = field(default_factory=dict)


def flattened(tree: str) -> Iterator[Name]:
    """The paths of a `use` tree: `a::{b, c::d}` is `a::b` and `a::c::d`."""
    head, brace, rest = tree.strip().partition("{")
    if not brace:
        yield tuple(part.strip() for part in re.split(r"\bas\b", head)[0].strip().split("::"))
        return
    before = tuple(part for part in head.strip().removesuffix("::").split("::") if part)
    depth, start, inner = 0, 0, rest.rstrip().removesuffix("}")
    for at, letter in enumerate(inner + ","):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            if part := inner[start:at].strip():
                yield from (before + path for path in flattened(part))
            start = at + 1


def absolute(path: Name, here: Name) -> Name | None:
    """A path from the crate on; nothing where it leads out of the workspace."""
    match path:
        case ("crate", *rest):
            return (here[0], *rest)
        case ("self", *rest):
            return (*here, *rest)
        case ("super", *_):
            while path[:1] == ("super",):
                path, here = path[1:], here[:-1]
            return here + path
        case (crate, *_) if crate in CRATES:
            return path
    return None


def name_of(crate: str, path: Path) -> Name:
    parts = path.relative_to(CRATES[crate] / "src").with_suffix("").parts
    return (crate, *(part for part in parts if part not in {"mod", "lib"}))


def uses(text: str, name: Name) -> Iterator[tuple[bool, str, Name]]:
    """Each path used: whether it is re-exported, the name that it has here, and the absolute path."""
    text = TESTS.sub("", re.sub(r"//[^\n]*", "", text))
    for match in USE.finditer(text):
        for path in flattened(match["tree"]):
            target = absolute(path, name) or absolute(("self", *path), name)
            if target is not None:
                yield bool(match["public"]), path[-1], target


@cache
def modules() -> dict[Name, Module]:
    found = {}
    for crate, folder in CRATES.items():
        for path in sorted((folder / "src").rglob("*.rs")):
            name = name_of(crate, path)
            if name[-1] in TEST_FILES:
                continue
            found[name] = Module(path, name)
    for module in found.values():
        for public, item, target in uses(module.path.read_text(), module.name):
            below = target[: len(module.name)] == module.name
            if public and below and len(target) > len(module.name) + 1:
                module.reexports[item] = target
            else:
                module.imports.add(target)
    return found


def file_of(target: Name) -> Name | None:
    """The file that a path leads to, through re-exports."""
    known = modules()
    for length in range(len(target), 0, -1):
        if (module := known.get(target[:length])) is not None:
            item = target[length : length + 1]
            if item and item[0] in module.reexports:
                return file_of(module.reexports[item[0]])
            return module.name
    return None


@cache
def arrows() -> frozenset[tuple[Name, Name]]:
    found = set()
    for module in modules().values():
        for target in module.imports:
            there = file_of(target)
            if there not in {None, module.name}:
                found.add((module.name, there))
    return frozenset(found)


def shown(name: Name) -> str:
    return "::".join(name)


def room(name: Name) -> Name:
    return name[:2]


def test_the_paths_are_read() -> None:
    tree = "crate::gram::{Class, panels::{self, Panels}, tiles::GROUP as G}"
    assert list(flattened(tree)) == [
        ("crate", "gram", "Class"),
        ("crate", "gram", "panels", "self"),
        ("crate", "gram", "panels", "Panels"),
        ("crate", "gram", "tiles", "GROUP"),
    ]
    here = ("echocal_infer", "noise", "convection")
    assert absolute(("super", "correlation", "X"), here) == ("echocal_infer", "noise", "correlation", "X")
    assert (here, ("echocal_infer", "noise", "correlation")) in arrows()
    assert (here, ("echocal_infer", "gram", "panels")) in arrows(), "through the re-export of the room"
    assert len(arrows()) > 150


def test_no_two_files_import_each_other() -> None:
    both = sorted(f"{shown(a)} and {shown(b)}" for a, b in arrows() if a < b and (b, a) in arrows())
    assert not both, f"these import each other: {both}"


@pytest.mark.parametrize("crate", CRATES)
def test_rooms_of_a_crate_have_an_order(crate: str) -> None:
    graph: dict[Name, set[Name]] = {}
    for one, other in arrows():
        if one[0] == other[0] == crate and len(one) > 1 and len(other) > 1 and room(one) != room(other):
            graph.setdefault(room(one), set()).add(room(other))
    try:
        order = list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        pytest.fail(f"the rooms {' -> '.join(shown(name) for name in error.args[1])} stand on each other")
    assert order


def test_rooms_of_the_inference_stand_on_each_other() -> None:
    rooms = {name[1] for name in modules() if name[0] == "echocal_infer" and len(name) > 1}
    assert rooms == set(INFERENCE)
    for one, other in arrows():
        if one[0] == other[0] == "echocal_infer" and len(one) > 1:
            assert INFERENCE.index(other[1]) <= INFERENCE.index(one[1]), f"{shown(one)} uses {shown(other)}"


def test_crates_stand_on_each_other() -> None:
    for one, other in arrows():
        assert CRATE_ORDER.index(other[0]) <= CRATE_ORDER.index(one[0]), f"{shown(one)} uses {shown(other)}"


def test_the_core_knows_nothing_statistical() -> None:
    words = re.compile(r"\b(posterior|likelihood|evidence|covariance|prior probabilit\w+)\b", re.IGNORECASE)
    found = [
        f"{module.path.relative_to(ROOT)}: {match[0]}"
        for module in modules().values()
        if module.name[0] == "echocal_core"
        for match in words.finditer(module.path.read_text())
    ]
    assert not found, found
