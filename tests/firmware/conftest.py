"""Firmware of every form and format, each made once per session."""

import fcntl
import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from echocal import Model, firmware
from echocal.firmware import Firmware

DELAY_AND_ZERO = {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": -4e-3}}
HALF_DEGREES = (0.5, -20.0, 60.0)

CASES: dict[str, tuple[Model, dict[str, Any]]] = {
    "degree_2": (Model("cramer"), {}),
    "degree_3": (Model("ideal_gas", DELAY_AND_ZERO), {"max_error": 0.1e-3}),
    "degree_5": (
        Model("linear", {"unrecorded_humidity": {"relative_humidity": 1.0}}),
        {"max_error": 0.03e-3, "form": "polynomial"},
    ),
    "one_speed": (Model("343"), {}),
    "falling_speed": (Model("320-0.5*T", DELAY_AND_ZERO), {"max_error": 0.1e-3}),
    "product_of_64_bits": (Model("cramer", DELAY_AND_ZERO), {"max_error": 2e-6}),
    "full_table": (Model("cramer", DELAY_AND_ZERO), {"form": "full_table"}),
    "interpolated_table": (
        Model("cramer", DELAY_AND_ZERO),
        {"form": "interpolated_table", "max_error": 0.1e-3},
    ),
    "falling_table": (Model("320-0.5*T"), {"form": "interpolated_table"}),
    "avr_polynomial": (Model("cramer"), {"target": "avr", "max_error": 0.1e-3}),
    "avr_middle_of_a_signed_sum": (
        Model("cramer", air={"relative_humidity": 0.9}),
        {"target": "avr", "form": "polynomial", "max_error": 1.2e-3},
    ),
    "avr_table": (Model("cramer", DELAY_AND_ZERO), {"target": "avr", "form": "interpolated_table"}),
    "avr_factored": (
        Model("cramer"),
        {"target": "avr", "form": "factored", "temperature": (0.0625, -5.0, 30.0)},
    ),
    "avr_factored_and_bent": (Model("cramer"), {"target": "avr", "form": "factored", "max_error": 0.1e-3}),
    "factored": (Model("ideal_gas", DELAY_AND_ZERO), {"form": "factored", "target": "cortex-m3"}),
    "square": (Model("cramer"), {"form": "square", "max_error": 0.2e-3}),
    "avr_segments": (
        Model("cramer"),
        {"target": "avr", "form": "segments", "temperature": (0.0625, -5.0, 30.0)},
    ),
    "word_of_32_bits": (Model("ideal_gas", DELAY_AND_ZERO), {"target": "cortex-m0", "max_error": 0.1e-3}),
    "whole_range_of_echo": (Model("cramer"), {"echo": 65_535, "temperature": (1.0, -20.0, 60.0)}),
}


@functools.cache
def made(name: str, package: str = "c") -> Firmware:
    model, request = CASES[name]
    return firmware.generate(model, package=package, **{"temperature": HALF_DEGREES, **request})


@functools.cache
def with_humidity(package: str = "c", target: str = "avr") -> Firmware:
    """A function of three codes, for a model as a diagnosis makes it."""
    codes = {"temperature": (2.0, -20.0, 60.0), "humidity": (0.1, 0.0, 1.0), "echo": 26_000}
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    return firmware.generate(model, target, package=package, **codes)


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Callable[[Path], None]], Path]:
    """Folders that are filled once, whichever of the parallel workers comes first."""

    def folder(name: str, fill: Callable[[Path], None]) -> Path:
        base = tmp_path_factory.getbasetemp()
        place = (base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base) / name
        with place.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (place / "done").exists():
                place.mkdir(exist_ok=True)
                fill(place)
                (place / "done").touch()
        return place

    return folder


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> Firmware:
    return made(request.param)
