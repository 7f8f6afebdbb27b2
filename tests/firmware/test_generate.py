"""What `generate` promises, checked against the float model and not against itself."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from toolchain import build, hash_of_all

from echocal import BoundError, EchocalError, Model, ModelError, UsageError, _core, firmware

HALF_DEGREES = (0.5, -20.0, 60.0)


FOLDED = {facts["id"]: facts["parameters"] for facts in _core.effects() if facts["firmware"] == "folded"}


@st.composite
def models(draw: st.DrawFn) -> Model:
    """Models that a diagnosis could write: a law and a few effects, up to three prior scales large."""
    effects: dict[str, dict[str, float]] = {}
    for name in draw(st.sets(st.sampled_from(sorted(FOLDED)), max_size=4)):
        effects[name] = {}
        for parameter in FOLDED[name]:
            (low, high), neutral, scale = (parameter[key] for key in ("bounds", "neutral", "prior_scale"))
            value = draw(st.floats(max(low, neutral - 3 * scale), min(high, neutral + 3 * scale)))
            effects[name][parameter["name"]] = value
    try:
        return Model(draw(st.sampled_from(["linear", "cramer", "ideal_gas", "320-0.5*T"])), effects)
    except ModelError:
        reject()  # two terms that contradict each other


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    model=models(),
    lsb=st.sampled_from([0.0625, 0.1, 0.5, 1.0]),
    low=st.floats(-25.0, 30.0),
    warmer=st.floats(1.0, 30.0),
    shortest=st.integers(0, 150),
    span=st.integers(50, 3000),
    max_error=st.floats(-6.5, -2.5).map(lambda exponent: 10.0**exponent),
    prefer=st.sampled_from(["size", "speed"]),
)
def test_c_twin_and_model_agree_within_the_bound(
    model: Model,
    lsb: float,
    low: float,
    warmer: float,
    shortest: int,
    span: int,
    max_error: float,
    prefer: str,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    codes = firmware.EchoCodes(1.0, shortest + span, shortest)
    request: dict[str, Any] = {"temperature": (lsb, low, low + warmer), "echo": codes, "prefer": prefer}
    try:
        made = firmware.generate(model, max_error=max_error, **request)
    except BoundError as error:
        enough = float(re.search(r"ask for ([0-9.e-]+) mm", str(error))[1])  # type: ignore[index]
        assert enough * 1e-3 > max_error
        made = firmware.generate(model, max_error=enough * 1e-3, **request)
        max_error = enough * 1e-3
    except ModelError as error:
        assert "gives no distance" in str(error)  # noqa: PT017
        reject()  # some effects leave the shortest echoes without a distance
    assert made.report["error_proven_m"] <= max_error
    warm = made.report["device"]["conditions"][0]["codes"]
    every = np.arange(shortest, shortest + span + 1)
    times, temperatures = np.meshgrid(every, np.arange(warm["minimum"], warm["maximum"] + 1))
    truth = model.distance(times * 1e-6, temperature=temperatures * lsb, pressure=101_325.0)
    if not np.isfinite(truth).all():
        reject()  # where the core itself finds no distance, there is nothing to agree with
    outputs = made.distance_um(times, temperatures)
    error = np.abs(outputs * 1e-6 - truth)
    assert error.max() == pytest.approx(made.report["error_overall_m"], rel=1e-6, abs=1e-12)
    assert (np.diff(outputs, axis=1) >= 0).all()
    program = build(made, tmp_path_factory.mktemp("drawn"), "gcc", "-O1")
    assert hash_of_all(program) == made.report["output_hash"]


def test_dry_cramer_beats_the_best_known_integer_polynomial() -> None:
    """Degree 2 with a 16-bit speed had 0.090 mm at 4 m, with its coefficients rounded one by one."""
    dry = {"relative_humidity": 0.0, "co2_mole_fraction": 0.0}
    made = firmware.generate(Model("cramer"), max_error=0.06e-3, assume=dry)
    assert made.report["form"]["tail"]["scale_bits"] == 8
    assert made.report["inputs_checked"] == 1281 * (25_069 - 109 + 1)


def test_worst_input_is_where_it_is_said_to_be() -> None:
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    report = (made := firmware.generate(model, temperature=HALF_DEGREES)).report
    worst = report["worst_input"]
    truth = float(model.distance(worst["echo_us"] * 1e-6, temperature=worst["temperature"]))
    output = int(made.distance_um(worst["echo_us"], worst["temperature_code"])) * 1e-6
    assert abs(output - truth) == pytest.approx(report["error_proven_m"], rel=1e-6)


def test_identical_input_gives_identical_bytes() -> None:
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    first = firmware.generate(model, temperature=HALF_DEGREES, n_threads=1)
    again = firmware.generate(
        Model("cramer", {"fixed_delay": {"delay": 31e-6}}), temperature=HALF_DEGREES, n_threads=3
    )
    assert first.files == again.files
    other = firmware.generate(Model("cramer", {"fixed_delay": {"delay": 32e-6}}), temperature=HALF_DEGREES)
    assert first.report["model_hash"] != other.report["model_hash"]


def test_a_bound_out_of_reach_says_what_is_within_reach() -> None:
    with pytest.raises(
        BoundError, match=r"0\.0001 mm up to 4 m cannot be met: the best reachable is 0\.000\d mm .*; ask for"
    ):
        firmware.generate(Model("cramer"), temperature=HALF_DEGREES, max_error=1e-7)


def test_an_effect_without_its_input_is_refused_by_name() -> None:
    model = Model("linear", {"humidity": {"coefficient": 1.0}})
    with pytest.raises(
        UsageError, match=r"effect humidity needs relative_humidity, .*: up to \d+\.\d mm .*--accept humidity"
    ):
        firmware.generate(model, temperature=HALF_DEGREES)
    assumed = {"relative_humidity": 0.6}
    made = firmware.generate(model, temperature=HALF_DEGREES, accept=["humidity"], assume=assumed)
    assert any("humidity" in line for line in made.report["assumptions"])
    truth = float(model.distance(11_000e-6, temperature=25.0, **assumed))
    assert int(made.distance_um(11_000, 50)) * 1e-6 == pytest.approx(truth, abs=0.5e-3)


def test_what_the_law_assumes_is_stated() -> None:
    model = Model("cramer", air={"relative_humidity": 0.5})
    lines = firmware.generate(model, temperature=HALF_DEGREES).report["assumptions"]
    assert any(
        re.match(r"relative_humidity 0\.5: up to \d+\.\d mm if it is anywhere in 0 \.\. 1$", line)
        for line in lines
    )


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"temperature": (0.0625, 60.0, -20.0)}, "low <= high"),
        ({"temperature": (0.0, -20.0, 60.0)}, "an LSB other than 0"),
        ({"temperature": (1e-3, -40.0, 60.0)}, "int16_t holds -32768 .. 32767"),
        ({"temperature": (5.0, 21.0, 24.0)}, "holds no code"),
        ({"echo": 70_000}, "outside 1 .. 65535"),
        ({"max_error": 0.0}, "error bound is 0 mm: give a positive number"),
        ({"max_error": float("nan")}, "positive number"),
        ({"max_error": 0.5}, "is 500 mm, and no distance sensor needs one above 100 mm: 0.5 mm is max_error"),
        ({"target": "z80"}, "unknown target 'z80'; this version has c99"),
        ({"prefer": "beauty"}, "unknown preference 'beauty'"),
        ({"n_threads": 0}, "n_threads is 0; give a whole number of 1"),
        ({"form": "additive"}, "of temperature and humidity, and the device measures no humidity"),
        (
            {"form": "square", "humidity": (0.1, 0.0, 1.0)},
            "of the temperature alone, and the device measures",
        ),
        ({"form": "segments"}, "no form 'segments' computes this model for c99"),
        ({"humidity": (0.1, 0.55, 0.56)}, "0.55:0.56 (1 is 100 %) with LSB 0.1 holds no code"),
        ({"form": "spline"}, "unknown form 'spline'; this version has polynomial"),
        ({"assume": {"relative_humdity": 0.5}}, "unknown influence quantity"),
    ],
)
def test_requests_that_make_no_sense(request_: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        firmware.generate(Model("cramer"), **request_)


def test_a_model_without_growing_distance_is_refused() -> None:
    with pytest.raises(EchocalError, match="does not grow with the echo time at"):
        firmware.generate(Model("100-5*T"), temperature=(0.5, 30.0, 60.0))


def test_progress_is_told_and_can_stop() -> None:
    told: list[tuple[str, int, int]] = []
    firmware.generate(Model("cramer"), temperature=HALF_DEGREES, progress=lambda *step: told.append(step))
    assert told[0][1] == 0
    assert told[-1][1] == told[-1][2] == 161 * (25_072 - 109 + 1)

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        firmware.generate(Model("cramer"), temperature=HALF_DEGREES, progress=stop)


def test_save_writes_the_files_of_the_interface(tmp_path: Path) -> None:
    made = firmware.generate(Model("cramer"), temperature=HALF_DEGREES)
    names = {path.name for path in made.save(tmp_path / "new" / "folder")}
    assert names >= {"echocal_correction.h", "echocal_correction.c", "echocal_golden.csv", "report.json"}
    assert json.loads((tmp_path / "new" / "folder" / "report.json").read_text()) == made.report


def test_what_is_left_out_is_told_as_far_as_the_device_hears() -> None:
    near, far = (
        firmware.generate(Model("cramer"), temperature=HALF_DEGREES, echo=echo) for echo in (2_000, 20_000)
    )
    told = [
        float(re.search(r"relative_humidity 0: up to ([0-9.]+) mm", made.report["assumptions"][0])[1])  # type: ignore[index]
        for made in (near, far)
    ]
    assert told[0] == pytest.approx(told[1] / 10, abs=0.1)
