"""The commands on tables, as a user types them: exit codes, one clear line, no traceback."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr

import echocal
from echocal.cli import main

EXAMPLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    """Run a command line in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def command(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["echocal", *words])
        with pytest.raises(SystemExit) as caught:
            main()
        code = caught.value.code
        return int(code or 0), *capsys.readouterr()

    return command


def test_sweep_writes_table_grid_and_plot(run: Run) -> None:
    grid = [
        "--temperature",
        "-10:50:20",
        "--distance",
        "1,2",
        "--at",
        "humidity_percent=0:100:50",
        "--law",
        "cramer",
    ]
    for out in ("sweep.csv", "sweep.parquet", "sweep.nc"):
        assert run("sweep", *grid, "-o", out, "--plot", "sweep.png", "--quiet") == (0, "", "")
    table = pd.read_csv("sweep.csv")
    assert list(table.columns[:3]) == ["temperature_C", "distance_m", "relative_humidity"]
    assert len(table) == 4 * 2 * 3
    pd.testing.assert_frame_equal(pd.read_parquet("sweep.parquet"), table, rtol=1e-15)
    with xr.open_dataset("sweep.nc") as written:
        assert dict(written.sizes) == {"temperature": 4, "distance": 2, "relative_humidity": 3}
    assert Path("sweep.png").read_bytes().startswith(b"\x89PNG")


def test_sweep_json_is_all_of_stdout(run: Run) -> None:
    code, out, _ = run("sweep", "--temperature", "0:50:25", "--json", "-")
    document = json.loads(out)
    assert code == 0
    assert document["schema"] == "echocal.sweep/1"
    assert len(document["data_vars"]["error"]["data"]) == 3


def test_sweep_takes_effects_and_models(run: Run) -> None:
    model = echocal.Model("linear", {"fixed_speed": {"weight": 1.0, "speed": 343.0}})
    model.save("model.json")
    effect = "fixed_speed:weight=1,speed=343"
    run("sweep", "--temperature", "0:50:10", "--law", "linear", "--effect", effect, "-o", "law.csv", "-q")
    run("sweep", "--temperature", "0:50:10", "--model", "model.json", "-o", "model.csv", "-q")
    assert Path("law.csv").read_text() == Path("model.csv").read_text()
    assert pd.read_csv("law.csv")["error_m"].iloc[0] == pytest.approx(2 * (343 / 331.4 - 1))


def test_sweep_notes_where_the_law_does_not_hold(run: Run) -> None:
    code, _, err = run("sweep", "--temperature", "0:50:10", "--relative-humidity", "1")
    assert code == 0
    assert err.startswith("note: law 'cramer' holds for water_vapor_mole_fraction 0 .. 0.06")
    assert len(err.splitlines()) == 1


def test_correct_csv(run: Run) -> None:
    code, out, err = run("correct", str(EXAMPLE), "-o", "out.csv", "--law", "linear", "--json", "report.json")
    assert (code, out) == (0, "out.csv: 27 of 27 rows corrected\n")
    assert err.startswith("note: the readings are taken to be made with the law 'linear' itself")
    assert len(pd.read_csv("out.csv", comment="#")) == 27
    report = json.loads(Path("report.json").read_text())
    assert report["files"]["out.csv"] == {"rows": {"total": 27, "used": 27, "unusable": {}}}


def test_correct_a_loggers_file(run: Run) -> None:
    Path("log.csv").write_text("id 7\nT;D\n20,5;2000\n21,0;9999\n")
    Path("map.toml").write_text('T = "temperature_C"\n"D" = "distance reading in mm"\n')
    options = ["--skip-lines", "1", "--decimal", ",", "--column", "map.toml", "--missing", "D=9999"]
    code, out, err = run("correct", "log.csv", "-o", "out.csv", "--law", "linear", *options)
    assert (code, out) == (0, "out.csv: 1 of 2 rows corrected\n")
    assert "note: no distance in 1 row: D missing, first at row 2" in err
    assert Path("out.csv").read_text() == (
        "id 7\nT;D;corrected_distance_m;distance_standard_uncertainty_m;status;unusable\n"
        "20,5;2000;2;;;\n21,0;9999;;;D missing;D missing\n"
    )


def test_correct_a_folder(run: Run) -> None:
    Path("logs").mkdir()
    for month in ("may", "june"):
        pd.DataFrame({"echo_us": [11660.0], "temperature_C": [20.0]}).to_parquet(f"logs/{month}.parquet")
    code, out, _ = run("correct", "logs", "-o", "done", "--law", "cramer")
    assert (code, out) == (0, "2 files: 2 of 2 rows corrected\n")
    assert sorted(path.name for path in Path("done").iterdir()) == ["_echocal", "june.parquet", "may.parquet"]


def test_verify_says_passed_or_failed(run: Run) -> None:
    code, out, _ = run("verify", str(EXAMPLE), "--maximum-permissible-error-mm", "110.5")
    assert code == 0
    assert "verification: conforms" in out
    code, out, _ = run("verify", str(EXAMPLE), "--maximum-permissible-error-mm", "3", "--json", "-")
    assert code == 1
    assert json.loads(out)["worst"] == {"row": 27}


