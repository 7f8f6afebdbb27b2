"""Requests that make no sense, and data at the edge of sense: one clear answer, never a number."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import echocal
from echocal import DataError, Model, ModelError, UsageError
from echocal.cli import app
from echocal.observations.layout import Layout

CODES = (1.0, 0.0, 2.0)
TABLE = {"reading_m": [2.0] * 9, "temperature_C": np.arange(10.0, 19.0), "distance_m": [2.0] * 9}


def _calibrated() -> echocal.Calibration:
    data = echocal.read_observations(TABLE, reading_speed=343)
    return echocal.calibrate(data, Model("331.3+0.6*T"), fit=["zero_error.offset"])


REQUESTS: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "a date for a distance": (
        lambda: Model("linear").indicate(np.datetime64("2020-01-01"), temperature=20.0),  # type: ignore[arg-type]
        UsageError,
        r"the first argument must be real numbers, but has dtype datetime64\[D\]",
    ),
    "rows of several lengths": (
        lambda: Model("linear").indicate([[1.0, 2.0], [3.0]], temperature=20.0),  # type: ignore[list-item]
        UsageError,
        "the first argument is no array of numbers: .* inhomogeneous shape",
    ),
    "air in rows of several lengths": (
        lambda: echocal.domain_violations([20.0], [[0.1, 0.2], [0.3]]),  # type: ignore[list-item]
        UsageError,
        "relative_humidity is no array of numbers: .* inhomogeneous shape",
    ),
    "air with an imaginary part": (
        lambda: echocal.domain_violations([20.0 + 1j]),
        UsageError,
        "temperature must be real numbers, but has dtype complex128",
    ),
    "an integer that no float holds": (
        lambda: Model("linear").indicate([10**400], temperature=20.0),
        UsageError,
        "the first argument must be real numbers, but has dtype object",
    ),
    "a law that is no text": (
        lambda: echocal.domain_violations([20.0], law="\ud800"),
        ModelError,
        r"the law is '\\ud800'; give a name",
    ),
    "two laws in one": (
        lambda: echocal.distance(0.01, 20.0, law="cramer|linear"),
        ModelError,
        r"unknown law 'cramer\|linear'",
    ),
    "no law for a batch": (
        lambda: echocal.distance(0.01, 20.0, law=None),  # type: ignore[arg-type]
        ModelError,
        "the law is None; give a name",
    ),
    "a condition in words": (
        lambda: echocal.distance([0.01], 20.0, where="yes"),
        UsageError,
        "where must be true or false in each row, but has dtype <U3",
    ),
    "a condition in numbers": (
        lambda: echocal.distance([0.01], 20.0, where=[1]),
        UsageError,
        "where must be true or false in each row, but has dtype int64",
    ),
    "a speed in words": (
        lambda: echocal.error([1.0], 20.0, reading_speed=[343.0]),  # type: ignore[arg-type]
        UsageError,
        r"reading_speed is \[343.0\]; give a speed in m/s",
    ),
    "text for a temperature": (
        lambda: Model("linear").indicate([2.0], temperature="warm"),
        UsageError,
        "temperature must be real numbers, but has dtype <U4",
    ),
    "a misspelled condition": (
        lambda: Model("linear").indicate(2.0, temperatur=20.0),
        UsageError,
        "unknown influence quantity 'temperatur'; did you mean 'temperature'?",
    ),
    "a law that stands still": (
        lambda: Model("0"),
        ModelError,
        "law '0' is a speed of 0 m/s; give a positive",
    ),
    "no law": (lambda: Model(None), ModelError, "the law is None; give a name"),  # type: ignore[arg-type]
    "a parameter in words": (
        lambda: Model("linear", {"fixed_delay": {"delay": "long"}}),  # type: ignore[dict-item]
        ModelError,
        "fixed_delay.delay is 'long'; give a number",
    ),
    "no base": (lambda: echocal.diagnose(TABLE, base=None), ModelError, "the law is None"),  # type: ignore[arg-type]
    "a reference that is no number": (
        lambda: echocal.diagnose(TABLE, reference_distance=float("nan")),
        UsageError,
        "reference distance is nan m; give 0 < distance <= 100",
    ),
    "several references": (
        lambda: echocal.diagnose(TABLE, reference_distance=[2.0]),  # type: ignore[arg-type]
        UsageError,
        r"reference distance is \[2.0\] m",
    ),
    "columns as a list": (
        lambda: echocal.read_observations(TABLE, columns=["reading_m"]),  # type: ignore[arg-type]
        UsageError,
        "columns map names to what they hold",
    ),
    "what can vary as a list": (
        lambda: echocal.diagnose(TABLE, can_vary=["distance"]),  # type: ignore[arg-type]
        UsageError,
        "can_vary maps conditions to two ends",
    ),
    "effects as a list": (lambda: Model("linear", ["humidity"]), ModelError, "effects map an id to its"),  # type: ignore[arg-type]
    "humidity of 50": (
        lambda: Model("linear", air={"relative_humidity": 50.0}),
        ModelError,
        r"air.relative_humidity is 50, outside 0 .. 1 \[1\]",
    ),
    "humidity in words": (
        lambda: Model("linear", air={"relative_humidity": "dry"}),  # type: ignore[dict-item]
        ModelError,
        "air.relative_humidity is 'dry'; give a finite number",
    ),
    "a speed that no reading was made with": (
        lambda: echocal.read_observations(TABLE, reading_speed="331-20*T"),
        DataError,
        "the speed '331-20.T': it is -9 m/s at row 8",
    ),
    "a speed that is none, where it is not needed": (
        lambda: echocal.read_observations({"echo_us": [11660.0]}, reading_speed="banana"),
        ModelError,
        "unknown law 'banana'",
    ),
    "two characters for a comma": (lambda: Layout(decimal=",,"), UsageError, "neither '.' nor ','"),
    "lines before the first": (lambda: Layout(skip_lines=-1), UsageError, "skip_lines is -1"),
    "a negative seed": (
        lambda: echocal.diagnose(TABLE, seed=-1),
        UsageError,
        "seed is -1; give an integer of 0 or more",
    ),
    "reading a table that is read": (
        lambda: echocal.diagnose(echocal.read_observations(TABLE), reading_speed="343"),
        UsageError,
        "reading_speed is an argument for reading a table; pass it to read_observations",
    ),
    "reading observations for a verification": (
        lambda: echocal.verify(echocal.read_observations(TABLE), maximum_permissible_error=1.0, decimal=","),
        UsageError,
        "decimal is an argument for reading a table; pass it to read_observations",
    ),
    "colder than cold": (
        lambda: echocal.sweep("linear", temperature=-300.0),
        UsageError,
        "temperature: -300 is below -273.15",
    ),
    "a distance behind the sensor": (
        lambda: echocal.sweep("linear", temperature=20.0, distance=[-1.0, 1.0]),
        UsageError,
        "distance: -1 is below 0",
    ),
    "codes below absolute zero": (
        lambda: echocal.firmware.generate(Model("linear"), temperature=(1.0, -300.0, 0.0)),
        UsageError,
        "temperature -300 degC is below absolute zero",
    ),
    "half an echo": (
        lambda: echocal.firmware.generate(Model("linear"), temperature=CODES, echo=2.5),  # type: ignore[arg-type]
        UsageError,
        "echo is 2.5; give a whole number",
    ),
    "fewer threads than none": (
        lambda: echocal.firmware.generate(Model("linear"), temperature=CODES, n_threads=-1),
        UsageError,
        "n_threads is -1; give a whole number of 1",
    ),
    "threads that are true": (
        lambda: echocal.firmware.generate(Model("linear"), temperature=CODES, n_threads=True),
        UsageError,
        "n_threads is True; give a whole number of 1",
    ),
    "true threads of a function": (
        lambda: echocal.speed_of_sound([20.0], n_threads=True),
        UsageError,
        "n_threads is True; give 1 or more, or None for every processor",
    ),
    "a file where a model is due": (
        lambda: echocal.firmware.generate("model.json"),  # type: ignore[arg-type]
        UsageError,
        r"firmware needs a Model, got str; Model.load\(path\) reads a file",
    ),
    "a law where a model is due": (
        lambda: echocal.calibrate(echocal.read_observations(TABLE), "cramer", fit=["zero_error"]),  # type: ignore[arg-type]
        UsageError,
        r"calibrate begins with a Model, got 'cramer'; Model\('cramer'\), or Model.load\(path\)",
    ),
    "codes in words": (
        lambda: echocal.firmware.generate(Model("linear"), temperature="fine"),  # type: ignore[arg-type]
        UsageError,
        r"temperature is 'fine'; give TemperatureCodes\(lsb, low, high, zero, shift\), or the numbers",
    ),
    "too many numbers of an echo": (
        lambda: echocal.firmware.generate(Model("linear"), echo=(1, 2, 3, 16, 5)),
        UsageError,
        r"echo is \(1, 2, 3, 16, 5\); give EchoCodes\(lsb, longest, shortest, bits\), or the numbers",
    ),
    "assumptions as a list": (
        lambda: echocal.firmware.generate(Model("linear"), assume=["pressure"]),  # type: ignore[arg-type]
        UsageError,
        "assume maps conditions to values",
    ),
    "a degree below nothing": (
        lambda: echocal.Regression.polynomial("temperature", -1),
        UsageError,
        "degree is -1; give a whole number of 0 or more",
    ),
    "a bound in words": (
        lambda: echocal.verify_model("linear", maximum_permissible_error="3", temperature=20.0, distance=1.0),  # type: ignore[arg-type]
        UsageError,
        r"must be a positive length \[m\], got '3'",
    ),
    "a prediction without temperature": (
        lambda: _calibrated().predict(distance=1.0),
        DataError,
        r"law '331.3\+0.6\*T' needs temperature \[degC\], which is not given",
    ),
    "a prediction without distance": (
        lambda: _calibrated().predict(temperature=20.0),
        DataError,
        "the prediction needs distance, which is not given",
    ),
    "a prediction at a word": (
        lambda: _calibrated().predict(distance="far", temperature=20.0),
        UsageError,
        "distance must be real numbers",
    ),
    "a prediction of two shapes": (
        lambda: _calibrated().predict(distance=[1.0, 2.0], temperature=[1.0, 2.0, 3.0]),
        UsageError,
        r"shapes do not broadcast: distance \(2,\), temperature \(3,\)",
    ),
    "assumed humidity of 50": (
        lambda: echocal.firmware.generate(
            Model("linear"), temperature=CODES, assume={"relative_humidity": 50.0}
        ),
        ModelError,
        "air.relative_humidity is 50, outside 0",
    ),
    "assuming what is measured": (
        lambda: echocal.firmware.generate(Model("linear"), temperature=CODES, assume={"temperature": 20.0}),
        UsageError,
        "temperature is measured: it cannot be assumed",
    ),
}


@pytest.mark.parametrize("case", REQUESTS)
def test_requests(case: str) -> None:
    request, error, message = REQUESTS[case]
    with pytest.raises(error, match=message) as caught:
        request()
    assert "\n" not in str(caught.value)


def test_codes_of_the_twin_are_whole() -> None:
    made = echocal.firmware.generate(Model("linear"), temperature=CODES)
    with pytest.raises(UsageError, match="echo_us must be integer codes, but has dtype float64"):
        made.distance_um(1.5, 0)
    with pytest.raises(UsageError, match=r"do not broadcast: echo_us \(2,\), temperature_code \(3,\)"):
        made.distance_um([1, 2], [0, 1, 2])


def test_what_is_masked_was_not_measured() -> None:
    speed = echocal.speed_of_sound(np.ma.array([20.0, 30.0], mask=[False, True]))
    assert np.ma.getmaskarray(speed).tolist() == [False, True]
    distance = np.ma.array([1.0, 2.0], mask=[False, True])
    assert np.isnan(Model("linear").indicate(distance, temperature=20.0)).tolist() == [False, True]
    with pytest.warns(echocal.DataWarning, match="echo_us has no value in 1 row, first at row 2"):
        data = echocal.read_observations({"echo_us": np.ma.array([11660.0, 11660.0], mask=[0, 1])})
    assert data.usable.tolist() == [True, False]


@pytest.mark.parametrize("content", ["[" * 100_000, '{"schema": ' + "9" * 5000 + "}"])
def test_files_that_are_no_model(content: str, tmp_path: Path) -> None:
    (tmp_path / "model.json").write_text(content)
    with pytest.raises(ModelError, match=r"model\.json: is no model: "):
        Model.load(tmp_path / "model.json")


def test_a_model_file_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    Model("linear").save(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert Model.load(path).law == "linear"


def test_times_with_an_offset_bound_the_window() -> None:
    time = np.datetime64("2024-01-01T00:00") + np.arange(40) * np.timedelta64(1, "m")
    table = {**{name: np.resize(column, 40) for name, column in TABLE.items()}, "time": time}
    table["reading_m"] = 2.0 + 1e-3 * np.sin(np.arange(40.0) ** 2)
    found = echocal.diagnose(table, since="2024-01-01T02:10+02:00", until="2024-01-01T00:29Z")
    assert found.rows["used"] == 20
    with pytest.raises(UsageError, match="'now' is not an ISO 8601 time"):
        echocal.diagnose(table, since="now")


def test_a_window_without_rows_is_refused() -> None:
    time = np.datetime64("2024-01-01T00:00") + np.arange(9) * np.timedelta64(1, "h")
    with pytest.raises(UsageError, match="the first time is the later one"):
        echocal.diagnose({**TABLE, "time": time}, since="2024-01-03", until="2024-01-02")
    with pytest.raises(
        UsageError, match=r"no row is in the requested period \(2030-01-01 .. \); the rows: 2024"
    ):
        echocal.diagnose({**TABLE, "time": time}, since="2030-01-01")


def test_data_without_noise_are_diagnosed() -> None:
    temperature = np.linspace(0.0, 40.0, 30)
    reading = 2.0 * 343.0 / (331.4 + 0.6 * temperature)
    found = echocal.diagnose({"reading_m": reading, "temperature_C": temperature}, reference_distance=2.0)
    assert (found.verdict, found.causes[0].id) == ("named", "fixed_speed")
    perfect = echocal.diagnose(
        {"reading_m": np.full(30, 2.0), "temperature_C": temperature}, reference_distance=2.0
    )
    assert perfect.verdict == "nothing"


def test_a_speed_as_a_number_is_a_base() -> None:
    table = {name: np.resize(column, 40) for name, column in TABLE.items()}
    assert echocal.diagnose(table, base=343).base == echocal.diagnose(table, base="343").base


def test_one_text_may_stand_for_a_list_of_one() -> None:
    assert len(echocal.read_observations(TABLE, trust="temperature_C")) == 9
    model = Model("cramer", {"temperature_gradient": {"gradient": 0.1}})
    assert echocal.firmware.generate(model, temperature=CODES, echo=900, accept="temperature_gradient").files


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--reference-join", "nearest"], "--reference-join nearest does nothing without --reference"),
        (["--plot-format", "svg"], "--plot-format svg does nothing without --plots"),
        (["--memory", "1GB"], "--memory is for a fleet"),
        (["again.csv", "--details"], "--details is for one table, and several are given"),
    ],
)
def test_an_option_that_would_do_nothing_is_refused(
    options: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("log.csv", "again.csv"):
        Path(name).write_text("reading_m,distance_m,temperature_C\n1.0,1.0,20\n2.0,2.0,20\n")
    done = CliRunner().invoke(app, ["diagnose", "log.csv", *options])
    assert isinstance(done.exception, echocal.UsageError)
    assert says in str(done.exception)


def test_what_a_model_needs_is_asked_for_as_the_caller_gives_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("reading_m,distance_m\n1.0,1.0\n2.0,2.0\n")
    words = ["budget", "log.csv", "--law", "cramer", "--reading-speed", "343", "--uncertainty", "timer_us=4"]
    told = str(CliRunner().invoke(app, words).exception)
    assert '--column "NAME=temperature_C"' in told
    assert '--at "temperature_C=20+-2"' in told
    assert "Model(" not in told
    with pytest.raises(DataError, match=r"pass temperature=\.\.\., or assume a value with Model\(air="):
        Model("cramer").distance(0.01)


@pytest.mark.filterwarnings("error")
def test_a_log_in_another_unit_is_refused_without_a_warning() -> None:
    table = {"reading_m": [1003.0, 1504.0, 2003.0], "temperature_C": [20.0] * 3}
    with pytest.raises(DataError, match=r"as reading_mm 1\.504 m"):
        echocal.correct(table, Model("linear"))
