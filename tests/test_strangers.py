"""What strangers tried: logs of other kinds, and files that are not what they seem."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.observations import read_observations

ROWS = 40


Cli = Callable[..., tuple[int, str]]


@pytest.fixture
def cli(run: Callable[..., tuple[int, str]]) -> Cli:
    """Run the command; what it says on one line."""

    def answered(*arguments: object) -> tuple[int, str]:
        code, said = run(*map(str, arguments))
        return code, " ".join(said.split())

    return answered


def table(random: np.random.Generator, rows: int = ROWS) -> pd.DataFrame:
    """Echoes of a device with a delay."""
    air, distance = random.uniform(5, 30, rows), random.choice([0.5, 1.2, 2.5], rows)
    echo = 2e6 * distance / echocal.speed_of_sound(air) + 40 + random.normal(0, 3, rows)
    time = pd.date_range("2024-05-14T22:00:00", periods=rows, freq="10min").strftime("%Y-%m-%dT%H:%M:%S")
    return pd.DataFrame(
        {"time": time, "echo_us": echo.round(1), "temperature_C": air.round(2), "distance_m": distance}
    )


def write(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "zone", "first"),
    [
        ("Date Time, GMT+02:00", "UTC", "2024-05-14T20:00:00"),
        ("Date Time, GMT-05:30", "UTC", "2024-05-15T03:30:00"),
        ("Date Time, GMT+02:00", "Asia/Tokyo", "2024-05-14T13:00:00"),
        ("time", "+02:00", "2024-05-14T20:00:00"),
    ],
)
def test_times_of_the_zone_that_is_said(
    name: str, zone: str, first: str, random: np.random.Generator
) -> None:
    found = read_observations(table(random).rename(columns={"time": name}), time_zone=zone)
    assert found.time is not None
    assert found.time[0] == np.datetime64(first)
    said = any("the times are those of UTC" in note for note in found.notes)
    assert said == (zone == "UTC")


def test_several_sensors_are_told(random: np.random.Generator) -> None:
    both = pd.concat([table(random).assign(sensor_id=name) for name in "AB"], ignore_index=True)
    said = " ".join(echocal.diagnose(both).notes)
    assert "column 'sensor_id' has 2 values (A, B), which may be as many sensors" in said
    assert "by='sensor_id'" in said
    said = " ".join(echocal.diagnose(both, columns={"sensor_id": "extra"}).notes)
    assert "may be as many sensors" not in said


@pytest.mark.parametrize("lines", [["$SDDPT,1.85,0.0*6B"], ["$SDXDR,D,1.85,M*6B", "$YXMTW,17.9,C*1D"]])
def test_sentences_of_a_sounder_are_no_table(cli: Cli, lines: list[str], tmp_path: Path) -> None:
    code, said = cli("inspect", write(tmp_path / "log.txt", lines * 20), "-o", tmp_path / "log.toml")
    assert code == 3
    assert "sentences of NMEA 0183" in said
    assert "speed of sound in air only" in said
    assert not (tmp_path / "log.toml").exists()


def test_messages_that_end_in_json(tmp_path: Path) -> None:
    lines = [
        f'14 May 22:{n:02d}:00 - [info] [function:dist] {{"distance_cm":{185 + n % 5},"temp_c":18.{n % 9}}}'
        for n in range(ROWS)
    ]
    found = read_observations(write(tmp_path / "log.txt", lines), {"distance_cm": "reading_cm"})
    assert found.usable.all()
    np.testing.assert_allclose(found.reading, [(185 + n % 5) / 100 for n in range(ROWS)])
    np.testing.assert_allclose(np.diff(found.conditions["elapsed_time"]), 60.0)


def test_tenths_are_not_taken_for_an_error_code(
    cli: Cli, random: np.random.Generator, tmp_path: Path
) -> None:
    # 16 to 19 degC: such tenths are no ordinary degrees Fahrenheit or kelvins
    own = table(random).assign(temp_dC=lambda t: (160 + t["temperature_C"]).round())
    own.drop(columns="temperature_C").to_csv(tmp_path / "log.csv", index=False)
    code, said = cli("diagnose", tmp_path / "log.csv", "--column", "temp_dC=temperature_C")
    assert code == 3
    assert "--missing" not in said
    assert "in tenths, must be converted before" in said


def test_decimal_commas_that_nothing_encloses(cli: Cli, tmp_path: Path) -> None:
    lines = ["time,distance_cm,temp_c", *(f"2024-05-14T22:{n:02d}:00,185,5,17,9" for n in range(ROWS))]
    code, said = cli("diagnose", write(tmp_path / "log.csv", lines), "--constant-distance")
    assert code == 3
    assert "Expected 3 fields in line 2, saw 5; if its commas are decimal signs, quote such numbers" in said


def test_the_only_distance_is_proposed_as_a_reading(
    cli: Cli, random: np.random.Generator, tmp_path: Path
) -> None:
    own = table(random).assign(distance_ft=lambda t: (t["distance_m"] / 0.3048).round(3))
    own[["time", "distance_ft", "temperature_C"]].to_csv(tmp_path / "log.csv", index=False)
    assert cli("inspect", tmp_path / "log.csv", "-o", tmp_path / "log.toml")[0] == 0
    assert '"distance_ft" = "reading_ft"  # a guess' in (tmp_path / "log.toml").read_text()
    code, _ = cli("diagnose", tmp_path / "log.csv", "--options", tmp_path / "log.toml", "--constant-distance")
    assert code == 0


def test_a_column_of_text_is_not_proposed(cli: Cli, tmp_path: Path) -> None:
    lines = ["Time,Level,Temp", *(f'2024-05-14T22:{n:02d}:00,"6\' 1.{n:02d}""",18.1' for n in range(ROWS))]
    code, said = cli("diagnose", write(tmp_path / "log.csv", lines), "--constant-distance")
    assert code == 3
    assert "'Level' has text" in said


