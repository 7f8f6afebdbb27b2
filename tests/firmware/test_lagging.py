"""A thermometer that lags: the recursion against real numbers and simulated air, the C against its twin."""

import functools
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_misra import findings
from toolchain import STRICT, run

from echocal import Model
from echocal.cli import main
from echocal.errors import UsageError
from echocal.lagging import Follower, LagFirmware, generate_lagging

WARM = (0.0625, -20.0, 60.0)
DELAY = {"fixed_delay": {"delay": 31e-6}}
NONE = -(2**31)
EACH = """
#include <stdio.h>
#include "echocal_air.h"
int main(void)
{
    static echocal_air_state state;
    int code;
    while (scanf("%d", &code) == 1) {
        printf("%ld\\n", (long)echocal_air_code(&state, (int16_t)code));
    }
    return 0;
}
"""


def model(lag: float = 240.0, **more: Any) -> Model:
    return Model("cramer", {"temperature_lag": {"time_constant": lag}, **DELAY, **more})


@functools.cache
def made(interval: float = 10.0, smoothing: float | None = None) -> LagFirmware:
    return generate_lagging(model(), interval, temperature=WARM, lag_smoothing=smoothing)


def sequences(follower: Follower, random: np.random.Generator) -> list[list[int]]:
    """Codes that jump between the ends, jump anywhere, and wander."""
    first, last, count = follower.first, follower.last, 3_000
    jumps = random.choice([first, last], count)
    anywhere = random.integers(first, last + 1, count)
    steps = random.integers(-3, 4, count).cumsum() + (first + last) // 2
    slow = np.repeat(random.integers(first, last + 1, 30), 100)
    return [one.tolist() for one in (jumps, anywhere, steps.clip(first, last), slow)]


FOLLOWERS = [
    Follower(-320, 960, 240.0, 10.0, 60.0),
    Follower(-320, 960, 3600.0, 5.0, 900.0),
    Follower(0, 4095, 60.0, 1.0, 20.0),
    Follower(0, 65_535, 600.0, 60.0, 60.0),
    Follower(-20, 60, 300.0, 2.0, 100.0),
]


@pytest.mark.parametrize("follower", FOLLOWERS)
def test_every_sequence_is_within_the_bound(follower: Follower, random: np.random.Generator) -> None:
    follower.refuse_times()
    follower.refuse_wide()
    worst = 0.0
    for codes in sequences(follower, random):
        for air, exact in zip(follower.outputs(codes), follower.exact(codes), strict=True):
            if air == NONE:
                assert not follower.first + 1 <= exact <= follower.last - 1
            else:
                worst = max(worst, abs(air - exact))
    assert 0.3 * follower.error() < worst <= follower.error()


@pytest.mark.parametrize("follower", FOLLOWERS)
def test_no_integer_leaves_32_bits(follower: Follower) -> None:
    gap = (follower.last - follower.first) << follower.places
    move = (gap >> follower.drop) * follower.share
    lead = (move >> (16 - follower.drop) >> follower.lead_drop) * follower.ratio
    assert max(gap, move, lead + (1 << follower.lead_shift >> 1)) < 2**32
    assert follower.share < 2**16
    assert follower.ratio < 2**16


def test_air_that_steps_is_followed_in_the_shorter_time() -> None:
    """A thermometer in air that gets 20 K warmer: after 60 s the output has 63 % of it, without it 22 %."""
    lag, smoothing, interval = 240.0, 60.0, 2.0
    follower = Follower(-320, 960, lag, interval, smoothing)
    time = np.arange(0.0, 600.0, interval)
    read = 10.0 + 20.0 * -np.expm1(-time / lag)
    air = np.array(follower.outputs(np.round(read / 0.0625).astype(int).tolist())) * 0.0625
    expected = 10.0 + 20.0 * -np.expm1(-time / smoothing)
    # the middle of an interval stands for it, and a rounded code is amplified four times at most
    assert np.abs(air - expected).max() <= 20.0 * interval / smoothing / 2 + 4.5 * 0.0625 / 2 + 0.04
    assert np.abs(read - expected).max() > 9.0


def test_air_that_gets_warmer_steadily_is_behind_by_the_shorter_time() -> None:
    lag, smoothing, interval, rate = 240.0, 60.0, 10.0, 0.01
    time = np.arange(0.0, 3000.0, interval)
    air = rate * time
    read = rate * (time - lag * -np.expm1(-time / lag))
    follower = Follower(-320, 960, lag, interval, smoothing)
    found = np.array(follower.exact((read / 0.0625).tolist())) * 0.0625
    assert np.abs((air - found)[-50:] - rate * smoothing).max() < 1e-3