def test_verify_a_model(run: Run) -> None:
    echocal.Model("linear", {"zero_error": {"offset": 2e-3}}).save("model.json")
    assert run("verify", "model.json", "--maximum-permissible-error-mm", "2.1", "-q") == (0, "", "")
    assert run("verify", "model.json", "--maximum-permissible-error-mm", "1.9", "-q") == (1, "", "")


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        ("sweep", 2, "echocal: sweep needs a temperature: --temperature 0:50:2"),
        ("sweep --temperature 0:50", 2, "echocal: temperature: '0:50' is no range"),
        ("sweep --temperature 20 --law fast", 2, "'fast'"),
        (
            "sweep --temperature 20 --at humidity=50",
            2,
            "echocal: 'humidity' names no influence quantity with its unit",
        ),
        (
            "sweep --temperature 20 --effect fixed_delay:30e-6",
            2,
            '--effect "fixed_delay:30e-6" is not of the form',
        ),
        (
            "sweep --temperature 20 --law cramer --model m.json",
            2,
            "a model file or a law with effects, not both",
        ),
        ("sweep --temperature 20 --plot a.png", 2, "a single point makes no plot"),
        (
            "sweep --temperature 0:50:2 --plot a.xyz",
            2,
            "a.xyz has the ending '.xyz'; a plot is .png,",
        ),
        ("sweep --temperature 20 -o a.xyz", 2, "cannot write '.xyz'"),
        ("sweep --temperature 20 -o no/a.csv", 2, "no/a.csv cannot be written"),
        ("sweep --temperature 20 --json no/a.json", 2, "no/a.json cannot be written"),
        ("sweep --temperature 20 --model absent.json", 2, "absent.json"),
        ("correct absent.csv -o out.csv", 3, "echocal: no file absent.csv"),
        ("correct . -o out", 3, "has no file that can be corrected"),
        ("correct EXAMPLE -o out.csv --column reading_m", 2, "is neither a pair"),
        ("correct EXAMPLE -o out.csv --column a=reading_m", 2, "echocal: no column 'a'"),
        ("diagnose EXAMPLE --missing readin_m=3", 2, "did you mean 'reading_m'? It has"),
        ("diagnose EXAMPLE --by readin_m", 3, "did you mean 'reading_m'? It has"),
        ("diagnose EXAMPLE -o v.csv --by readin_m", 3, "did you mean 'reading_m'? It has"),
        ("inspect EXAMPLE --column readin_m=reading_m", 2, "did you mean 'reading_m'? The table has"),
        ("diagnose EXAMPLE --at temprature=20", 2, "did you mean 'temperature'? There are"),
        ("correct EXAMPLE -o out.csv --uncertainty temprature_C=1", 2, "did you mean 'temperature_C'?"),
        ("correct EXAMPLE -o out.csv --models . --by readin_m", 3, "did you mean 'reading_m'? It has"),
        ("correct EXAMPLE -o out.csv --missing a=3", 2, "error codes for column 'a', which is not there"),
        ("correct EXAMPLE -o out.csv --reading-speed fast", 2, "fast"),
        ("correct EXAMPLE -o out.csv --column temperature_C=ignore", 3, "'cramer'"),
        ("correct EXAMPLE -o out.csv --encoding utf-9", 2, "unknown encoding 'utf-9'"),
        ("verify EXAMPLE", 2, "--maximum-permissible-error-mm"),
        ("verify EXAMPLE --maximum-permissible-error-mm 0", 2, "must be a positive length [mm], got 0"),
        (
            "diagnose EXAMPLE --base 3",
            2,
            "the base is a fixed speed of 3 m/s; give a speed of 300 .. 400, or a law",
        ),
        (
            "verify EXAMPLE --maximum-permissible-error-mm 3 --column distance_m=ignore",
            3,
            "reference distance",
        ),
    ],
)
def test_mistakes_are_one_clear_line(run: Run, words: str, code: int, line: str) -> None:
    found, out, err = run(*(str(EXAMPLE) if word == "EXAMPLE" else word for word in words.split()))
    assert found == code, err
    assert line in err
    assert out == ""
    assert "Traceback" not in err


def test_what_belongs_to_one_campaign_is_told_and_left_out(run: Run) -> None:
    echocal.Model("linear", {"step_change": {"offset": 5e-3, "time": 30.0}}).save("model.json")
    table = {"time_s": [0.0, 60.0], "temperature_C": [20.0, 20.0], "reading_m": [1.0, 1.0]}
    pd.DataFrame(table).to_csv("log.csv", index=False)
    words = ("correct", "log.csv", "--model", "model.json", "--reading-speed", "linear", "-o", "out.csv")
    _, _, told = run(*words)
    assert "step_change" in " ".join(told.split())
    assert "--transferable" in told
    assert pd.read_csv("out.csv", comment="#")["corrected_distance_m"].tolist() == pytest.approx([1.0, 0.995])
    _, _, told = run(*words[:-1], "lasting.csv", "--transferable")
    assert "step_change" not in told
    assert pd.read_csv("lasting.csv")["corrected_distance_m"].tolist() == pytest.approx([1.0, 1.0])


def test_a_misspelled_command_names_the_nearest(run: Run) -> None:
    code, _, said = run("diagnoze", str(EXAMPLE))
    assert code == 2
    assert "no command and no file 'diagnoze'; did you mean 'diagnose'?" in said