def test_the_file_of_options_is_an_input(cli: Cli, random: np.random.Generator, tmp_path: Path) -> None:
    table(random).to_csv(tmp_path / "log.csv", index=False)
    options = write(tmp_path / "log.toml", ['time-zone = "UTC"'])
    before = options.read_text()
    for output in ("--json", "--rows", "--save-model"):
        code, said = cli("diagnose", tmp_path / "log.csv", "--options", options, output, options, "--force")
        assert (code, options.read_text()) == (2, before)
        assert "is an input of this command" in said


@pytest.mark.parametrize("option", ["-o", "--json"])
def test_the_state_of_a_watch_is_no_output(
    cli: Cli, option: str, random: np.random.Generator, tmp_path: Path
) -> None:
    table(random).to_csv(tmp_path / "log.csv", index=False)
    echocal.Model("cramer").save(tmp_path / "model.json")
    both = tmp_path / "both.csv"
    code, said = cli(
        *("watch", tmp_path / "log.csv", "--once", "--model", tmp_path / "model.json"),
        *("--correct-only", option, both, "--state", both),
    )
    assert code == 2
    assert f"{option} and --state both name" in said
    assert not both.exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"effects": [{"id": "fixed_delay", "parameters": {}}]}, "'fixed_delay' has no parameter 'delay'"),
        ({"effects": None}, "effects"),
    ],
)
def test_a_model_file_that_lacks_what_it_is_about(
    change: dict[str, object], said: str, tmp_path: Path
) -> None:
    file = tmp_path / "model.json"
    echocal.Model("linear", {"fixed_delay": {"delay": 3e-5}}).save(file)
    document = {**json.loads(file.read_text()), **change}
    del document["hash"]
    file.write_text(json.dumps({name: own for name, own in document.items() if own is not None}))
    with pytest.raises(echocal.ModelError, match=said):
        echocal.Model.load(file)


def test_a_model_file_that_says_something_twice(tmp_path: Path) -> None:
    file = tmp_path / "model.json"
    echocal.Model("linear").save(file)
    file.write_text(file.read_text().replace('"law":', '"law": "cramer", "law":'))
    with pytest.raises(echocal.ModelError, match="has 'law' twice"):
        echocal.Model.load(file)


def test_a_field_of_many_characters(cli: Cli, random: np.random.Generator, tmp_path: Path) -> None:
    own = table(random).assign(remark="")
    own.loc[5, "remark"] = "x" * 200_000 + ",1"
    text = own.to_csv(index=False).replace('"', "")
    (tmp_path / "log.csv").write_text(text)
    echocal.Model("cramer").save(tmp_path / "model.json")
    out = ("-o", tmp_path / "out.csv")
    for command in (("diagnose",), ("correct", *out, "--model", tmp_path / "model.json")):
        code, said = cli(command[0], tmp_path / "log.csv", *command[1:])
        assert code == 3
        assert "has a field of more than 131,072 characters" in said


