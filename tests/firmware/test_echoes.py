"""Which echo times are accepted: what an HC-SR04 measures, and no time-out."""

import itertools
import json
import re
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_command import run
from toolchain import answers, build

from echocal import Model, UsageError, firmware
from echocal.errors import DomainWarning
from echocal.firmware import EchoCodes

OUT_OF_RANGE = -(2**31)
HALF_DEGREES = (0.5, -20.0, 60.0)
NO_PULSE, TIME_OUTS = 0, (36_000, 38_000)  # us
MODELS = {
    "dry": Model("cramer"),
    "delay": Model("cramer", {"fixed_delay": {"delay": 31e-6}}),
    "falling": Model("320-0.5*T"),
    "bent": Model("cramer", {"amplitude_walk": {"delay": 20e-6, "threshold": 0.6}}),
}


def codes(made: firmware.Firmware) -> tuple[int, int]:
    found = made.report["device"]["echo"]["codes"]
    return found["minimum"], found["maximum"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "tick"),
    [*itertools.product(("dry", "delay", "falling"), (0.5, 1.0, 4.0)), ("bent", 4.0)],
)
def test_what_the_sensor_measures_is_accepted_and_hardly_more(name: str, tick: float) -> None:
    """At 20 mm and at 4 m, in every condition; the codes next to the ends stand for no such echo."""
    made = firmware.generate(MODELS[name], temperature=HALF_DEGREES, echo=EchoCodes(tick), max_error=2e-3)
    first, last = codes(made)
    warm = np.arange(-20.0, 60.5, 0.5)

    def distances(code: int) -> np.ndarray:
        return np.asarray(MODELS[name].distance(code * tick * 1e-6, temperature=warm, pressure=101_325.0))

    assert (distances(first) <= 0.020 + 1e-9).all()
    assert not (distances(first + 1) <= 0.020).all()
    assert (distances(last) >= 4.0 - 1e-9).all()
    assert not (distances(last - 1) >= 4.0).all()


def test_no_pulse_and_a_time_out_are_no_distance(tmp_path: Path) -> None:
    """They were -5.4 mm and 6.5 m."""
    made = firmware.generate(MODELS["delay"], temperature=HALF_DEGREES)
    inputs = [(echo, code) for echo in (NO_PULSE, *TIME_OUTS) for code in (-40, 40, 120)]
    assert set(answers(build(made, tmp_path), inputs)) == {OUT_OF_RANGE}
    assert set(made.distance_um(*np.transpose(inputs)).tolist()) == {OUT_OF_RANGE}
    with pytest.warns(DomainWarning) as told:
        once = firmware.generate(MODELS["delay"], temperature=HALF_DEGREES, echo=EchoCodes(1.0, 38_000, 0))
    without = [str(it.message) for it in told if "an echo time of 0 us is accepted" in str(it.message)]
    assert len(without) == 1
    assert int(once.distance_um(NO_PULSE, 40)) < -5_000
    assert int(once.distance_um(38_000, 40)) > 6_500_000


def test_an_echo_max_at_the_time_out_is_kept_and_told_of() -> None:
    with pytest.warns(
        DomainWarning, match="38000 us are accepted: the time-out pulse of an SRF04 or HC-SR04"
    ):
        made = firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, echo=38_000)
    assert codes(made) == (109, 38_000)


def test_a_distance_beyond_the_time_out_is_left_out_and_told_of() -> None:
    with pytest.warns(
        DomainWarning, match="echo times end at 35000 us, before the requested largest distance"
    ):
        made = firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, max_distance=8.0)
    assert codes(made)[1] == 35_000


def test_a_default_ends_where_a_16_bit_timer_does() -> None:
    """The echo max of 35,000 us was blamed on a user who gave none."""
    with pytest.warns(DomainWarning, match=r"a 16-bit timer with a tick of 0.5 us ends there") as told:
        made = firmware.generate(
            MODELS["dry"], temperature=HALF_DEGREES, echo=EchoCodes(0.5), max_distance=8.0
        )
    assert codes(made)[1] == 65_535
    message = str(told[0].message)
    assert message.startswith(
        "echo times end at 32767.5 us, before the requested largest distance: the echo from 8 m"
    )
    farthest = float(MODELS["dry"].distance(32_767.5e-6, temperature=-20.0))
    assert f"all are accepted up to {np.floor(farthest * 100) / 100:g} m; " in message


@pytest.mark.filterwarnings("error")
def test_a_coarse_tick_rounds_no_default_up_to_a_time_out() -> None:
    """58 us is the tick of a timer that counts centimeters."""
    far = float(MODELS["dry"].distance(34_970e-6, temperature=-20.0))
    made = firmware.generate(
        MODELS["dry"], temperature=HALF_DEGREES, echo=EchoCodes(58.0), max_distance=far, max_error=5e-3
    )
    assert codes(made)[1] * 58 == 34_974
    farther = float(MODELS["dry"].distance(34_990e-6, temperature=-20.0))
    with pytest.raises(
        DomainWarning, match="echo times end at 34974 us, before the requested largest distance"
    ):
        firmware.generate(
            MODELS["dry"],
            temperature=HALF_DEGREES,
            echo=EchoCodes(58.0),
            max_distance=farther,
            max_error=5e-3,
        )


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (
            {"max_distance": 0.015},
            "the largest distance, 0.015 m, is nearer than 0.02 m, the blanking distance",
        ),
        ({"echo": EchoCodes(0.001)}, "no echo from 0.02 m or more is accepted: echo times end at 65.535 us"),
        ({"echo": EchoCodes(0.5, None, 33_000)}, "echo min 33000 us leaves no echo: give a shorter one"),
        (
            {"echo": EchoCodes(1.0, None, 15_000), "max_distance": 2.0},
            "echo min 15000 us leaves no echo: give a shorter one, or an echo max; the echo from the largest",
        ),
        ({"echo": EchoCodes(1e3), "max_distance": 0.1}, "a tick of 1000 us is too coarse"),
        ({"echo": EchoCodes(4e4)}, "a tick of 40000 us is longer than any echo, 35000 us"),
    ],
)
def test_no_default_is_blamed_on_the_user(request_: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)) as told:
        firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, **request_)
    assert "35000 us is code" not in str(told.value)


