"""Arrows point one way: a module imports only what stands below it."""

import ast
import re
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from statistics import median

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "echocal"

LAYERS = (
    {"_core", "_interrupt", "_verb", "arrays", "errors", "keywords", "shown"},
    {"codes", "reserved", "concise", "outputs", "checksums", "objects"},
    {"places", "sensors", "thermistor", "time_outs"},
    {"quantities"},
    {"conditions"},
    {"domain", "air", "registry"},
    {"model"},
    {"observations", "waveforms"},
    {"sweep", "calibrate", "engines"},
    {"budget"},
    {"virtual_bench", "correct"},
    {"diagnose", "silicon", "echoes", "verify", "generated", "device_uncertainty", "recorded", "further"},
    {"charts"},
    {"plots", "report", "firmware"},
    {"study", "explore", "per_unit", "lagging", "emulation", "fleet", "watch", "accessor", "estimator"},
    {"pages", "_accessors", "serve", "bench"},
    {"cli"},
)
ROOMS_OF_DIAGNOSE = [
    "findings",
    "settings",
    "preprocess",
    "candidates",
    "inference",
    "noises",
    "faults",
    "catalogue",
    "progress",
    "blas",
    "garbage",
    "selection",
    "validation",
    "experiment_design",
    "verdict",
    "matters",
    "results",
    "request",
    "pipeline",
    "engine",
    "pooling",
]
FLOOR = {room: floor for floor, rooms in enumerate(LAYERS) for room in rooms}


def room(path: Path) -> str:
    first = path.relative_to(PACKAGE).parts[0]
    return first.removesuffix(".py").removesuffix(".pyi")


def imported_rooms(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        match node:
            case ast.ImportFrom(module="echocal", names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(module=str(module)) if module.startswith("echocal."):
                yield module.split(".")[1]
            case ast.Import(names=names):
                parts = [alias.name.split(".") for alias in names]
                yield from (part[1] for part in parts if part[0] == "echocal" and len(part) > 1)


MODULES = [path for path in sorted(PACKAGE.rglob("*.py")) if room(path) not in {"__init__", "__main__"}]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_down(path: Path) -> None:
    here = room(path)
    assert here in FLOOR, f"{here} has no floor: give it one in LAYERS"
    for there in imported_rooms(path):
        assert there == here or FLOOR[there] < FLOOR[here], f"{here} must not import {there}"


@pytest.mark.parametrize(
    "path",
    [p for p in MODULES if room(p) == "diagnose" and p != PACKAGE / "diagnose" / "__init__.py"],
    ids=lambda path: str(path.relative_to(PACKAGE)),
)
def test_rooms_of_the_diagnosis_stand_on_each_other(path: Path) -> None:
    here = ROOMS_OF_DIAGNOSE.index(path.relative_to(PACKAGE / "diagnose").parts[0].removesuffix(".py"))
    for node in ast.walk(ast.parse(path.read_text())):
        match node:
            case ast.ImportFrom(module=str(module)) if module.startswith("echocal.diagnose."):
                there = module.split(".")[2]
                assert ROOMS_OF_DIAGNOSE.index(there) <= here, f"{path.name} must not import {module}"


def imported_files(path: Path) -> Iterator[Path]:
    """Files of the package that a file imports, also where only types or a function need them."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "echocal":
            folder = PACKAGE.joinpath(*str(node.module).split(".")[1:])
            for name in (
                alias.name for alias in node.names if (node.module, alias.name) != ("echocal", "_core")
            ):
                places = (
                    folder / f"{name}.py",
                    folder / name / "__init__.py",
                    folder.with_suffix(".py"),
                    folder / "__init__.py",
                )
                yield from [place for place in places if place.is_file()][:1]


def test_no_files_import_each_other_in_a_circle() -> None:
    graph = {path: set(imported_files(path)) - {path} for path in sorted(PACKAGE.rglob("*.py"))}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        circle = " -> ".join(str(path.relative_to(PACKAGE)) for path in error.args[1])
        pytest.fail(f"these import each other: {circle}")


def dependencies(manifest: str) -> set[str]:
    return set(tomllib.loads((ROOT / manifest).read_text()).get("dependencies", {}))


def test_the_readme_tells_the_dependencies_of_the_crates() -> None:
    for folder, said in re.findall(r"^\| `(rust/\w+)` \| (.*) \|$", (ROOT / "README.md").read_text(), re.M):
        sources = "".join(path.read_text() for path in (ROOT / folder / "src").rglob("*.rs"))
        used = {
            name for name in dependencies(f"{folder}/Cargo.toml") if f"{name.replace('-', '_')}::" in sources
        }
        told = re.search(r"depends on (`[\w-]+`) only", said)
        assert told is None or used == {told[1].strip("`")}, f"{folder} uses {used}"
        assert "uses no other crate" not in said or not used, f"{folder} uses {used}"


def test_crates_point_down() -> None:
    assert dependencies("rust/core/Cargo.toml") <= {"libm"}, "the core is pure: mathematics alone"
    pure = dependencies("rust/infer/Cargo.toml")
    assert pure <= {"libm", "echocal-core"}, "the inference is pure: the physics and mathematics alone"
    assert dependencies("rust/text/Cargo.toml") <= {"memchr", "zmij"}, "text is text: no physics, no arrays"
    assert not dependencies("firmware_gen/Cargo.toml") & {"pyo3", "numpy", "echocal-py"}


SOURCES = [
    path
    for folder in ("rust", "python", "firmware_gen", "tests", "benches")
    for ending in ("*.rs", "*.py", "*.j2")
    for path in sorted((ROOT / folder).rglob(ending))
]


def test_files_stay_short() -> None:
    lines = {path: len(path.read_text().splitlines()) for path in SOURCES}
    long = {str(path.relative_to(ROOT)): count for path, count in lines.items() if count > 400}
    assert not long, f"over 400 lines: {long}"
    assert median(lines.values()) < 150
