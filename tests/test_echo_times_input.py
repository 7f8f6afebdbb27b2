"""What cannot be timed: an error that says how to go on, or a capture with a reason; nothing is dropped."""

from typing import Any

import numpy as np
import pytest
from made_echoes import Echo, captures

import echocal
from echocal.waveforms import ECHO_STATUSES, model_burst

RATE, COUNT = 500e3, 3500
ZEROS = np.zeros((2, COUNT))


@pytest.fixture(scope="module")
def echo() -> Echo:
    return Echo()


@pytest.mark.parametrize(
    ("waveform", "options", "error", "words"),
    [
        (ZEROS, {"method": "magic"}, echocal.UsageError, "method is 'magic'; there are threshold, envelope,"),
        (ZEROS, {"sample_rate": 79e3}, echocal.UsageError, "sample_rate is 79000 Hz, too low for a carrier"),
        (ZEROS, {"sample_rate": 0.0}, echocal.UsageError, "sample_rate is 0.0; give a number above 0 [Hz]"),
        (ZEROS, {"sample_rate": "fast"}, echocal.UsageError, "sample_rate is 'fast'; give a number"),
        (ZEROS, {"carrier": -4e4}, echocal.UsageError, "carrier is -40000.0; give a number above 0 [Hz]"),
        (ZEROS, {"carrier": 240e3}, echocal.UsageError, "too low for a carrier of 240000 Hz"),
        (ZEROS, {"bandwidth": 50e3}, echocal.UsageError, "bandwidth is 50000 Hz; give at most the carrier"),
        (ZEROS, {"noise": 0.0}, echocal.UsageError, "noise is 0.0; give numbers above 0"),
        (
            ZEROS,
            {"noise": [1.0, 1.0, 1.0]},
            echocal.UsageError,
            "noise has the shape (3,), the captures (2,)",
        ),
        (ZEROS, {"threshold": -1.0}, echocal.UsageError, "threshold is -1.0; give numbers above 0"),
        (ZEROS, {"threshold": "low"}, echocal.UsageError, "threshold has the shape (), the captures (2,)"),
        (ZEROS, {"template": "median"}, echocal.UsageError, "template is 'median'; give samples,"),
        (ZEROS, {"template": np.ones(50)}, echocal.UsageError, "template is constant; give an echo"),
        (ZEROS, {"template": [[1.0, 2.0]]}, echocal.UsageError, "template has the shape (1, 2)"),
        (ZEROS, {"template": [0.0, np.nan, 1.0, 0.0]}, echocal.UsageError, "1 samples that are not finite"),
        (ZEROS, {"template": np.arange(9000.0)}, echocal.UsageError, "9000 samples, and a capture"),
        (ZEROS, {"template": "mean"}, echocal.UsageError, "and 0 captures have an echo"),
        (ZEROS, {"start": 5e-3, "stop": 4e-3}, echocal.UsageError, "the window is 0.005 .. 0.004 s"),
        (ZEROS, {"stop": 1.0}, echocal.UsageError, "and a capture 0 .. 0.007 s (3500 samples)"),
        (ZEROS, {"start": np.nan}, echocal.UsageError, "start is nan; give a time [s]"),
        (ZEROS, {"sample_rate": 1e15}, echocal.UsageError, "only 3500: too short; give longer captures"),
        (ZEROS, {"carrier": 1.0}, echocal.UsageError, "only 3500: too short; give longer captures"),
        (ZEROS, {"carrier": 3000.0}, echocal.UsageError, "only 3500: too short; give longer captures"),
        (ZEROS, {"bandwidth": 1e-9}, echocal.UsageError, "give at least 303 Hz, or longer captures"),
        (ZEROS, {"method": ["phase"]}, echocal.UsageError, "method is ['phase']; there are threshold"),
        (ZEROS, {"template": 1j * np.arange(50)}, echocal.UsageError, 'give samples, "mean" or None'),
        (ZEROS[:, :600], {}, echocal.UsageError, "only 600: too short; give longer captures"),
        (1j * ZEROS, {}, echocal.DataError, "waveform has the type complex128; give real numbers"),
        (ZEROS > 0, {}, echocal.DataError, "waveform has the type bool; give real numbers"),
        (3.0, {}, echocal.DataError, "waveform is one number"),
        ([[1.0, 2.0], [1.0]], {}, echocal.DataError, "captures of different lengths"),
        (["a", "b"], {}, echocal.DataError, "give real numbers"),
    ],
)
def test_a_request_that_cannot_be_met_says_what_to_give(
    waveform: Any, options: dict[str, Any], error: type[Exception], words: str
) -> None:
    with pytest.raises(error) as raised:
        echocal.echo_times(waveform, **{"sample_rate": RATE, **options})
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("method", ["matched_filter", "phase", "envelope", "threshold"])
def test_every_capture_has_a_row_and_a_reason(method: str, echo: Echo, random: np.random.Generator) -> None:
    made = captures(echo, np.full(8, 4e-3), RATE, COUNT) + 0.02 * random.standard_normal((8, COUNT))
    made[1, 7], made[2, 3000] = np.nan, -np.inf
    made[3] = 0.02 * random.standard_normal(COUNT)
    made[4] = 0.0
    made[5] = np.roll(made[5], -1900)  # the echo begins 0.2 ms after the capture
    made[6] = np.roll(made[6], 1400)  # and here it ends after it
    found = echocal.echo_times(made, RATE, method, **({"threshold": 0.3} if method == "threshold" else {}))
    told = ["", "not_finite", "not_finite", "no_echo", "no_echo", "noise_unknown", "cut_off", ""]
    assert list(found.reasons) == told
    for values in (found.time, found.standard_uncertainty, found.cycle_ambiguity):
        assert list(np.isfinite(values)) == [why == "" for why in told]
    assert list(found.found) == [why == "" for why in told]
    assert [ECHO_STATUSES[code] for code in found.status] == told