@pytest.mark.parametrize(("interval", "smoothing"), [(10.0, None), (1.0, 30.0), (60.0, 60.0)])
def test_the_c_has_every_bit_of_its_twin(
    interval: float, smoothing: float | None, tmp_path: Path, random: np.random.Generator
) -> None:
    packed = made(interval, smoothing)
    packed.save(tmp_path)
    (tmp_path / "each.c").write_text(EACH)
    command = ("gcc", "-std=c99", "-O2", *STRICT, "-fsanitize=undefined", "-fno-sanitize-recover=all")
    run(*command, f"-I{tmp_path}", tmp_path / "each.c", tmp_path / "echocal_air.c", "-o", tmp_path / "each")
    golden = [line.split(",") for line in packed.files["echocal_air_golden.csv"].splitlines()[1:]]
    for codes in [[int(code) for code, _ in golden], *sequences(packed.follower, random)]:
        lines = run(tmp_path / "each", text="\n".join(map(str, codes))).split()
        assert [int(line) for line in lines] == packed.follower.outputs(codes)
    assert [int(air) for _, air in golden] == packed.follower.outputs([int(code) for code, _ in golden])
    assert len(golden) == 256
    assert NONE in {int(air) for _, air in golden}


def test_the_c_keeps_the_rules(tmp_path: Path) -> None:
    found = {check for _, check in findings(made(), tmp_path, "echocal_air.c")}
    assert found <= {"2.5", "15.5", "8.7"}


def test_files_state_what_is_proven() -> None:
    packed = made()
    header, lag = packed.files["echocal_air.h"], packed.report["temperature_lag"]
    assert "a time constant of 240 s" in header
    assert lag["smoothing_s"] == 60.0
    assert lag["error_proven_K"] == pytest.approx(lag["error_proven_codes"] * 0.0625)
    assert lag["error_m"] < 0.6e-3
    assert not any("temperature_lag" in line for line in packed.report["assumptions"])
    assert lag["model_hash"] == model().hash


def test_the_distance_follows_air_that_gets_warmer() -> None:
    """Through both functions: 0.005 K/s for 20 minutes, at 3 m. Without the state 1.2 K are 6 mm."""
    packed, lag = made(), 240.0
    time = np.arange(0.0, 1200.0, 10.0)
    air = 10.0 + 0.005 * time
    read = 10.0 + 0.005 * (time - lag * -np.expm1(-time / lag))
    codes = np.round(read / 0.0625).astype(int)
    of_air = Model("cramer", DELAY)
    echo = np.round(np.asarray(of_air.time_of_flight(3.0, temperature=air)) * 1e6).astype(int)
    found = packed.distance_um(echo, np.array(packed.follower.outputs(codes.tolist()))) * 1e-6
    late = packed.distance_um(echo, codes) * 1e-6
    assert np.abs(found - 3.0)[60:].max() < 2.5e-3
    assert np.abs(late - 3.0)[60:].max() > 5e-3


def test_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    model().save("MODEL.json")

    def ran(*words: str) -> int:
        monkeypatch.setattr(sys, "argv", ["echocal", "firmware", "MODEL.json", *words])
        with pytest.raises(SystemExit) as stopped:
            main()
        return int(stopped.value.code or 0)

    assert ran("--temperature-lsb", "0.5", "--lag-interval-s", "10", "-o", "made") == 0
    assert "240 s of the thermometer, 60 s left" in capsys.readouterr().err.replace("\n", " ")
    report = json.loads(Path("made/report.json").read_text())
    assert report["temperature_lag"]["interval_s"] == 10.0
    assert "--lag-interval-s 10" in report["provenance"]["command"]
    assert ran("--lag-smoothing-s", "10", "-o", "other") == 2
    assert "needs --lag-interval-s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"lag_interval": 0.0}, "give 0 < lag_interval"),
        ({"lag_smoothing": 300.0}, "give 0 < lag_interval"),
        ({"lag_interval": 1e-4}, "too often for a time constant"),
        ({"package": "arduino"}, "keeps no state of a thermometer"),
        ({"model": Model("cramer")}, "no effect temperature_lag"),
        ({"temperature": (0.0625, 0.0, 60.0, 0.0, 2)}, "of which no bit is dropped"),
        ({"model": model(temperature_gain={"gain": 0.01})}, "not the same as air that is 1 K"),
    ],
)
def test_refusals(request_: dict[str, Any], message: str) -> None:
    usual: dict[str, Any] = {"model": model(), "lag_interval": 10.0, "temperature": WARM}
    with pytest.raises(UsageError, match=message):
        generate_lagging(**{**usual, **request_})


def test_a_new_state_takes_the_thermometer_for_settled() -> None:
    follower = FOLLOWERS[0]
    assert follower.outputs([400] * 5) == [400] * 5
    assert follower.outputs([961, 400, 961, 400]) == [NONE, 400, NONE, 400], "a refused code changes nothing"
    assert math.isclose(follower.exact([0, 16])[1], 16 + 18 * 16 * follower.share / 2**16)
