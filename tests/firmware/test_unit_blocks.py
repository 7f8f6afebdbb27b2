"""Blocks of unit data, one or a folder of them: nothing is lost, and nothing is half written."""

import contextlib
import csv
import io
import json
import sys
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from echocal import Model
from echocal.cli import main
from echocal.errors import DataError, EchocalError, UsageError
from echocal.per_unit import TABLE, Block, Box, block_of, crc16, write_units

MODEL = Model("cramer", {"fixed_delay": {"delay": 31e-6}})


def of(delay: float, clock: float, law: str = "cramer", **more: dict[str, float]) -> Model:
    return Model(law, {"fixed_delay": {"delay": delay}, "clock_error": {"frequency_error": clock}, **more})


def run(*words: str | Path, exit_code: int = 0) -> str:
    said = io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["echocal", *map(str, words)]),
        contextlib.redirect_stdout(said),
        contextlib.redirect_stderr(said),
        pytest.raises(SystemExit) as stopped,
    ):
        main()
    assert int(stopped.value.code or 0) == exit_code, said.getvalue()
    return said.getvalue()


@pytest.fixture
def fleet(tmp_path: Path, random: np.random.Generator) -> tuple[Path, dict[str, Model]]:
    folder = tmp_path / "models"
    folder.mkdir()
    models = {
        f"unit_{n:05d}": of(random.uniform(0, 8e-5), random.uniform(-1.9e-3, 1.9e-3)) for n in range(40)
    }
    for name, model in models.items():
        model.save(folder / f"{name}.json")
    return folder, models


def test_the_checksum_has_its_check_value() -> None:
    assert crc16(b"123456789") == 0x29B1
    assert crc16(b"") == 0xFFFF


