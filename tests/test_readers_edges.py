"""Clocks, damaged lines, options, conditions that were not recorded: what a user sees."""

import json
from pathlib import Path

import numpy as np
import pytest
from realistic_logs import drawn, toa5
from realistic_logs_more import LOGS
from test_readers_logs import FIXED, Run, shell

import echocal
from echocal import DataError, UsageError

__all__ = ["shell"]


def _times(texts: list[str], **options: str) -> np.ndarray:
    table = {"echo_us": [11660.0] * len(texts), "time": texts}
    time = echocal.read_observations(table, **options).time  # type: ignore[arg-type]
    assert time is not None
    return time


def test_the_hour_that_comes_twice_is_told_by_the_order_of_rows() -> None:
    local = ["01:40", "02:00", "02:20", "02:40", "02:00", "02:20", "02:40", "03:00"]
    time = _times([f"2024-10-27T{clock}" for clock in local], time_zone="Europe/Copenhagen")
    assert np.diff(time).astype("timedelta64[m]").astype(int).tolist() == [20] * 7
    assert time[0] == np.datetime64("2024-10-26T23:40")


def test_a_clock_that_is_not_changed_stays_refused() -> None:
    local = ["01:40", "02:00", "02:20", "02:40", "03:00", "03:20"]
    with pytest.raises(DataError, match=r"clock change skips or repeats.*time_zone='Etc/GMT-1'"):
        _times([f"2024-10-27T{clock}" for clock in local], time_zone="Europe/Copenhagen")


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("31.05.2024 13:45", "2024-05-31T13:45"),
        ("31/05/2024 13:45:01", "2024-05-31T13:45:01"),
        ("5/31/2024 1:45 PM", "2024-05-31T13:45"),
        ("2024/05/31 13:45:00.5", "2024-05-31T13:45:00.5"),
        ("2024-05-31 13:45:00 UTC", "2024-05-31T13:45"),
        ("31-May-2024 13:45:00", "2024-05-31T13:45"),
        ("31.5.24 13:45", "2024-05-31T13:45"),
    ],
)
def test_dates_as_people_write_them(written: str, read: str) -> None:
    assert _times([written])[0] == np.datetime64(read)


def test_day_and_month_that_cannot_be_told_apart_are_asked_for() -> None:
    texts = ["03/04/2024 10:00", "03/04/2024 11:00"]
    with pytest.raises(DataError, match=r"time_format='%d/%m/%Y %H:%M:%S' or time_format='%m/%d/%Y"):
        _times(texts)
    assert _times(texts, time_format="%d/%m/%Y %H:%M")[0] == np.datetime64("2024-04-03T10:00")
    with pytest.raises(DataError, match="not written as"):
        _times(texts, time_format="%Y-%m-%d")


def test_a_damaged_line_is_a_row_with_a_reason(shell: Run, random: np.random.Generator) -> None:
    made = LOGS["corrupt_line"](drawn(random))
    Path(made.name).write_bytes(made.content)
    code, _, err = shell("diagnose", made.name, *FIXED, "-q", "--rows", "rows.csv")
    assert code == 0, err
    fates = [line.split(",")[1] for line in Path("rows.csv").read_text().splitlines()[1:]]
    assert fates[30] == "corrupt line"
    assert fates[20] == "reading_cm is no number"
    assert len(fates) == 80


def test_toa5_is_corrected_letter_for_letter(shell: Run, random: np.random.Generator) -> None:
    made = toa5(drawn(random))
    Path("roof.csv").write_bytes(made.content)
    code, _, err = shell("correct", "roof.csv", "-o", "out.csv", "--law", "linear", "--reading-speed", "343")
    assert code == 0, err
    before, after = made.content.decode().splitlines(), Path("out.csv").read_text().splitlines()
    assert len(before) == len(after)
    assert all(new.startswith(old) for old, new in zip(before, after, strict=True))
    assert after[1].endswith(",corrected_distance_m,distance_standard_uncertainty_m,status,unusable")
    assert after[2] == before[2] + ",,,,"
    assert "DT_Avg missing" in after[4 + 7]


