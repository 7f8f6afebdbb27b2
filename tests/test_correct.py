import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files, correct_table
from echocal.errors import UsageError

DEVICE = echocal.Model("linear", {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": 2e-3}})


def echoes(device: echocal.Model, distance: list[float], temperature: list[float]) -> pd.DataFrame:
    time = device.time_of_flight(np.array(distance), temperature=np.array(temperature))
    return pd.DataFrame({"echo_s": time, "temperature_C": temperature})


def test_echo_times_become_the_distances_they_came_from() -> None:
    device = echocal.Model("linear", {"fixed_delay": {"delay": 31e-6}})
    distance = [0.3, 1.0, 2.5, 4.0]
    corrected = correct_table(echoes(device, distance, [0.0, 10.0, 20.0, 40.0]), device)
    np.testing.assert_allclose(corrected.table["corrected_distance_m"], distance, rtol=0, atol=1e-12)
    assert corrected.unusable == {}


@pytest.mark.parametrize("speed", [None, "343"])
def test_readings_of_a_device_with_errors_of_indication(speed: str | None) -> None:
    effects = {"zero_error": {"offset": 2e-3}, "fixed_speed": {"weight": 1.0, "speed": 343.0}}
    device = echocal.Model("linear", effects)
    distance, temperature = np.array([0.3, 1.0, 2.5]), np.array([0.0, 20.0, 40.0])
    reading = device.indicate(distance, temperature=temperature)
    table = pd.DataFrame({"reading_m": reading, "temperature_C": temperature})
    if speed is None:  # the model itself knows what the firmware does
        corrected = correct_table(table, device)
    else:  # the user says it, and the model need not
        corrected = correct_table(
            table, echocal.Model("linear", {"zero_error": {"offset": 2e-3}}), reading_speed=speed
        )
    tolerance = 1e-12 if speed is None else 2e-3 * 0.05  # an offset after another speed: its 5 %
    np.testing.assert_allclose(corrected.table["corrected_distance_m"], distance, rtol=0, atol=tolerance)


def test_every_row_comes_out_in_order_with_its_reason() -> None:
    device = echocal.Model("cramer", DEVICE.effects)
    table = echoes(device, [1.0, 1.0, 1.0, 1.0], [20.0, 20.0, 20.0, 20.0])
    table["humidity_percent"] = [40.0, 143.0, 40.0, np.nan]
    table["supply_V"] = np.nan  # no part of the model reads it
    table.loc[2, "echo_s"] = 0.0
    table.index = pd.Index([7, 7, 3, 1])
    corrected = correct_table(table, device)
    assert corrected.table.index.tolist() == [7, 7, 3, 1]
    reasons = ["", "humidity_percent out of range", "echo_s out of range", "humidity_percent missing"]
    assert corrected.table["unusable"].tolist() == reasons
    assert corrected.table["corrected_distance_m"].isna().tolist() == [False, True, True, True]
    assert corrected.unusable == {reason: 1 for reason in reasons if reason}
    pd.testing.assert_frame_equal(corrected.table[table.columns], table)


def test_an_unusable_row_leaves_no_domain() -> None:
    table = echoes(DEVICE, [1.0, 1.0], [20.0, 20.0])
    table.loc[1, "temperature_C"] = 124.99
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert correct_table(table, DEVICE).unusable == {"temperature_C out of range": 1}


def test_a_missing_reference_costs_no_row() -> None:
    table = echoes(DEVICE, [1.0, 1.0], [20.0, 20.0]).assign(distance_m=[np.nan, 1.0], stand=["a", None])
    assert correct_table(table, DEVICE).table["corrected_distance_m"].notna().all()


def test_what_a_model_needs_and_the_table_lacks() -> None:
    with pytest.raises(echocal.DataError, match="temperature"):
        correct_table(pd.DataFrame({"echo_us": [11660.0]}), DEVICE)


def test_a_corrected_table_is_not_corrected_again() -> None:
    once = correct_table(echoes(DEVICE, [1.0], [20.0]), DEVICE).table
    with pytest.raises(echocal.DataError, match="already has a column 'corrected_distance_m'"):
        correct_table(once, DEVICE)


def test_text_stays_letter_for_letter(tmp_path: Path) -> None:
    source, out = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text('# logger 7\necho_us,temperature_C,remark\n11660.50,20.10,"a, b"\n-9999,20,NA\n')
    corrected = correct_files(source, out, DEVICE, missing=[-9999])
    lines = out.read_text().splitlines()
    assert lines[0] == "# logger 7"
    appended = "corrected_distance_m,distance_standard_uncertainty_m,status,unusable"
    assert lines[1] == f"echo_us,temperature_C,remark,{appended}"
    assert lines[2].startswith('11660.50,20.10,"a, b",1.99')
    assert lines[3] == "-9999,20,NA,,,echo_us missing,echo_us missing"
    assert corrected.rows == 2
    assert set(tmp_path.iterdir()) == {source, out}


@pytest.mark.parametrize("ending", [".csv", ".csv.gz", ".tsv", ".parquet"])
def test_endings(ending: str, tmp_path: Path) -> None:
    table = echoes(DEVICE, [1.0, 2.0], [20.0, 30.0])
    table.to_parquet(tmp_path / "in.parquet")
    out = tmp_path / f"out{ending}"
    correct_files(tmp_path / "in.parquet", out, DEVICE)
    back = pd.read_parquet(out) if ending == ".parquet" else pd.read_csv(out, sep=None, engine="python")
    np.testing.assert_allclose(
        back["corrected_distance_m"], correct_table(table, DEVICE).table["corrected_distance_m"], atol=1e-9
    )


def test_decimal_commas_stay(tmp_path: Path) -> None:
    source, out = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text("echo_us;temperature_C\n11660,5;20,1\n")
    correct_files(source, out, DEVICE, layout=echocal.observations.text.Layout(decimal=","))
    assert out.read_text().splitlines()[1].startswith("11660,5;20,1;1,99")


def test_a_folder_goes_file_by_file(tmp_path: Path) -> None:
    source, out = tmp_path / "logs", tmp_path / "out"
    for name in ("2024/may.parquet", "2024/june.parquet", "july.parquet"):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        echoes(DEVICE, [1.0, 2.0], [20.0, 30.0]).to_parquet(source / name)
    seen: list[int] = []
    done = correct_files(source, out, DEVICE, progress=lambda state: seen.append(state.files)).results
    assert sorted(done) == ["2024/june.parquet", "2024/may.parquet", "july.parquet"]
    assert sorted(set(seen) - {0}) == [1, 2, 3]
    assert all(len(pd.read_parquet(out / place)) == 2 for place in done)


def test_a_bad_file_of_a_folder_is_set_aside_and_the_rest_is_done(tmp_path: Path) -> None:
    source, out = tmp_path / "logs", tmp_path / "out"
    source.mkdir()
    echoes(DEVICE, [1.0], [20.0]).to_parquet(source / "a.parquet")
    (source / "b.parquet").write_bytes(b"PAR1 broken")
    echoes(DEVICE, [1.0], [20.0]).to_parquet(source / "c.parquet")
    summary = correct_files(source, out, DEVICE)
    assert list(summary.set_aside) == [str(source / "b.parquet")]
    assert sorted(path.name for path in out.iterdir()) == ["_echocal", "a.parquet", "c.parquet"]


def test_outputs_that_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    echoes(DEVICE, [1.0], [20.0]).to_csv(path, index=False)
    with pytest.raises(echocal.UsageError, match="is the input itself"):
        correct_files(path, path, DEVICE)
    assert path.read_text().count("\n") == 2
    with pytest.raises(echocal.UsageError, match=r"cannot write .*out.xls; endings: .csv, .tsv,"):
        correct_files(path, tmp_path / "out.xls", DEVICE)
    path.unlink()
    with pytest.raises(echocal.DataError, match=r"has no file that can be corrected"):
        correct_files(tmp_path, tmp_path / "out", DEVICE)


def test_what_is_no_model_and_no_table_is_said(tmp_path: Path) -> None:
    distance = np.linspace(0.5, 2.0, 40)
    rows = {"echo_us": 5840.0 * distance, "temperature_C": np.full(40, 20.0), "distance_m": distance}
    diagnosis = echocal.diagnose(rows)
    log = tmp_path / "log.csv"
    log.write_text("echo_us,temperature_C\n11680,20\n")
    for given, said in (
        ("cramer", "got 'cramer'"),
        ("m.json", "got 'm.json'"),
        (diagnosis, "got a Diagnosis"),
    ):
        with pytest.raises(UsageError, match=f"correct needs a Model, {said}; Model"):
            echocal.correct(rows, given)  # type: ignore[arg-type]
        with pytest.raises(UsageError, match=f"correct needs a Model, {said}; Model"):
            echocal.correct_files(log, tmp_path / "out.csv", given)  # type: ignore[arg-type]
    read = echocal.read_observations(rows)
    for verb in (diagnosis.correct, lambda table: echocal.correct(table, diagnosis.model)):
        with pytest.raises(UsageError, match="give the table that they were read from"):
            verb(read)