def test_a_last_line_that_is_cut(random: np.random.Generator, tmp_path: Path) -> None:
    own = table(random)[["time", "distance_m", "echo_us", "temperature_C"]].assign(battery_V=3.7)
    text = own.to_csv(index=False)
    cut = text.rstrip("\n")
    cut = cut[: cut.rindex(",") - 2]  # within the temperature
    (tmp_path / "log.csv").write_text(cut)
    assert echocal.diagnose(tmp_path / "log.csv").rows["unusable"] == {"cut line": 1}
    corrected = echocal.correct_files(tmp_path / "log.csv", tmp_path / "out.csv", echocal.Model("cramer"))
    assert corrected.unusable == 1
    found = pd.read_csv(tmp_path / "out.csv")
    assert found["status"].isna().sum() == ROWS - 1
    assert found["status"].iloc[-1] == "cut line"
    assert found["corrected_distance_m"].isna().tolist() == [False] * (ROWS - 1) + [True]


def test_rows_that_are_all_the_same(random: np.random.Generator) -> None:
    one = pd.concat([table(random).iloc[:1]] * 50, ignore_index=True)
    with pytest.raises(echocal.DataError, match="all 50 usable rows have the same values"):
        echocal.diagnose(one)


def test_references_in_another_unit_are_repaired_and_readings_are_not(random: np.random.Generator) -> None:
    """Those of 0.5 m are in range as 50 m."""
    own = table(random, 200)
    wrong = own.assign(distance_m=100 * own["distance_m"])
    found = echocal.diagnose(wrong, base="cramer")
    assert "unit_mixup" in {cause.id for cause in found.causes}
    assert found.rows["used"] == 200
    error = found.traces.after[~np.isnan(found.traces.after)]
    assert np.sqrt(np.mean(error**2)) < 2e-3  # the delay, or a class that it is one of, is corrected


@pytest.mark.statistical
def test_a_diagnosed_speed_corrects_a_file(random: np.random.Generator, tmp_path: Path) -> None:
    """Its two parameters have a covariance."""
    own = table(random, 200)
    reading = own["echo_us"] * 0.5e-6 * 343.0
    own = own.assign(reading_m=reading.round(4)).drop(columns="echo_us")
    found = echocal.diagnose(own, base="cramer")
    assert found.model.effects["fixed_speed"]["speed"] == pytest.approx(343.0, abs=0.5)
    own.to_csv(tmp_path / "log.csv", index=False)
    assert echocal.correct_files(tmp_path / "log.csv", tmp_path / "out.csv", found.model).unusable == 0
    corrected = pd.read_csv(tmp_path / "out.csv")
    error = corrected["corrected_distance_m"] - corrected["distance_m"]
    assert np.sqrt(np.mean(error**2)) < 2e-3
    assert (corrected["distance_standard_uncertainty_m"] > 0).all()


def test_a_model_remembers_the_speed_of_the_firmware(
    cli: Cli, random: np.random.Generator, tmp_path: Path
) -> None:
    """Without it, readings that 343 m/s made would be taken for those of the law: up to 0.1 m wrong."""
    own = table(random, 200)
    readings = own.assign(reading_m=(own["echo_us"] * 0.5e-6 * 343.0).round(4)).drop(columns="echo_us")
    readings.to_csv(tmp_path / "log.csv", index=False)
    asked = (
        "diagnose",
        "log.csv",
        "--base",
        "cramer",
        "--reading-speed",
        "343",
        "--save-model",
        "model.json",
    )
    assert cli(*asked)[0] == 0
    code, said = cli("correct", "log.csv", "--model", "model.json", "-o", "out.csv")
    assert code == 0
    assert "made with the speed '343', as in the diagnosis of the model" in said
    found = pd.read_csv(tmp_path / "out.csv")
    error = found["corrected_distance_m"] - found["distance_m"]
    assert np.sqrt(np.mean(error**2)) < 2e-3
    assert cli("verify", "log.csv", "--model", "model.json", "--maximum-permissible-error-mm", "8")[0] == 0