def test_correct_refuses_what_it_cannot_keep_and_says_how(shell: Run, random: np.random.Generator) -> None:
    made = LOGS["serial_monitor"](drawn(random))
    Path("putty.csv").write_bytes(made.content)
    code, _, err = shell("correct", "putty.csv", "-o", "out.csv", "--reading-speed", "343")
    assert code == 3
    assert "make a table of it first: echocal inspect putty.csv --write table.csv" in err
    assert shell("inspect", "putty.csv", "--write", "table.csv", "-q")[0] == 0
    assert Path("table.csv").read_text().startswith("reading_cm,temperature_C,time_s\n")
    code, _, err = shell("correct", "table.csv", "-o", "out.csv", "--reading-speed", "343")
    assert code == 0, err


def test_options_are_written_taken_and_overruled(shell: Run, random: np.random.Generator) -> None:
    made = LOGS["epoch"](drawn(random))
    Path(made.name).write_bytes(made.content)
    assert shell("inspect", made.name, "-o", "log.toml", "-q")[0] == 0
    text = Path("log.toml").read_text()
    assert '"distance" = "reading_cm"  # a guess: ' in text
    Path("log.toml").write_text(f'constant-distance = true\nreading-speed = "343"\n{text}')
    code, out, err = shell("diagnose", made.name, "--options", "log.toml", "--json", "-")
    assert code == 0, err
    assert json.loads(out)["gain"]["rms_before_m"] < 3e-3
    flags = ["--column", "distance=reading_mm", "--trust", "distance", "-q"]
    code, _, err = shell("diagnose", made.name, "--options", "log.toml", *flags, "--json", "-")
    assert (code, err) == (0, "")
    code, out, err = shell("correct", made.name, "--options", "log.toml", "-o", "out.csv")
    assert code == 0, err
    Path("log.toml").write_text('colum = "x"\n')
    code, _, err = shell("diagnose", made.name, "--options", "log.toml")
    assert code == 2
    assert "unknown option 'colum'" in err


def test_inspect_tells_gaps_codes_and_sensors(shell: Run, random: np.random.Generator) -> None:
    truth = drawn(random)
    lines = ["time,sensor_id,Distance (cm),Temp (°C)"]
    for n, (when, (distance, temperature, _)) in enumerate(zip(truth.times(), truth.rows, strict=True)):
        reading = -9999 if n in {3, 9} else round(distance * 100, 2)
        if not 20 <= n < 35:
            lines.append(f"{when},{'ab'[n % 2]},{reading},{temperature}")
    Path("log.csv").write_text("\n".join(lines) + "\n")
    code, out, _ = shell("inspect", "log.csv", "-o", "log.toml", "--json", "-")
    found = json.loads(out)
    assert code == 0
    assert found["clock"]["gaps"] == 1
    assert found["clock"]["shown"] == ["row 21: 2.7 h after the row before"]
    assert found["sensors"] == {"sensor_id": 2}
    assert found["missing"] == {"Distance (cm)": ["-9999"]}
    code, out, _ = shell("inspect", "log.csv")
    assert code == 0
    assert "code -9999?" in " ".join(out.split()) or "-9999" in out
    code, out, err = shell(
        "diagnose", "log.csv", *FIXED, "--by", "sensor_id", "--options", "log.toml", "--json", "-"
    )
    assert code == 0, err
    assert len(json.loads(out)["tables"]) == 2