def test_a_block_reads_back_and_a_damaged_one_does_not(random: np.random.Generator) -> None:
    for _ in range(50):
        number = int(random.integers(2**32))
        delay, rate = (int(one) for one in random.integers(-(2**15), 2**15, 2))
        block = Block(number, delay, rate)
        data = block.to_bytes()
        assert Block.from_bytes(data) == block
        place = int(random.integers(8 * len(data)))
        spoiled = bytearray(data)
        spoiled[place // 8] ^= 1 << place % 8
        with pytest.raises(DataError, match="version" if place < 8 else "CRC"):
            Block.from_bytes(bytes(spoiled))
    with pytest.raises(DataError, match="has 12 bytes, not 11"):
        Block.from_bytes(data[:-1])


def test_steps_hold_the_parameters_to_half_a_step(random: np.random.Generator) -> None:
    box = Box.widest(MODEL)
    delay, clock = (side.parameter for side in box.sides)
    for late, fast in zip(random.uniform(-2e-4, 2e-4, 200), random.uniform(-0.05, 0.05, 200), strict=True):
        block = block_of(of(late, fast), 1, box, None, "unit")
        assert abs(delay.read(block.delay) - late) <= 0.5e-6 / 32 * (1 + 1e-9)
        assert abs(clock.read(block.rate) - fast) <= 0.5 / 2**19 * 1.06**2


def test_a_unit_that_does_not_fit_is_refused_with_both_sides_and_the_way_out() -> None:
    box = Box.around(MODEL, ["fixed_delay=0:1e-4", "clock_error"])
    with pytest.raises(
        DataError, match=r"u: fixed_delay.delay is 0.00012 s, outside the box 0 .. 0.0001 s: .*wider"
    ):
        block_of(of(120e-6, 0.0), 1, box, MODEL, "u")
    with pytest.raises(
        DataError, match=r"u: clock_error.frequency_error is -0.01, outside the box -0.0019 .. "
    ):
        block_of(of(0.0, -0.01), 1, box, MODEL, "u")
    with pytest.raises(
        DataError, match=r"u: the law is linear, and in the firmware's model cramer\. A block holds"
    ):
        block_of(of(0.0, 0.0, "linear"), 1, box, MODEL, "u")
    with pytest.raises(DataError, match=r"u: zero_error.offset is 0.002, and in the firmware's model absent"):
        block_of(of(0.0, 0.0, zero_error={"offset": 2e-3}), 1, box, MODEL, "u")
    alone = Box.around(MODEL, ["fixed_delay"])
    with pytest.raises(
        DataError, match=r"frequency_error is 0.001, and that of the firmware's model 0; it is no par"
    ):
        block_of(of(0.0, 1e-3), 1, alone, MODEL, "u")
    with pytest.raises(DataError, match="number 4294967296 is outside"):
        block_of(MODEL, 2**32, box, MODEL, "u")


def test_a_folder_of_models_becomes_a_folder_of_blocks(fleet: tuple[Path, dict[str, Model]]) -> None:
    folder, models = fleet
    told: list[tuple[int, int]] = []
    out = folder.parent / "blocks"
    done = write_units(folder, out, model=MODEL, progress=lambda *at: told.append(at))
    assert (done.written, dict(done.refused)) == (len(models), {})
    assert told[-1] == (len(models), len(models))
    assert {path.name for path in out.iterdir()} == {TABLE, *(f"{name}.bin" for name in models)}
    with (out / TABLE).open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    for number, (row, (name, model)) in enumerate(zip(rows, models.items(), strict=True)):
        data = (out / row["block_file"]).read_bytes()
        assert (row["file"], row["status"], row["number"]) == (f"{name}.json", "written", str(number))
        assert bytes.fromhex(row["block"]) == data
        assert (float(row["frequency_error"]), row["model_hash"]) == (
            model.effects["clock_error"]["frequency_error"],
            model.hash,
        )
        assert Block.from_bytes(data) == block_of(model, number, Box.widest(MODEL), MODEL, name)
    assert [path.name for path in folder.parent.iterdir() if "unfinished" in path.name] == []


def test_each_refused_unit_has_a_row_with_the_reason(fleet: tuple[Path, dict[str, Model]]) -> None:
    folder, models = fleet
    of(150e-6, 0.0).save(folder / "unit_00007.json")
    (folder / "unit_00009.json").write_text("{")
    out = folder.parent / "blocks"
    text = run("firmware", "--units", folder, "-o", out, write_model(folder), exit_code=3)
    assert "2 of 40 units were refused" in text.replace("\n", " ")
    rows = {row["file"]: row for row in csv.DictReader((out / TABLE).read_text().splitlines())}
    assert len(rows) == len(models)
    assert "fixed_delay.delay is 0.00015 s, outside the box" in rows["unit_00007.json"]["status"]
    assert "JSON" in rows["unit_00009.json"]["status"]
    written = {path.stem for path in out.glob("*.bin")}
    assert written == {*models} - {"unit_00007", "unit_00009"}


def write_model(folder: Path) -> Path:
    path = folder.parent / "model.json"
    MODEL.save(path)
    return path


def test_an_earlier_folder_is_replaced_as_a_whole_and_nothing_else_is(
    fleet: tuple[Path, dict[str, Model]], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, models = fleet
    out = folder.parent / "blocks"
    write_units(folder, out)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    (folder / "unit_00003.json").unlink()

    class StoppedError(Exception):
        pass

    def stop(done: int, total: int) -> None:
        if done == 20:
            raise StoppedError

    with pytest.raises(StoppedError):
        write_units(folder, out, progress=stop)
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    assert sorted(path.name for path in folder.parent.iterdir()) == ["blocks", "models"]
    write_units(folder, out)
    assert {path.stem for path in out.glob("*.bin")} == {*models} - {"unit_00003"}
    (out / "mine.txt").write_text("precious")
    with pytest.raises(UsageError, match=r"has mine.txt, which no earlier run made.*move that file"):
        write_units(folder, out)
    with pytest.raises(UsageError, match="holds the models of the units"):
        write_units(folder, folder)
    with pytest.raises(UsageError, match="holds the models of the units"):
        write_units(folder, folder.parent)
    assert (out / "mine.txt").read_text() == "precious"


def test_numbers_come_from_names_and_are_of_one_unit(fleet: tuple[Path, dict[str, Model]]) -> None:
    folder, _ = fleet
    MODEL.save(folder / "other_7.json")
    with pytest.raises(DataError, match=r"other_7.json and unit_00007.json are both unit 7"):
        write_units(folder, folder.parent / "blocks")
    (folder / "other_7.json").rename(folder / "tank.json")
    with pytest.raises(DataError, match=r"tank.json: its name does not end in the number of the unit"):
        write_units(folder, folder.parent / "blocks")
    assert not (folder.parent / "blocks").exists()
    with pytest.raises(UsageError, match=r"has no file \*.json"):
        write_units(folder.parent, folder.parent / "blocks")


def test_the_command_writes_one_block(tmp_path: Path, fleet: tuple[Path, dict[str, Model]]) -> None:
    folder, models = fleet
    unit = folder / "unit_00012.json"
    out = tmp_path / "unit.bin"
    text = run("firmware", "--unit-data", unit, "-o", out)
    assert "no model of the firmware was given" in text.replace("\n", " ")
    expected = block_of(models["unit_00012"], 12, Box.widest(MODEL), None, "")
    assert Block.from_bytes(out.read_bytes()) == expected
    report = tmp_path / "block.json"
    run(
        "firmware",
        write_model(folder),
        "--unit-data",
        unit,
        "-o",
        out,
        "--unit-number",
        "99",
        "--json",
        report,
    )
    assert Block.from_bytes(out.read_bytes()) == Block(99, expected.delay, expected.rate)
    found = json.loads(report.read_text())
    assert (found["schema"], found["number"], found["block"]) == (
        "echocal.unit_data/1",
        99,
        out.read_bytes().hex(),
    )
    note = tmp_path / "note.txt"
    note.write_text("mine")
    assert "--force" in run("firmware", "--unit-data", unit, "-o", note, exit_code=2)
    assert note.read_text() == "mine"
    run("firmware", "--unit-data", unit, "--units", folder, "-o", out, exit_code=2)
    run("firmware", "--units", folder, "--unit-number", "3", "-o", out, exit_code=2)
    run("firmware", "-o", out, exit_code=2)
    narrow = run(
        *(
            "firmware",
            write_model(folder),
            "--unit-data",
            unit,
            "-o",
            out,
            "--per-unit",
            "fixed_delay=3e-5:3.2e-5",
        ),
        exit_code=3,
    )
    assert "--per-unit" in narrow


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--units", "models", "--sensor", "SHT31", "--echo-lsb-us", "4"), "--echo-lsb-us, --sensor would"),
        (("--units", "models", "--force"), "--force would do nothing"),
        (("--units", "models", "--unit-number", "3"), "--unit-number 3 does nothing without --unit-data"),
        (("--unit-data", "models/unit_00012.json", "--target", "c99"), "--target would do nothing"),
    ],
)
def test_options_of_a_function_are_refused_with_blocks(
    words: tuple[str, ...],
    told: str,
    fleet: tuple[Path, dict[str, Model]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(fleet[0].parent)
    assert told in " ".join(run("firmware", *words, "-o", "blocks", exit_code=2).split())
    assert not Path("blocks").exists()


def test_the_command_writes_the_files_that_it_records(tmp_path: Path) -> None:
    model = tmp_path / "MODEL.json"
    MODEL.save(model)
    words = ("--temperature-lsb", "2", "--per-unit", "fixed_delay", "--per-unit", "clock_error=-0.002:0.003")
    run("firmware", model, *words, "-o", tmp_path / "first")
    report = json.loads((tmp_path / "first" / "report.json").read_text())
    _, _, recorded, *rest = report["provenance"]["command"].split()
    assert recorded == "MODEL.json"
    run(
        "firmware",
        model,
        *rest[: rest.index("--out")],
        *rest[rest.index("--out") + 2 :],
        "-o",
        tmp_path / "again",
    )
    for path in (tmp_path / "first").rglob("*.[ch]"):
        again = tmp_path / "again" / path.relative_to(tmp_path / "first")
        assert path.read_text() == again.read_text(), path.name


def test_a_model_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(EchocalError):
        write_units(tmp_path / "absent", tmp_path / "out")
