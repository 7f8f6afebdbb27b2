"""Captures from files, and the command that times them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet
import pytest
from made_echoes import Echo, captures
from numpy.typing import NDArray
from scipy.io import wavfile

import echocal

RATE, COUNT = 192000, 1400
Run = Callable[..., tuple[int, str]]
Array = NDArray[np.float64]


@pytest.fixture
def made(random: np.random.Generator) -> Array:
    clean = 0.7 * captures(Echo(), np.array([3e-3, 4e-3, 3.5e-3]), RATE, COUNT)
    return np.asarray(clean + 0.01 * random.standard_normal((3, COUNT)))


def lists(made: Array, **columns: Any) -> pa.Table:
    return pa.table({"wave": pa.array(list(made), pa.list_(pa.float64())), **columns})


@pytest.mark.parametrize(
    ("kind", "step"), [("u1", 1 / 128), ("i2", 2**-15), ("i4", 2**-31), ("f4", 1e-7), ("f8", 1e-15)]
)
def test_wav_of_every_kind_is_in_full_scale(kind: str, step: float, made: Array, tmp_path: Path) -> None:
    codes = made.T
    if kind == "u1":
        codes = np.round(128.0 * made.T) + 128.0
    elif kind[0] == "i":
        codes = np.round(made.T / step)
    wavfile.write(tmp_path / "a.wav", RATE, codes.astype(kind))
    waveform, rate = echocal.read_waveforms(tmp_path / "a.wav")
    assert rate == RATE
    assert waveform == pytest.approx(made, abs=step)


def test_a_wav_of_one_channel_is_one_capture(made: Array, tmp_path: Path) -> None:
    wavfile.write(tmp_path / "a.wav", RATE, made[0].astype(np.float32))
    assert echocal.read_waveforms(tmp_path / "a.wav", sample_rate=RATE)[0].shape == (COUNT,)


def test_npy_keeps_shape_and_codes(tmp_path: Path) -> None:
    codes = np.arange(24, dtype=np.int16).reshape(2, 3, 4)
    np.save(tmp_path / "a.npy", codes)
    waveform, rate = echocal.read_waveforms(tmp_path / "a.npy", 5e5)
    assert (waveform.dtype, waveform.shape, rate) == (np.int16, (2, 3, 4), 5e5)


@pytest.mark.parametrize("kind", ["list", "large_list", "fixed_size_list"])
@pytest.mark.parametrize("where", ["column", "table", "field"])
def test_parquet_lists_of_every_kind(kind: str, where: str, made: Array, tmp_path: Path) -> None:
    types = {"list": pa.list_(pa.int32()), "large_list": pa.large_list(pa.int32())}
    types["fixed_size_list"] = pa.list_(pa.int32(), COUNT)
    codes = np.round(1000.0 * made).astype(np.int32)
    said = {"sample_rate_Hz": str(RATE)}
    field = pa.field("wave", types[kind], metadata=said if where == "field" else None)
    table = pa.table([pa.array(list(codes), types[kind])], schema=pa.schema([field]))
    if where == "table":
        table = table.replace_schema_metadata(said)
    elif where == "column":
        table = table.append_column("sample_rate_Hz", [[RATE] * 3])
    pa.parquet.write_table(table, tmp_path / "a.parquet")
    waveform, rate = echocal.read_waveforms(tmp_path / "a.parquet")
    assert rate == RATE
    assert np.array_equal(waveform, codes)


def test_rows_without_samples_stay_rows(made: Array, tmp_path: Path) -> None:
    rows = [list(made[0]), None, [None, *made[2][1:]]]
    table = pa.table({"wave": pa.array(rows, pa.list_(pa.float64()))})
    pa.parquet.write_table(table, tmp_path / "a.parquet")
    waveform, rate = echocal.read_waveforms(tmp_path / "a.parquet", RATE)
    assert list(echocal.echo_times(waveform, rate).reasons) == ["", "not_finite", "not_finite"]


BAD_TABLES: dict[str, tuple[Callable[[Array], pa.Table], dict[str, Any], type[Exception], str]] = {
    "no list": (
        lambda m: pa.table({"a": [1.0]}),
        {},
        echocal.DataError,
        "no column of lists of numbers; its",
    ),
    "several": (
        lambda m: lists(m, other=pa.array(list(m))),
        {},
        echocal.UsageError,
        "wave, other; choose one",
    ),
    "absent": (
        lists,
        {"column": "wav"},
        echocal.UsageError,
        "no column 'wav' of lists of numbers; there are",
    ),
    "no rate": (
        lists,
        {"sample_rate": None},
        echocal.UsageError,
        "has no sample rate; give it: sample_rate [Hz]",
    ),
    "ragged": (
        lambda m: pa.table({"wave": [[1.0, 2.0], [1.0, 2.0], [1.0]]}),
        {},
        echocal.DataError,
        "column 'wave' has 2 samples in row 1 and 1 in row 3; captures need one length",
    ),
    "empty": (lambda m: lists(m[:0]), {}, echocal.DataError, "column 'wave' has 0 rows and no sample"),
    "rates": (
        lambda m: lists(m, sample_rate_Hz=[1e5, 1e5, 2e5]),
        {"sample_rate": None},
        echocal.DataError,
        "has several sample rates (100000 to 200000 Hz); split it",
    ),
    "no number": (
        lambda m: lists(m, sample_rate_Hz=["fast"] * 3),
        {},
        echocal.DataError,
        "sample_rate_Hz is 'fast', which is no number",
    ),
    "other": (
        lambda m: lists(m, sample_rate_Hz=[1e5] * 3),
        {},
        echocal.UsageError,
        "says 100000 Hz: leave it",
    ),
}


@pytest.mark.parametrize("name", BAD_TABLES)
def test_a_table_that_is_not_clear_is_refused(name: str, made: Array, tmp_path: Path) -> None:
    make, options, error, words = BAD_TABLES[name]
    pa.parquet.write_table(make(made), tmp_path / "a.parquet")
    with pytest.raises(error) as raised:
        echocal.read_waveforms(tmp_path / "a.parquet", **{"sample_rate": float(RATE), **options})
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


def _damaged(path: Path, made: Array, kind: str) -> None:
    np.save(path / "whole.npy", made)
    wavfile.write(path / "whole.wav", RATE, made.T)
    pa.parquet.write_table(lists(made), path / "whole.parquet")
    content = (path / f"whole.{kind}").read_bytes()
    (path / f"cut.{kind}").write_bytes(content[: len(content) // 2])


@pytest.mark.parametrize("kind", ["npy", "wav", "parquet"])
def test_a_file_that_is_cut_off_is_told(kind: str, made: Array, tmp_path: Path) -> None:
    _damaged(tmp_path, made, kind)
    with pytest.raises(echocal.DataError, match="cannot be read"):
        echocal.read_waveforms(tmp_path / f"cut.{kind}", RATE)


def test_other_files_are_told(made: Array, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("1,2,3\n")
    (tmp_path / "empty.npy").touch()
    np.save(tmp_path / "objects.npy", np.array([{}], dtype=object), allow_pickle=True)
    np.save(tmp_path / "complex.npy", 1j * made)
    for name, words in {
        "a.csv": "is neither .npy nor WAV nor Parquet",
        "empty.npy": "is empty",
        "absent.npy": "no file",
        ".": "cannot be read: Is a directory",
        "objects.npy": "cannot be read: Object arrays cannot be loaded",
        "complex.npy": "captures are arrays of real numbers",
    }.items():
        with pytest.raises(echocal.DataError, match=words):
            echocal.read_waveforms(tmp_path / name, RATE)
    wavfile.write(tmp_path / "a.wav", RATE, made.T)
    with pytest.raises(echocal.UsageError, match="has no columns"):
        echocal.read_waveforms(tmp_path / "a.wav", column="wave")


def test_the_command_writes_what_diagnose_reads(made: Array, run: Run) -> None:
    made[1] = np.nan
    beside = {"distance_m": [0.5, 0.6, 0.7], "temperature_C": [20.0] * 3, "sample_rate_Hz": [RATE] * 3}
    pa.parquet.write_table(lists(made, **beside), "a.parquet")
    words = ("echo-times", "a.parquet", "-o", "a.csv", "--plot", "a.png", "--json", "a.json")
    assert run(*words) == (0, "")
    table = pd.read_csv("a.csv")
    assert list(table)[:5] == ["capture", "distance_m", "temperature_C", "echo_us", "standard_uncertainty_us"]
    assert table["status"].fillna("").tolist() == ["", "not_finite", ""]
    assert table["echo_us"][0] == pytest.approx(3000.0, abs=1.0)
    with pytest.warns(echocal.DataWarning, match="echo_us has no value in 1 row"):
        observations = echocal.read_observations("a.csv")
    assert observations.echo_time[[0, 2]] == pytest.approx([3e-3, 3.5e-3], abs=1e-6)
    assert len(observations) == 3
    told = json.loads(Path("a.json").read_text())
    assert told["schema"] == "echocal.echo_times/1"
    assert told["captures"] == {"total": 3, "used": 2, "unusable": {"not_finite": 1}}
    assert told["rows"][1]["echo_us"] is None
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert run(*words, "-q") == (0, "")  # its own files may be replaced


def test_the_command_takes_every_option(made: Array, run: Run) -> None:
    np.save("a.npy", made)
    np.save("echo.npy", Echo().samples(RATE)[:300])
    words = ["echo-times", "a.npy", "--sample-rate", str(RATE), "--full-scale", "2", "-q"]
    words += ["--start-us", "1000", "--stop-us", "7000", "--noise", "0.01"]
    assert run(*words, "--template", "echo.npy", "--carrier", "40000", "-o", "a.csv") == (0, "")
    assert pd.read_csv("a.csv")["echo_us"].to_numpy() == pytest.approx([3000, 4000, 3500], abs=1.0)
    assert pd.read_csv("a.csv")["amplitude"].to_numpy() == pytest.approx(0.35, rel=0.05)
    crossing = ["--method", "threshold", "--threshold", "0.2", "--bandwidth", "8000"]
    assert run(*words, *crossing, "-o", "b.parquet") == (0, "")
    assert (pd.read_parquet("b.parquet")["echo_us"] > 3000.0).all()


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        ("a.npy", 2, "a.npy has no sample rate; give it: --sample-rate [Hz]"),
        ("a.npy --sample-rate 50000", 2, "sample_rate is 50000 Hz, too low"),
        ("a.npy --sample-rate 192000 --method best", 2, "method is 'best'; there are"),
        ("a.npy --sample-rate 192000 -o a.txt", 2, "cannot write '.txt' (a.txt); endings: .csv, .parquet"),
        ("a.npy --sample-rate 192000 --plot a", 2, "a has no ending; a plot is .png, .svg or .pdf"),
        ("a.npy --sample-rate 192000 -o a.npy", 2, "--out a.npy is an input of this command"),
        ("a.npy --sample-rate 192000 --template b.npy", 3, "no file b.npy"),
        ("a.npy --sample-rate 192000 --template a.npy", 2, "template has the shape (3, 1400); give one echo"),
        ("absent.npy --sample-rate 192000", 3, "no file absent.npy"),
        ("none.npy --sample-rate 192000 --plot a.png", 3, "array of the shape (0, 1400); nothing to time"),
        ("a.npy --sample-rate 192000 --full-scale 0", 2, "full_scale is 0.0; give a number above 0"),
        ("a.npy --sample-rate 192000 --full-scale nan", 2, "full_scale is nan; give a number above 0"),
        ("vast.npy --sample-rate 192000", 3, "by its header, more samples than fit into memory"),
        ("rates.parquet", 3, "sample_rate_Hz is None, which is no number"),
        ("taken.parquet", 2, "the file has columns that the table makes: echo_us; rename them"),
    ],
)
def test_the_command_says_in_a_line_what_is_wrong(
    words: str, code: int, told: str, made: Array, run: Run
) -> None:
    np.save("a.npy", made)
    np.save("none.npy", made[:0])
    with Path("vast.npy").open("wb") as file:
        told_there = {"descr": "<f8", "fortran_order": False, "shape": (10**15, 8)}
        np.lib.format.write_array_header_1_0(file, told_there)
    pa.parquet.write_table(lists(made, echo_us=[1.0] * 3, sample_rate_Hz=[RATE] * 3), "taken.parquet")
    pa.parquet.write_table(lists(made, sample_rate_Hz=[RATE, None, RATE]), "rates.parquet")
    ended, line = run("echo-times", *words.split())
    assert (ended, line.count("\n")) == (code, 1)
    assert told in line
