"""Functions of echo time, temperature and humidity: bound, twin, C, and what is refused."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from toolchain import C_COMPILERS, build, hash_of_all

from echocal import BoundError, Model, UsageError, firmware
from echocal.firmware import Firmware, HumidityCodes

COARSE: dict[str, Any] = {"temperature": (1.0, -20.0, 60.0), "humidity": (0.05, 0.0, 1.0), "echo": 26_000}
DIAGNOSED = Model("linear", {"humidity": {"coefficient": 0.9}, "fixed_delay": {"delay": 31e-6}})


def every_input(made: Firmware) -> tuple[np.ndarray, ...]:
    """All codes, as the axes of a box."""
    device = made.report["device"]
    axes = [device["echo"], *device["conditions"]]
    codes = [np.arange(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1) for axis in axes]
    return tuple(np.meshgrid(*codes, indexing="ij"))


@pytest.mark.slow
@pytest.mark.parametrize("compiler", C_COMPILERS)
@pytest.mark.parametrize("model", [Model("cramer"), DIAGNOSED], ids=["cramer", "diagnosed"])
@pytest.mark.parametrize("target", ["c99", "avr", "cortex-m0"])
def test_c_is_the_twin_on_every_input(model: Model, target: str, compiler: str, tmp_path: Path) -> None:
    made = firmware.generate(model, target, **COARSE)
    first = made.report["device"]["echo"]["codes"]["minimum"]
    assert made.report["inputs_checked"] == 81 * 21 * (26_000 - first + 1)
    assert made.report["error_proven_m"] <= 0.5e-3
    flags = ("-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all")
    assert hash_of_all(build(made, tmp_path, compiler, *flags)) == made.report["output_hash"]


@pytest.mark.parametrize("target", ["c99", "avr"])
def test_a_table_in_two_inputs(target: str, tmp_path: Path) -> None:
    """Linear between its entries both ways, and cheaper where more error is allowed."""
    request = {**COARSE, "temperature": (2.0, -20.0, 60.0), "form": "grid", "max_table_bytes": 4096}
    exact, loose = (
        firmware.generate(DIAGNOSED, target, max_error=bound, **request) for bound in (0.3e-3, 2e-3)
    )
    assert exact.report["error_proven_m"] <= 0.3e-3
    assert loose.report["table_bytes"] < exact.report["table_bytes"]
    assert hash_of_all(build(exact, tmp_path)) == exact.report["output_hash"]


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@example(delay=0.0, law="cramer", low=0.0, span=5.0, max_error=1e-3, prefer="size", target="avr")
@given(
    delay=st.floats(0.0, 1e-4),
    law=st.sampled_from(["cramer", "ideal_gas"]),
    low=st.floats(-25.0, 20.0),
    span=st.floats(5.0, 40.0),
    max_error=st.floats(-3.8, -2.5).map(lambda exponent: 10.0**exponent),
    prefer=st.sampled_from(["size", "speed"]),
    target=st.sampled_from(["avr", "c99", "rv32"]),
)
def test_twin_and_model_agree_within_the_bound(
    delay: float, law: str, low: float, span: float, max_error: float, prefer: str, target: str
) -> None:
    model = Model(law, {"fixed_delay": {"delay": delay}})
    request: dict[str, Any] = {"temperature": (1.0, low, low + span), "humidity": (0.1, 0.0, 0.9)}
    made = firmware.generate(model, target, echo=1500, max_error=max_error, prefer=prefer, **request)
    echo, temperature, damp = every_input(made)
    truth = model.distance(echo * 1e-6, temperature=temperature * 1.0, relative_humidity=damp * 0.1)
    outputs = made.distance_um(echo, temperature, damp)
    error = np.abs(outputs * 1e-6 - truth)
    assert error.max() == pytest.approx(made.report["error_overall_m"], rel=1e-6, abs=1e-12)
    assert error.max() <= max_error  # every echo is near
    assert (np.diff(outputs, axis=0) >= 0).all()


def test_a_tight_bound_takes_the_square_of_the_humidity() -> None:
    made = firmware.generate(Model("cramer"), max_error=0.1e-3, **COARSE)
    assert "plus its square times" in made.report["form"]["description"]
    assert made.report["error_proven_m"] <= 0.1e-3


def test_worst_input_and_golden_vectors_name_the_humidity() -> None:
    made = firmware.generate(Model("cramer"), **COARSE)
    worst = made.report["worst_input"]
    assert worst["relative_humidity"] == pytest.approx(worst["humidity_code"] * 0.05)
    codes = (worst["echo_us"], worst["temperature_code"], worst["humidity_code"])
    quantities = {"temperature": worst["temperature"], "relative_humidity": worst["relative_humidity"]}
    truth = float(Model("cramer").distance(codes[0] * 1e-6, **quantities))
    error = abs(int(made.distance_um(*codes)) * 1e-6 - truth)
    assert error == pytest.approx(made.report["error_proven_m"], rel=1e-6)
    lines = made.files["echocal_golden.csv"].splitlines()
    assert lines[0] == "echo_us,temperature_code,humidity_code,distance_um,status"
    for line in itertools.islice(lines, 1, None, 37):
        *inputs, output, status = map(int, line.split(","))
        assert (int(made.distance_um(*inputs)), int(made.status(*inputs))) == (output, status)


@pytest.mark.parametrize(
    ("humidity", "message"),
    [
        (HumidityCodes(0.01, 0.0, 1.5), "0 <= low <= high <= 1"),
        (HumidityCodes(0.0), "an LSB other than 0"),
    ],
)
def test_humidity_codes_that_make_no_sense(humidity: HumidityCodes, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        firmware.generate(Model("cramer"), humidity=humidity)


def test_humidity_is_measured_or_assumed() -> None:
    with pytest.raises(UsageError, match="cannot be assumed as well"):
        firmware.generate(Model("cramer"), humidity=HumidityCodes(), assume={"relative_humidity": 0.5})
    dry = firmware.generate(Model("cramer"), temperature=(1.0, 0.0, 20.0), echo=500)
    with pytest.raises(UsageError, match="takes no humidity_code"):
        dry.distance_um(1, 1, 1)


@pytest.mark.slow
def test_no_tables_where_none_are_allowed() -> None:
    """Tables too large to be allowed once beat the polynomials first, and then nothing was left.

    Tables do beat them here. Few inputs are enough: the proof of each form visits them all.
    """
    effects = {"temperature_gain": {"gain": -0.018}, "amplitude_walk": {"delay": 19e-6, "threshold": 0.7}}
    warm = firmware.TemperatureCodes(2.5, -20.0, 30.0, -273.15)
    request: dict[str, Any] = {"temperature": warm, "humidity": (0.1, 0.2, 1.0), "echo": 3_000}
    made, free = (
        firmware.generate(
            Model("ideal_gas", effects), "avr", max_error=1e-3, prefer="speed", **request, **limit
        )
        for limit in ({"max_table_bytes": 0}, {})
    )
    assert free.report["table_bytes"] > 0
    assert made.report["table_bytes"] == 0
    assert made.report["error_proven_m"] <= 1e-3


def test_a_humidity_of_one_code_is_checked_and_costs_nothing() -> None:
    axes: dict[str, Any] = {"temperature": (0.5, -20.0, 60.0), "echo": 26_000}
    damp = firmware.generate(Model("cramer"), "avr", humidity=(0.01, 0.5, 0.5), **axes)
    dry = firmware.generate(Model("cramer"), "avr", assume={"relative_humidity": 0.5}, **axes)
    assert damp.report["form"] == dry.report["form"]
    assert damp.outputs(20_000, 40, [49, 50, 51]).tolist() == [
        -(2**31),
        int(dry.outputs(20_000, 40)),
        -(2**31),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("unit", "bound"), [("mm", 0.52e-3), ("cm", 5.5e-3)])
def test_a_tight_bound_in_a_coarse_unit_is_answered(unit: str, bound: float) -> None:
    axes: dict[str, Any] = {"temperature": (0.5, -20.0, 60.0), "humidity": (0.02, 0.0, 1.0), "echo": 26_000}
    made = firmware.generate(Model("cramer"), "avr", output_unit=unit, max_error=bound, **axes)
    assert 0.49 * bound < made.report["error_proven_m"] <= bound


@pytest.mark.slow
def test_a_bound_below_the_rounding_is_answered_with_the_best() -> None:
    with pytest.raises(BoundError, match=r"the best reachable is 0\.50"):
        firmware.generate(Model("cramer"), "avr", output_unit="mm", max_error=0.45e-3, **COARSE)