def test_a_requirement_in_millimeters_is_told(random: np.random.Generator) -> None:
    observations = read_observations(table(random))
    with pytest.warns(echocal.DataWarning, match="10 mm are 0.01"):
        echocal.verify(observations, maximum_permissible_error=10)


def test_arguments_of_a_calibration_that_cannot_be(random: np.random.Generator) -> None:
    observations = read_observations(table(random))
    for wrong, said in (
        ({"loss": "huber", "loss_scale": -1.0}, "loss_scale must be finite and above 0, but is -1"),
        ({"standard_uncertainty": -1.0}, "wants one positive number or 40 of them; got -1"),
    ):
        with pytest.raises(echocal.UsageError, match=said):
            echocal.calibrate(observations, echocal.Model("cramer"), fit=["fixed_delay.delay"], **wrong)


def test_a_report_without_a_known_distance_claims_no_error(
    cli: Cli, random: np.random.Generator, tmp_path: Path
) -> None:
    table(random, 200).to_csv(tmp_path / "known.csv", index=False)
    own = table(random, 200)
    echo = 2e6 * 1.5 / echocal.speed_of_sound(own["temperature_C"]) + random.normal(0, 3, 200)
    own.assign(echo_us=echo).drop(columns="distance_m").to_csv(tmp_path / "level.csv", index=False)
    assert cli("diagnose", "known.csv", "--report", "known.html")[0] == 0
    assert cli("diagnose", "level.csv", "--constant-distance", "--report", "level.html")[0] == 0
    assert "<span>error before</span>" in (tmp_path / "known.html").read_text()
    assert "<span>scatter around the level before</span>" in (tmp_path / "level.html").read_text()


def test_a_line_that_is_being_written_waits_for_its_end(
    cli: Cli, random: np.random.Generator, tmp_path: Path
) -> None:
    text = table(random).drop(columns="distance_m").to_csv(index=False)
    half = len(text) // 2
    watch = ("watch", "log.csv", "--once", "--law", "linear", "--correct-only", "-o", "out.csv")
    (tmp_path / "log.csv").write_text(text[:half])
    code, said = cli(*watch, "--state", "state.db")
    assert code == 0
    assert "ends within a line" in said
    with (tmp_path / "log.csv").open("a") as file:
        file.write(text[half:])
    assert cli(*watch, "--state", "state.db")[0] == 0
    found = pd.read_csv(tmp_path / "out.csv")
    assert found["echo_us"].tolist() == pd.read_csv(tmp_path / "log.csv")["echo_us"].tolist()
    assert found["corrected_distance_m"].notna().all()


def test_007_and_7_are_two_sensors(cli: Cli, random: np.random.Generator, tmp_path: Path) -> None:
    ids = ("007", "7", "8")
    both = pd.concat([table(random, 60).assign(sensor_id=name) for name in ids])
    both.to_csv(tmp_path / "log.csv", index=False)
    assert cli("diagnose", "log.csv", "--by", "sensor_id", "-o", "found.csv", "--models", "models")[0] == 0
    assert pd.read_csv(tmp_path / "found.csv", dtype=str)["sensor"].tolist() == sorted(ids)
    assert sorted(file.stem for file in (tmp_path / "models").glob("[0-9]*.json")) == sorted(ids)
    assert cli("correct", "log.csv", "--models", "models", "--by", "sensor_id", "-o", "out.csv")[0] == 0
    found = pd.read_csv(tmp_path / "out.csv")
    assert found["status"].isna().all()
    assert np.abs(found["corrected_distance_m"] - found["distance_m"]).max() < 5e-3


def test_what_a_fleet_has_not_is_told(cli: Cli, random: np.random.Generator, tmp_path: Path) -> None:
    own = table(random, 60).assign(sensor_id=[str(10**n) for n in (0, 20, 1)] * 20)
    own.to_csv(tmp_path / "log.csv", index=False)
    fleet = ("diagnose", "log.csv", "--by", "sensor_id", "-o", "found.csv")
    code, said = cli(*fleet, "--rows", "rows.csv")
    assert code == 2
    assert "--rows is for one table, and this is a fleet" in said
    assert cli(*fleet)[0] == 0
    assert len(pd.read_csv(tmp_path / "found.csv", dtype=str)) == 3