def test_a_stated_temperature_is_said_and_its_uncertainty_enters(
    shell: Run, random: np.random.Generator
) -> None:
    distance = random.uniform(0.5, 3.0, 200)
    reading = distance * 343.0 / 345.4 + 0.008 + random.normal(0.0, 1e-3, 200)
    rows = [f"{a:.4f},{b:.4f}" for a, b in zip(distance, reading, strict=True)]
    Path("c.csv").write_text("\n".join(["distance_m,reading_m", *rows]) + "\n")
    said = "the temperature is stated for all rows, not recorded: 20 +- 2 degC"
    at, exact = ["--at", "temperature=20+-2"], ["--at", "temperature=20"]
    fit = [
        "calibrate",
        "c.csv",
        "--fit",
        "reference_scale.scale",
        "--law",
        "linear",
        "--reading-speed",
        "343",
    ]
    wide, narrow = (json.loads(shell(*fit, *given, "--json", "-")[1]) for given in (at, exact))
    sizes = [found["parameters"][0]["standard_uncertainty"] for found in (wide, narrow)]
    assert sizes[0] == pytest.approx(np.hypot(sizes[1], 1.2 / 343.4), rel=0.05)  # 0.6 m/s for each kelvin
    assert any(note.startswith(said) for note in wide["notes"])
    code, out, err = shell("diagnose", "c.csv", "--reading-speed", "343", *at, "--json", "-")
    assert code == 0, err
    assert any(note.startswith(said) for note in json.loads(out)["notes"])
    code, out, _ = shell(
        "verify", "c.csv", "--maximum-permissible-error-mm", "40", "--reading-speed", "343", *at
    )
    assert said in out
    code, _, err = shell(
        "correct", "c.csv", "-o", "out.csv", "--reading-speed", "343", "--law", "linear", *at
    )
    assert code == 0
    assert said in err
    first = Path("out.csv").read_text().splitlines()[1].split(",")
    assert float(first[3]) == pytest.approx(float(first[2]) * 1.2 / 343.4, rel=0.02)


@pytest.mark.parametrize(
    ("at", "message"),
    [
        ({"temperature": "warm"}, "not a number"),
        ({"mood": 3}, "no such condition"),
        ({"temperature": 400}, "outside of"),
        ({"temperature_C": 20}, "the table has it in column 'temperature_C'"),
    ],
)
def test_conditions_that_cannot_be_are_refused(at: dict[str, object], message: str) -> None:
    table = {"echo_us": [11660.0] * 3}
    if "temperature_C" in at:
        table["temperature_C"] = [20.0] * 3
    with pytest.raises(UsageError, match=message):
        echocal.read_observations(table, at=at)


def test_a_log_on_stdin(shell: Run, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    import io

    made = LOGS["commonest"](drawn(random))

    class Stdin:
        buffer = io.BytesIO(made.content)

    monkeypatch.setattr("sys.stdin", Stdin())
    code, out, err = shell("diagnose", "-", *FIXED, "--json", "-")
    assert code == 0, err
    assert json.loads(out)["rows"]["used"] == 80


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"distance_cm": [100.0] * 3, "temperature_C": [20.0] * 3}, "columns={'distance_cm': 'reading_cm'}"),
        ({"Range (yd)": [3.1] * 3, "temperature_C": [20.0] * 3}, "a unit that echocal does not convert"),
        ({"level [m]": [1.2, 1.3, 1.25], "temperature_C": [20.0] * 3}, "columns={'level [m]': 'level_m'}"),
    ],
)
def test_what_may_be_two_things_is_asked_for(table: dict[str, list[float]], message: str) -> None:
    with pytest.raises(DataError, match=r".*") as refused:
        echocal.read_observations(table)
    assert message in str(refused.value)


def test_a_distance_beside_an_echo_time_is_not_taken() -> None:
    table = {"echo_us": [11660.0] * 3, "Distance (cm)": [200.0] * 3, "Temp (°C)": [20.0] * 3}
    data = echocal.read_observations(table)
    assert data.reading is None
    assert data.reference_distance is None
    assert any(
        "'Distance (cm)' is not used, it may be the reference or a reading" in note for note in data.notes
    )


def test_a_column_with_gaps_that_nobody_asked_for_costs_no_row() -> None:
    pressure = [1013.0] * 8 + [float("nan")] * 4
    table = {"echo_us": [11660.0] * 12, "Temp (°C)": [20.0] * 12, "Pressure (hPa)": pressure}
    data = echocal.read_observations(table)
    assert data.usable.all()
    assert "pressure" not in data.conditions
    assert any("to use it: columns={'Pressure (hPa)': 'pressure_hPa'}" in note for note in data.notes)