def test_an_early_echo_is_timed_where_the_noise_is_known(echo: Echo, random: np.random.Generator) -> None:
    made = captures(echo, np.array([2e-4]), RATE, COUNT) + 0.02 * random.standard_normal((1, COUNT))
    assert echocal.echo_times(made, RATE).reasons[0] == "noise_unknown"
    found = echocal.echo_times(made, RATE, noise=0.02)
    assert abs(found.time[0] - 2e-4) < 6.0 * found.standard_uncertainty[0]


def test_a_level_above_the_echo_is_not_reached(echo: Echo, random: np.random.Generator) -> None:
    made = captures(echo, np.full(2, 4e-3), RATE, COUNT, [0.5, 2.0])
    found = echocal.echo_times(made, RATE, "threshold", threshold=1.0, noise=1e-3)
    assert list(found.reasons) == ["below_threshold", ""]
    assert found.amplitude == pytest.approx([0.5, 2.0], rel=1e-3)


def test_masked_samples_are_no_samples(echo: Echo) -> None:
    made = np.ma.masked_array(captures(echo, np.full(2, 4e-3), RATE, COUNT), mask=False)
    made[1, 10] = np.ma.masked
    assert list(echocal.echo_times(made, RATE, noise=1e-3).reasons) == ["", "not_finite"]


def test_integers_and_single_precision_are_samples(echo: Echo) -> None:
    made = captures(echo, np.array([4e-3]), RATE, COUNT)
    truth = echocal.echo_times(made, RATE, noise=1e-3).time
    codes = np.round(2000.0 * made + 2048.0).astype(np.uint16)
    assert echocal.echo_times(codes, RATE, noise=0.3).time == pytest.approx(truth, abs=5e-9)
    assert echocal.echo_times(made.astype(np.float32), RATE, noise=1e-3).time == pytest.approx(
        truth, abs=1e-11
    )


def test_the_input_is_not_changed(echo: Echo) -> None:
    made = captures(echo, np.array([4e-3]), RATE, COUNT)
    made[0, 3] = np.nan
    before = made.copy()
    echocal.echo_times(made, RATE)
    assert np.array_equal(before, made, equal_nan=True)


def test_a_result_shows_itself(echo: Echo, random: np.random.Generator) -> None:
    made = captures(echo, np.full(3, 4e-3), RATE, COUNT) + 0.02 * random.standard_normal((3, COUNT))
    made[1] = np.nan
    found = echocal.echo_times(made, RATE)
    assert repr(found).startswith(
        "<Echo times by matched_filter: 2 of 3 captures; median standard uncertainty"
    )
    assert str(found).endswith("1 captures: not_finite")
    table = found.to_dataframe()
    assert list(table["capture"]) == [1, 2, 3]
    assert table["echo_us"][0] == pytest.approx(1e6 * found.time[0])
    assert len(found.plot().axes) == 1


def test_a_burst_of_other_transducers_is_a_template() -> None:
    wide, narrow = model_burst(RATE, quality_factor=5.0), model_burst(RATE, quality_factor=40.0)
    assert len(wide) < len(narrow)
    made = np.zeros(6000)
    made[3000 : 3000 + len(narrow)] = narrow
    found = echocal.echo_times(made, RATE, template=narrow, noise=1e-3)
    assert found.time == pytest.approx(6e-3, abs=1e-9)


@pytest.mark.parametrize("method", ["matched_filter", "phase", "envelope", "threshold"])
@pytest.mark.filterwarnings("error")
def test_captures_of_nothing_have_no_echo_and_no_warning(method: str) -> None:
    """Zeros, a converter's constant, and what is not finite."""
    captures = np.zeros((4, 3500))
    captures[1], captures[2], captures[3] = 3.3, np.inf, np.nan
    found = echocal.echo_times(captures, RATE, method)
    assert found.reasons.tolist() == ["no_echo", "no_echo", "not_finite", "not_finite"]
