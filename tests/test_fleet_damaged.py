"""Damaged files in a fleet that is diagnosed: they fail with a reason, and the others have their verdicts."""

from pathlib import Path
from typing import Any

import damaged
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from echocal.fleet import diagnose_fleet, tables, task


def write(path: Path, random: np.random.Generator, rows: int = 40) -> None:
    columns = {
        "sensor_id": pa.array([f"s{row % 2}" for row in range(rows)]),
        "echo_us": random.normal(11660, 3, rows),
        "temperature_C": np.full(rows, 20.0),
        "distance_m": np.full(rows, 2.0),
    }
    pq.write_table(
        pa.table(columns), path, write_page_checksum=True, compression="none", use_dictionary=["sensor_id"]
    )


@pytest.mark.parametrize("by", [None, "sensor_id"])
def test_one_bit_of_a_page_with_a_checksum(
    by: str | None, random: np.random.Generator, tmp_path: Path
) -> None:
    """Another number had been diagnosed."""
    for name in ("sound", "bit"):
        write(tmp_path / f"{name}.parquet", random)
    data = bytearray((tmp_path / "bit.parquet").read_bytes())
    chunk = pq.ParquetFile(tmp_path / "bit.parquet").metadata.row_group(0).column(1)
    data[chunk.data_page_offset + chunk.total_compressed_size - int(random.integers(1, 300))] ^= 64
    (tmp_path / "bit.parquet").write_bytes(data)
    fleet = diagnose_fleet(tmp_path, by, workers=1)
    failed = {row["sensor"]: row["reason"] for row in fleet.rows if row["verdict"] == "failed"}
    assert set(failed) == ({"bit"} if by is None else {"s0", "s1"})
    assert all("bit.parquet is damaged" in why and "CRC checksum" in why for why in failed.values())


def test_damaged_files_fail_alone(random: np.random.Generator, tmp_path: Path) -> None:
    write(tmp_path / "sound.parquet", random)
    sound = (tmp_path / "sound.parquet").read_bytes()
    for number in range(12):
        damage = damaged.spoiled_footer if number % 2 else damaged.spoiled
        (tmp_path / f"{number:02}.parquet").write_bytes(damage(sound, random))
    fleet = diagnose_fleet(tmp_path, workers=1)
    assert {row["sensor"]: row["verdict"] for row in fleet.rows}["sound"] != "failed"
    told = [str(row["reason"]) for row in fleet.rows if row["verdict"] == "failed"]
    assert len(fleet.rows) + sum("set aside" in note for note in fleet.summary["notes"]) == 13
    assert all(told)


def test_a_panic_of_a_library_is_that_of_its_file(
    random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a damaged footer makes polars: it is no `Exception`."""

    class Panic(BaseException):
        pass

    read = tables.Opened.read

    def broken(self: tables.Opened, *given: Any, **more: Any) -> Any:
        def panic() -> None:
            raise Panic("index out of bounds")

        return tables._tried(self.path, panic) if self.path.stem == "0" else read(self, *given, **more)

    monkeypatch.setattr(tables.Opened, "read", broken)
    for number in range(2):
        write(tmp_path / f"{number}.parquet", random)
    fleet = diagnose_fleet(tmp_path, workers=1)
    assert [row["sensor"] for row in fleet.rows if row["verdict"] != "failed"] == ["1"]
    assert any("0.parquet: unexpected Panic: index out of bounds" in note for note in fleet.summary["notes"])


def test_a_panic_in_a_diagnosis_is_that_of_its_sensor(
    random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Panic(BaseException):
        pass

    diagnosed, seen = task._diagnosed, []

    def broken(*given: Any) -> Any:
        seen.append(given)
        if len(seen) == 1:
            raise Panic("index out of bounds")
        return diagnosed(*given)

    monkeypatch.setattr(task, "_diagnosed", broken)
    write(tmp_path / "log.parquet", random)
    fleet = diagnose_fleet(tmp_path, "sensor_id", workers=1)
    failed, other = fleet.rows
    assert failed["verdict"] == "failed"
    assert failed["reason"].startswith("unexpected Panic: index out of bounds (")
    assert other["verdict"] != "failed"
