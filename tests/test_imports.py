"""What an import loads: pandas, SciPy and the like wait until they are used."""

import inspect
import json
import pickle
import subprocess
import sys

import pytest

import echocal

HEAVY = {
    "matplotlib",
    "netCDF4",
    "numpy",
    "pandas",
    "plotly",
    "polars",
    "pyarrow",
    "pydantic",
    "rich",
    "scipy",
    "sklearn",
    "xarray",
}
VERBS = ["budget", "calibrate", "correct", "diagnose", "sweep", "verify", "watch"]


def loaded(program: str) -> set[str]:
    """Names of the top packages that a program has loaded at its end."""
    program += (
        "\nimport json, sys; print(json.dumps(sorted(name for name in sys.modules if '.' not in name)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_the_import_loads_nothing_heavy() -> None:
    assert not loaded("import echocal") & HEAVY


def test_the_version_loads_nothing_heavy() -> None:
    program = "import sys; sys.argv[1:] = ['--version']; import echocal.__main__; echocal.__main__.main()"
    assert not loaded(program) & (HEAVY | {"typer"})


def test_a_scalar_speed_loads_only_numpy() -> None:
    assert loaded("import echocal; echocal.speed_of_sound(20.0, 0.5)") & HEAVY <= {"numpy"}


@pytest.mark.parametrize("name", VERBS)
def test_a_function_does_not_hide_its_module(name: str) -> None:
    inner = {"correct": ".batch", "watch": ".fleet"}.get(name, "")
    program = f"import echocal\nechocal.{name}\nimport echocal.{name}{inner} as module"
    program += f"\nassert module is __import__('sys').modules['echocal.{name}{inner}']"
    loaded(program)


@pytest.mark.parametrize("name", VERBS)
def test_a_verb_looks_like_its_function_and_travels(name: str) -> None:
    verb = getattr(echocal, name)
    function = getattr(verb, name)
    assert inspect.signature(verb) == inspect.signature(function)
    assert verb.__doc__ == function.__doc__
    assert pickle.loads(pickle.dumps(verb)) is verb


@pytest.mark.parametrize("name", VERBS)
def test_a_function_is_not_hidden_by_its_module(name: str) -> None:
    program = f"import echocal, echocal.{name}\nassert callable(echocal.{name}), echocal.{name}"
    program += f"\nfrom echocal import {name}\nassert callable({name})"
    loaded(program)


def test_every_public_name_is_there_and_listed() -> None:
    assert dir(echocal) == sorted(echocal.__all__)
    for name in echocal.__all__:
        assert getattr(echocal, name) is not None
    assert echocal.correct.correct_table is echocal.correct.correct  # type: ignore[attr-defined]
    assert echocal.watch.Fleet.__module__ == "echocal.watch.fleet"
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = echocal.nothing


def test_a_function_that_names_the_package_travels() -> None:
    """Spark, Ray and dask send the functions of a script by value, and the modules that they name."""
    cloudpickle = pytest.importorskip("cloudpickle")
    assert cloudpickle.loads(cloudpickle.dumps(echocal)) is echocal
