"""A message names an argument as its reader spells it: a keyword in Python, a flag in a command."""

import ast
import pickle
import re
import shlex
from collections.abc import Callable, Iterator
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import typer

import echocal
from echocal import cli, firmware, watch
from echocal.emulation import emulate
from echocal.keywords import as_here, command_line, keyword, naming
from echocal.lagging import generate_lagging
from echocal.per_unit import generate_per_unit
from echocal.waveforms.reading import read_waveforms

PACKAGE = Path(echocal.__file__).parent
FLAG = re.compile(r"(?<![\w-])--[a-z]")
JUSTIFIED = {
    "keywords.py": "makes the flags",
    "__main__.py": "tells the version before the command line is imported",
    "checksums.py": "sha256sum",
    "quantities/facts.py": "maturin",
    "silicon": "compilers",
}
MODULES = [path for path in sorted(PACKAGE.rglob("*.py")) if path.relative_to(PACKAGE).parts[0] != "cli"]


def strings(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of each string; of an f-string with the names between its parts as a letter."""
    for node in ast.walk(ast.parse(path.read_text())):
        match node:
            case ast.Constant(value=str(text)):
                yield node.lineno, text
            case ast.JoinedStr(values=parts):
                yield (
                    node.lineno,
                    "".join(
                        str(getattr(part, "value", "")) if isinstance(part, ast.Constant) else "x"
                        for part in parts
                    ),
                )


def test_no_string_outside_the_command_line_names_a_flag() -> None:
    found = {
        f"{path.relative_to(PACKAGE)}:{line}": text
        for path in MODULES
        if not {str(path.relative_to(PACKAGE)), path.parent.name} & {*JUSTIFIED}
        for line, text in strings(path)
        if FLAG.search(text)
    }
    assert not found, f"name the argument by echocal.keywords.keyword: {found}"


@pytest.mark.parametrize("place", JUSTIFIED)
def test_each_exception_is_needed(place: str) -> None:
    paths = [path for path in MODULES if place in {str(path.relative_to(PACKAGE)), path.parent.name}]
    assert any(FLAG.search(text) for path in paths for _, text in strings(path))


def test_each_keyword_is_one_of_python_and_has_a_flag() -> None:
    said = {
        node.args[0].value
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "keyword"
        if isinstance(node.args[0], ast.Constant) and path.name != "keywords.py"
    }
    group: Any = typer.main.get_command(cli.app)
    commands = [group.get_command(None, name) for name in cli.COMMANDS]
    flags = {one.name: one.opts[0] for command in commands for one in command.params}
    public = [getattr(echocal, name) for name in echocal.__all__]
    public += [
        watch.Reference,
        watch.Fleet,
        firmware.generate,
        firmware.EchoCodes,
        generate_per_unit,
        generate_lagging,
        emulate,
        read_waveforms,
    ]
    public += [echocal.Observations, echocal.Model]
    keywords = {name for one in public if callable(one) for name in parameters(one)} | {"with_shape"}
    assert len(said) > 30
    assert said <= keywords, said - keywords
    assert said <= {*flags}, said - {*flags}
    for name in said:
        with naming({}):
            assert keyword(name) == flags[name] or flags[name] in OTHER, name


OTHER = {"--column", "--uncertainty", "--max-distance-m", "--lag-interval-s", "--lag-smoothing-s"}
OTHER |= {"--echo-lsb-us", "--echo-min-us", "--echo-max-us", "--echo-bits"}
"""Flags that are not spelled as the keyword; the command that runs tells them."""


def parameters(one: Any) -> list[str]:
    try:
        return list(signature(one).parameters)
    except ValueError:
        return []


def table(random: np.random.Generator, **more: Any) -> pd.DataFrame:
    n = 60
    usual = {
        "time_s": 60.0 * np.arange(n),
        "reading_mm": (1000 + random.normal(0, 2, n)).round(1),
        "temperature_C": (20 + random.normal(0, 3, n)).round(2),
        **more,
    }
    return pd.DataFrame({name: own for name, own in usual.items() if own is not None})


def number(random: np.random.Generator) -> int:
    return int(random.integers(2, 90))


Mistake = tuple[dict[str, Any], str, dict[str, Any], str, str]
"""Columns, what is asked (diagnose or correct), keywords, and how Python and a command name the way out."""


def mistakes(random: np.random.Generator) -> dict[str, Mistake]:
    n, word = number(random), "".join(random.choice(list("bdfgkq"), 5))
    code = float(random.choice([9999, -9999, 65535]))
    return {
        "no step": ({}, "correct", {"round_mm": -n}, f"round_mm=-{n}", f"--round-mm -{n}"),
        "little memory": ({}, "correct", {"memory": f"{n}MB"}, f"memory='{n}MB'", f"--memory {n}MB"),
        "logs": ({}, "correct", {"logs": word}, f"logs='{word}'", f"--logs {word}"),
        "uncertainty": (
            {},
            "correct",
            {"uncertainties": {word: n}},
            f"uncertainties={{'{word}': {n}}}",
            f'--uncertainty "{word}={n}"',
        ),
        "other rows": ({}, "correct", {"append_only": [word]}, "append_only is for", "--append-only is for"),
        "condition": ({}, "diagnose", {"at": {word: n}}, f"at={{'{word}': '{n}'}}", f'--at "{word}={n}"'),
        "no reference": ({}, "diagnose", {}, "give constant_distance=True", "give --constant-distance"),
        "speed": ({}, "diagnose", {"reading_speed": n}, "reading_speed=343", "--reading-speed 343"),
        "two readings": (
            {"reading_mm": np.full(60, 1e3), "reading_m": np.full(60, 1.0)},
            "diagnose",
            {},
            "columns={'reading_m': 'ignore'}",
            '--column "reading_m=ignore"',
        ),
        "other unit": (
            {"temperature_C": 280 + random.normal(0, 3, 60)},
            "diagnose",
            {"constant_distance": True},
            "trust=['temperature_C']",
            '--trust "temperature_C"',
        ),
        "no thermometer": (
            {"temperature_C": None},
            "diagnose",
            {"constant_distance": True},
            "at={'temperature': '20+-2'}",
            '--at "temperature=20+-2"',
        ),
        "dates": (
            {"time_s": None, "time": [f"{word} {n}"] * 60},
            "diagnose",
            {"time_format": "%Q %d"},
            "time_format='%Q %d'",
            '--time-format "%Q %d"',
        ),
        "code": (
            {"temperature_C": [20.0, *[code] * 59]},
            "diagnose",
            {"constant_distance": True},
            f"missing={{'temperature_C': {code:g}}}",
            f'--missing "temperature_C={code:g}"',
        ),
    }


FLAGS = {"uncertainties": "--uncertainty"}


def words(name: str, value: Any) -> list[str]:
    flag = FLAGS.get(name, f"--{name.replace('_', '-')}")
    if value is True:
        return [flag]
    if isinstance(value, dict):
        return [part for own, one in value.items() for part in (flag, f"{own}={one}")]
    return [flag, ",".join(value) if isinstance(value, list) else str(value)]


@pytest.mark.parametrize("mistake", mistakes(np.random.default_rng(0)))
def test_the_same_mistake_in_python_and_in_a_command(
    mistake: str,
    random: np.random.Generator,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    columns, asked, keywords, python, flag = mistakes(random)[mistake]
    path = tmp_path / "log.csv"
    table(random, **columns).to_csv(path, index=False)
    ask: Callable[..., Any] = echocal.diagnose
    extra: list[Any] = []
    if asked == "correct":
        ask, extra = echocal.correct_files, [tmp_path / "out.csv", echocal.Model("linear")]
    with pytest.raises(echocal.EchocalError) as told:
        ask(path, *extra, **keywords)
    assert python in str(told.value)
    assert not FLAG.search(str(told.value).replace("inspect LOG -o log.toml", "").split("; echocal ")[0])
    line = ["echocal", asked, str(path), *(["-o", str(extra[0]), "--law", "linear"] if extra else [])]
    line += [word for name, value in keywords.items() for word in words(name, value)]
    monkeypatch.setattr("sys.argv", line)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    said = capsys.readouterr().err
    assert ended.value.code == told.value.exit_code
    assert flag in said
    assert python not in said
    assert keyword("by") == "by"  # the command has ended


def said_by(task: str) -> str:
    return keyword(task, 5)


def test_a_worker_names_them_as_the_process_that_asks() -> None:
    with naming({"columns": "--column"}):
        work = pickle.loads(pickle.dumps(as_here(said_by)))
    assert (work("memory"), said_by("memory")) == ("--memory 5", "memory=5")
    assert as_here(said_by)("memory") == "memory=5"


@pytest.mark.parametrize("hostile", ['a"b', "a$b", "a`b", "a b'c", "ä\\"])
def test_a_shell_reads_the_value_that_is_named(hostile: str) -> None:
    with naming({}):
        assert shlex.split(keyword("by", hostile)) == ["--by", hostile]
        assert shlex.split(keyword("trust", [hostile])) == ["--trust", hostile]
        assert shlex.split(keyword("columns", {hostile: "ignore"})) == ["--columns", f"{hostile}=ignore"]
    assert ast.literal_eval(keyword("by", hostile).removeprefix("by=")) == hostile
    assert shlex.split(command_line("inspect", hostile, by=hostile))[2:] == [hostile, "--by", hostile]
