"""Which echo times are accepted: what an HC-SR04 measures, and no time-out."""

import itertools
import json
import re
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
        DomainWarning, match="echo times end at 35000 us, before the largest distance asked for"
    ):
        made = firmware.generate(MODELS["dry"], temperature=HALF_DEGREES, max_distance=8.0)
    assert codes(made)[1] == 35_000


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
        (EchoCodes(0.25), "us is code 100286 of LSB 0.25 us: it is outside 1 .. 65535"),
        (EchoCodes(0.0), "echo LSB 0 us is no tick of a timer"),
        ((1.0, 5_000.0, None), "give EchoCodes(lsb, longest, shortest), or the numbers as a tuple"),
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
