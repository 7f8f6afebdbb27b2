"""The header tells the whole truth: domain, baked values, reach, uncertainties, versions."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from toolchain import STRICT, run

import echocal
from echocal import Model, firmware
from echocal.cli import main
from echocal.device_uncertainty import COVERAGE, rounded_up
from echocal.firmware import EchoCodes, Firmware
from echocal.model import ResidualUncertainty
from echocal.registry import find_effect

HALF_DEGREES = (0.5, -20.0, 60.0)
HEADER = "echocal_correction.h"
DELAY, SCALE = 31e-6, 0.9  # s; 1
SIGMAS = {
    "delay": 4e-6,
    "scale": 0.2,
    "residual": 1.5e-3,
    "thermometer": 0.6,
    "humidity": 0.1,
    "pressure": 400.0,
}


def fitted() -> Model:
    """A model as a diagnosis leaves it, with correlated parameters."""
    delay, scale = SIGMAS["delay"], SIGMAS["scale"]
    both = -0.5 * delay * scale
    return Model(
        "linear",
        {"humidity": {"coefficient": SCALE}, "fixed_delay": {"delay": DELAY}},
        covariance=[[scale**2, both], [both, delay**2]],
        residual_uncertainty=ResidualUncertainty(SIGMAS["residual"]),
    )


def generated(**request: object) -> Firmware:
    stated = {"temperature_C": 0.6, "humidity_percent": 10.0, "pressure_hPa": 4.0}
    codes = {"temperature": HALF_DEGREES, "accept": ["humidity"], "assume": {"relative_humidity": 0.5}}
    return firmware.generate(fitted(), uncertainties=stated, **{**codes, **request})


def test_the_expanded_uncertainty_is_what_a_simulation_finds(random: np.random.Generator) -> None:
    """Parameters, thermometer, assumed values, steps of codes and the residual, drawn for 20,000 devices."""
    made, count = generated(temperature=(0.5, 20.0, 20.0)), 20_000
    delay, scale = random.multivariate_normal([DELAY * 1e6, SCALE], [[16.0, -0.4], [-0.4, 0.04]], count).T
    warm = 20.0 + random.normal(0.0, SIGMAS["thermometer"], count) + random.uniform(-0.25, 0.25, count)
    damp = 0.5 + random.normal(0.0, SIGMAS["humidity"], count)
    thin = 101_325.0 + random.normal(0.0, SIGMAS["pressure"], count)
    carbon = random.uniform(3e-4, 2e-3, count)
    air = {"temperature": warm, "relative_humidity": damp, "pressure": thin, "co2_mole_fraction": carbon}
    base = Model("linear", {"humidity": {"coefficient": 1.0}})
    dry = Model("linear")
    for distance, told in made.report["expanded_uncertainty"]["expanded"]:
        echo = fitted().time_of_flight(distance, temperature=20.0, relative_humidity=0.5)
        heard = echo - delay * 1e-6 + random.uniform(-0.5e-6, 0.5e-6, count)
        speed = [np.asarray(one.distance(1.0, **air)) for one in (dry, base)]
        true = heard * (speed[0] + scale * (speed[1] - speed[0]))
        true += random.normal(0.0, SIGMAS["residual"], count)
        assert told == pytest.approx(COVERAGE * true.std(), rel=0.03)


@pytest.mark.filterwarnings("ignore::echocal.DomainWarning")
@pytest.mark.parametrize("assumed", [0.0, 0.5, 1.0])
def test_the_expanded_uncertainty_covers_all_air(assumed: float, random: np.random.Generator) -> None:
    """What is not measured is drawn from its whole range, at all accepted temperatures, beyond 4 m, too."""
    model, count = Model("cramer"), 4000
    made = firmware.generate(
        model, temperature=(2.0, -20.0, 60.0), assume={"relative_humidity": assumed}, max_error=2e-3
    )
    told = made.report["expanded_uncertainty"]
    for warm in (-20, 0, 20, 40, 60):
        for distance in (0.5, 2.0, 4.0, 4.4):
            air = {
                "temperature": warm + random.uniform(-1.0, 1.0, count),
                "relative_humidity": random.uniform(0.0, 1.0, count),
                "pressure": random.uniform(8e4, 1.06e5, count),
                "co2_mole_fraction": random.uniform(3e-4, 2e-3, count),
            }
            echo = np.rint(1e6 * np.asarray(model.time_of_flight(distance, **air))).astype(int)
            codes = made.report["device"]["echo"]["codes"]
            echo = np.where(echo <= codes["maximum"], echo, -1)
            kept = echo >= 0
            if kept.sum() < count:  # part of the air is out of reach
                continue
            error = np.abs(made.distance_um(echo[kept], warm // 2) * 1e-6 - distance)
            assert np.mean(error <= told["offset"] + told["slope"] * distance) >= 0.94
            own = dict(map(tuple, told["expanded"])).get(distance)
            assert own is None or np.mean(error <= own) >= 0.94


@pytest.mark.parametrize(
    "name", ["reading_mm", "resolution_mm", "thermometer_C", "wind_m_s", "level_m", "tape"]
)
def test_what_the_device_does_not_read_is_refused(name: str) -> None:
    with pytest.raises(echocal.UsageError, match="changes no distance of this device; leave it out"):
        firmware.generate(
            Model("cramer"),
            temperature=(2.0, -20.0, 60.0),
            max_error=2e-3,
            uncertainties=[f"{name}={'II' if name == 'tape' else 3}"],
        )


@pytest.mark.parametrize("effect", ["unrecorded_humidity", "gas_composition"])
def test_what_an_effect_replaces_is_left_out(effect: str) -> None:
    (parameter,) = find_effect(effect).parameters
    model = Model("cramer", {effect: {parameter.name: 0.3}})
    made = firmware.generate(model, temperature=(2.0, -20.0, 60.0), max_error=2e-3)
    assert made.report["expanded_uncertainty"]["expanded"]


def test_a_short_reach_has_an_uncertainty_too() -> None:
    made = firmware.generate(
        Model("cramer"), temperature=(2.0, -20.0, 60.0), max_error=2e-3, max_distance=0.3
    )
    ((distance, size),) = made.report["expanded_uncertainty"]["expanded"]
    assert distance == 0.3
    assert size > 0.0
    assert "echocal_uncertainty_um" in made.files[HEADER]


def test_the_device_has_that_uncertainty(tmp_path: Path) -> None:
    """Nowhere below what the budget states, and at its ends not a tenth above."""
    for unit, bound in (("um", 0.5e-3), ("mm", 1.2e-3), ("cm", 7e-3)):
        made = generated(output_unit=unit, max_error=bound)
        made.save(tmp_path / unit)
        (tmp_path / "main.c").write_text(
            '#include <stdio.h>\n#include "echocal_correction.h"\nint main(void)\n{\n    long distance;\n'
            '    while (scanf("%ld", &distance) == 1) {\n'
            '        printf("%lu\\n", (unsigned long)echocal_uncertainty_um((int32_t)distance));\n    }\n'
            "    return 0;\n}\n"
        )
        run("gcc", "-std=c99", *STRICT, f"-I{tmp_path / unit}", tmp_path / "main.c", "-o", tmp_path / "main")
        stated = made.report["expanded_uncertainty"]["expanded"]
        outputs = [int(distance / made.report["device"]["output"]["lsb"]) for distance, _ in stated]
        text = "\n".join(map(str, [*outputs, -5]))
        *said, below = (int(word) * 1e-6 for word in run(tmp_path / "main", text=text).split())
        assert all(one >= size for one, (_, size) in zip(said, stated, strict=True))
        assert said[-1] <= 1.1 * stated[-1][1] + 1e-6
        assert 0.0 < below <= said[0]


def test_parameters_have_their_standard_uncertainties() -> None:
    header = generated().files[HEADER]
    lines = re.findall(r"^ \*   (\w+), (\w+): (\S+).*, standard uncertainty (\S+)", header, re.MULTILINE)
    told = {parameter: (float(value), float(size)) for _, parameter, value, size in lines}
    assert told.keys() == {"delay", "coefficient"}
    for (value, size), (true, sigma) in zip(
        (told["delay"], told["coefficient"]),
        ((DELAY, SIGMAS["delay"]), (SCALE, SIGMAS["scale"])),
        strict=True,
    ):
        assert value == pytest.approx(true)
        assert sigma <= size <= 1.011 * sigma


def test_a_baked_value_is_told_with_what_it_adds() -> None:
    made = generated()
    (line,) = (line for line in made.report["assumptions"] if "humidity" in line)
    told = re.search(
        r"over 0 \.\. 1; computed for relative_humidity 0\.5, it adds up to \+([0-9.]+) mm", line
    )
    assert told is not None
    warm = np.linspace(-20.0, 60.0, 161)
    echo = fitted().time_of_flight(4.0, temperature=warm, relative_humidity=0.5)
    without = Model("linear", {"fixed_delay": {"delay": DELAY}}).distance(echo, temperature=warm)
    assert float(told[1]) == pytest.approx(1e3 * (4.0 - without).max(), abs=0.06)
    assert line in made.files[HEADER]


def test_what_is_left_out_is_in_the_budget() -> None:
    model = Model("linear", {"temperature_lag": {"time_constant": 60.0}})
    kept = firmware.generate(Model("linear"), temperature=HALF_DEGREES)
    made = firmware.generate(model, temperature=HALF_DEGREES, accept=["temperature_lag"])
    (left,) = (one["left_m"] for one in made.report["omissions"] if one["effect"])
    (far, more), (_, less) = (one.report["expanded_uncertainty"]["expanded"][-1] for one in (made, kept))
    assert far == 4.0
    assert more**2 - less**2 == pytest.approx(COVERAGE**2 * left**2 / 3.0, rel=0.01)


def test_codes_outside_the_domain_of_the_law_are_told() -> None:
    with pytest.warns(echocal.DomainWarning):
        made = firmware.generate(Model("cramer"), temperature=(0.5, -100.0, 200.0), max_error=2e-3)
    for end in (-100, 200):
        line = f"law 'cramer' holds for temperature -20 .. 60 degC: outside at {end} degC"
        assert line in made.files[HEADER]
    assert "not known to hold" not in firmware.generate(Model("cramer")).files[HEADER]


def test_the_reach_is_that_of_the_timer() -> None:
    """8 MHz in 16 bits end at 8,192 us: nothing is said of 4 m."""
    with pytest.warns(echocal.DomainWarning, match="a 16-bit timer"):
        made = firmware.generate(Model("cramer"), temperature=HALF_DEGREES, echo=EchoCodes(0.125))
    codes = made.report["device"]["echo"]["codes"]
    warm = np.arange(-40, 121)
    near, far = (made.distance_um(codes[end], warm) * 1e-6 for end in ("minimum", "maximum"))
    reach = made.report["reach_m"]
    assert reach["always"] == pytest.approx([near.max(), far.min()])
    assert reach["sometimes"] == pytest.approx([near.min(), far.max()])
    header = made.files[HEADER]
    assert not re.search(r"up to 4(\.0)? m\b", header)
    assert f"Error at distances up to {rounded_up(float(far.max()), 3):g} m" in header
    assert re.search(r"Reach: distances from 0\.\d+ to 1\.30\d m are accepted in all conditions", header)


def test_nothing_is_rounded_down(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert rounded_up(0.066705) == 0.0668
    assert rounded_up(0.0667) == 0.0667
    monkeypatch.chdir(tmp_path)
    below = 0
    for delay in np.linspace(0.0, 60e-6, 6):
        Model("cramer", {"fixed_delay": {"delay": float(delay)}}).save("model.json")
        words = ["model.json", "--temperature-lsb", "2", "--force", "-o", "out", "--json", "out.json"]
        monkeypatch.setattr(sys, "argv", ["echocal", "firmware", *words])
        with pytest.raises(SystemExit):
            main()
        told = re.search(r"([0-9.]+) mm at most, up to 4 m", capsys.readouterr().err)
        header = re.search(r"at most ([0-9.]+) mm \(requested", Path("out", HEADER).read_text())
        assert told is not None
        assert header is not None
        proven = json.loads(Path("out.json").read_text())["error_proven_m"] * 1e3
        assert float(told[1]) == float(header[1])
        assert proven <= float(told[1]) < proven + 1.01e-4
        below += float(f"{proven:.4f}") < proven
    assert below, "some of these would have been rounded down"


def test_the_versions_are_macros(tmp_path: Path) -> None:
    made = generated()
    made.save(tmp_path)
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "echocal_correction.h"\nint main(void)\n{\n'
        '    printf("%d %s %s %08lx\\n", ECHOCAL_INTERFACE_VERSION, ECHOCAL_GENERATOR_VERSION,\n'
        "        ECHOCAL_MODEL_HASH, (unsigned long)ECHOCAL_MODEL_ID);\n    return 0;\n}\n"
    )
    run("gcc", "-std=c99", *STRICT, f"-I{tmp_path}", tmp_path / "main.c", "-o", tmp_path / "main")
    model = fitted().hash
    assert run(tmp_path / "main").split() == ["2", made.report["provenance"]["version"], model, model[:8]]