@pytest.mark.parametrize("name", ["dry", "bent"])
def test_nothing_is_proven_over_no_inputs(name: str) -> None:
    """It was: an error of at most -0.0010 mm at the 0 inputs."""
    with pytest.raises(UsageError, match="no distance is left to bound") as told:
        firmware.generate(
            MODELS[name], temperature=(1, -20, 60), echo=EchoCodes(1.0, 25_000, 15_000), max_distance=2.0
        )
    assert "the shortest echo that is accepted, 15000 us, is one from 2.3" in str(told.value)
    assert "the largest bounded distance is 2 m: give a shorter echo min (--echo-min-us" in str(told.value)


def test_where_warm_air_has_no_bounded_input_the_worst_is_a_real_one(tmp_path: Path) -> None:
    """15 ms are 2.39 m at -20 degC, 2.60 m at 25 degC and 2.74 m at 60 degC."""
    made = firmware.generate(
        MODELS["dry"], temperature=HALF_DEGREES, echo=EchoCodes(1.0, 25_000, 15_000), max_distance=2.6
    )
    worst = made.report["worst_input"]
    code = (worst["echo_us"], round(worst["temperature"] / 0.5))
    truth = float(MODELS["dry"].distance(code[0] * 1e-6, temperature=code[1] / 2))
    assert code[0] >= 15_000
    assert truth <= 2.6
    assert 0 < abs(int(made.outputs(*code)) * 1e-6 - truth) <= made.report["error_proven_m"] <= 0.5e-3
    assert f"\n{code[0]},{code[1]},{int(made.outputs(*code))},0\n" in made.files["echocal_golden.csv"]
    assert answers(build(made, tmp_path), [code]) == [int(made.outputs(*code))]


def test_a_sensor_with_a_longer_blanking_distance(tmp_path: Path) -> None:
    """A JSN-SR04T is deaf below some 25 cm."""
    made = firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, echo=EchoCodes(shortest=1_400))
    first, last = codes(made)
    assert first == 1_400
    inputs = [(echo, 40) for echo in (1_399, 1_400, last, last + 1)]
    refused = [distance == OUT_OF_RANGE for distance in answers(build(made, tmp_path), inputs)]
    assert refused == [True, False, False, True]


@pytest.mark.parametrize(
    ("echo", "message"),
    [
        (
            100,
            "echo max 100 us ends before the echo from 0.02 m, the nearest that an HC-SR04 measures, 109 us",
        ),
        (
            EchoCodes(1.0, 5_000, 5_000),
            "codes 5000 .. 5000: give an echo min of 0 or more, below the echo max",
        ),
        (EchoCodes(1.0, 5_000, -1.0), "codes -1 .. 5000: give an echo min of 0 or more, below the echo max"),
        (EchoCodes(1.0, 5_000, float("nan")), "give an echo min of 0 or more, below the echo max"),
        (EchoCodes(0.25, 20_000), "us is code 80000 of LSB 0.25 us: it is outside 1 .. 65535"),
        (EchoCodes(0.0), "echo LSB 0 us is no tick of a timer"),
        ((1.0, 5_000.0, None), "give EchoCodes(lsb, longest, shortest, bits), or the numbers as a tuple"),
    ],
)
def test_echo_codes_that_make_no_sense(echo: Any, message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)) as told:
        firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, echo=echo)
    assert "\n" not in str(told.value)


def test_the_command_takes_both_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    MODELS["dry"].save("model.json")
    words = ("model.json", "--temperature-lsb", "0.5", "-o", "made")
    monkeypatch.setenv("COLUMNS", "400")
    assert run(monkeypatch, *words, "--echo-max-us", "38000") == 0
    assert "note" in (told := capsys.readouterr().err)
    assert "is then returned as a distance of 6.2 to 6.5 m" in told
    assert run(monkeypatch, *words, "--echo-min-us", "1400", "--echo-max-us", "9000") == 0
    assert "note" not in capsys.readouterr().err
    report = json.loads(Path("made/report.json").read_text())
    assert report["device"]["echo"]["codes"] == {"minimum": 1_400, "maximum": 9_000}
    assert "--echo-min-us 1400 --echo-max-us 9000" in report["provenance"]["command"]
    assert run(monkeypatch, *words, "--echo-min-us", "9000", "--echo-max-us", "1400") == 2
    assert "give an echo min of 0 or more, below the echo max" in " ".join(capsys.readouterr().err.split())


def test_finding_the_ends_can_be_interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over 328,000 conditions it takes some tenths of a second, and an interrupt had to wait for the end."""
    ended: list[float] = []

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    def design(*_: object) -> None:
        ended.append(time.monotonic())

    monkeypatch.setattr(firmware._core, "design_firmware", design)
    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(KeyboardInterrupt):
            firmware.generate(MODELS["dry"], humidity=(1 / 255, 0.0, 1.0))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert not ended, "it ran on to the design"
