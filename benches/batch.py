"""Correct a large file: echocal beside polars and pandas, each in a process of its own, in turns.

    python benches/batch.py --rows 4e7 --turns 3          the table of docs/batch.md, as JSON on stdout
    python benches/batch.py --rows 1e6 --kind csv

Every way reads the same seven columns, corrects for temperature, humidity and pressure by Cramer's law, and
writes all columns and the distance; `read and write` computes nothing. Elapsed time, time of the processor,
peak memory (VmHWM) and size of the output; the fastest of the turns.
"""

import argparse
import importlib
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

GROUP = 1 << 18  # rows of a row group
PART = 1 << 20  # rows that are generated at a time


def generate(path: Path, rows: int, seed: int) -> None:
    """Rows of a fleet: what a logger writes, with the digits that it has."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    random = np.random.default_rng(seed)
    writer = None
    for begin in range(0, rows, PART):
        count = min(PART, rows - begin)
        columns = {
            "time": ((begin + np.arange(count)) * 1000).astype("datetime64[ms]"),
            "sensor_id": random.integers(0, 1000, count).astype(np.int32),
            "echo_us": np.round(random.uniform(2000, 20_000, count)),
            "temperature_C": np.round(random.uniform(-10, 30, count), 2),
            "humidity_percent": np.round(random.uniform(10, 95, count), 1),
            "pressure_Pa": np.round(random.uniform(95_000, 103_000, count), -1),
            "battery_V": np.round(random.uniform(3, 4.2, count), 2),
        }
        table = pa.table(columns)
        writer = writer or pq.ParquetWriter(path, table.schema, compression="zstd", compression_level=1)
        writer.write_table(table, row_group_size=GROUP)
    assert writer is not None
    writer.close()


def echocal_files(source: Path, out: Path) -> None:
    import echocal

    echocal.correct_files(source, out, echocal.Model("cramer"), memory="512MB")


def _lazy(source: Path):
    import polars as pl

    return pl.scan_parquet(source) if source.suffix == ".parquet" else pl.scan_csv(source)


def _sink(frame, out: Path) -> None:
    if out.suffix == ".parquet":
        frame.sink_parquet(out, compression="zstd", compression_level=1)
    else:
        frame.sink_csv(out)


def polars_read_and_write(source: Path, out: Path) -> None:
    _sink(_lazy(source), out)


def polars_expression(source: Path, out: Path) -> None:
    import polars as pl
    from peers import cramer

    t, h, p = pl.col("temperature_C"), pl.col("humidity_percent") / 100, pl.col("pressure_Pa")
    speed = cramer(t, h, p, exp=lambda x: x.exp())
    _sink(_lazy(source).with_columns((pl.col("echo_us") * 0.5e-6 * speed).alias("corrected_distance_m")), out)


def pandas_and_numpy(source: Path, out: Path) -> None:
    import pandas as pd
    from peers import cramer

    text = source.suffix == ".csv"
    table = pd.read_csv(source) if text else pd.read_parquet(source)
    speed = cramer(table["temperature_C"], table["humidity_percent"] / 100, table["pressure_Pa"])
    table["corrected_distance_m"] = table["echo_us"] * 0.5e-6 * speed
    if text:
        table.to_csv(out, index=False)
    else:
        table.to_parquet(out, compression="zstd", compression_level=1)


WAYS: dict[str, Callable[[Path, Path], None]] = {
    "echocal": echocal_files,
    "polars, read and write": polars_read_and_write,
    "polars, expression": polars_expression,
    "pandas and numpy": pandas_and_numpy,
}


IMPORTS = {
    "echocal": [
        "echocal.correct.parquet.file",
        "echocal.correct.text.file",
        "echocal.model.plain",
    ],
    "polars, read and write": ["polars"],
    "polars, expression": ["polars", "peers"],
    "pandas and numpy": ["pandas", "pyarrow.parquet", "peers"],
}
"""What each way imports."""


def child(way: str, source: Path, out: Path) -> None:
    """Run one way, and print its figures; imports are not counted."""
    for module in IMPORTS[way]:
        importlib.import_module(module)
    begun, used = time.perf_counter(), os.times()
    WAYS[way](source, out)
    elapsed, now = time.perf_counter() - begun, os.times()
    status = Path("/proc/self/status").read_text().splitlines()
    peak = next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    processor = now.user + now.system - used.user - used.system
    figures = {"seconds": elapsed, "processor_s": processor, "peak_MiB": peak / 1024}
    print(json.dumps({**figures, "output_MB": out.stat().st_size / 1e6}))


def main() -> None:
    """Measure all ways in turns."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rows", type=float, default=4e7)
    options.add_argument("--kind", choices=["parquet", "csv"], default="parquet")
    options.add_argument("--turns", type=int, default=3)
    options.add_argument("--ways", nargs="*", default=list(WAYS))
    options.add_argument("--child", nargs=3)
    given = options.parse_args()
    if given.child:
        child(given.child[0], *map(Path, given.child[1:]))
        return
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "in.parquet"
        generate(source, int(given.rows), 1)
        if given.kind == "csv":
            polars_read_and_write(source, source.with_suffix(".csv"))
            source = source.with_suffix(".csv")
        found: dict[str, list[dict[str, float]]] = {way: [] for way in given.ways}
        for _ in range(given.turns):
            for way in given.ways:
                out = Path(folder) / f"out{source.suffix}"
                command = [sys.executable, __file__, "--child", way, str(source), str(out)]
                told = subprocess.run(command, capture_output=True, text=True, check=True)
                found[way].append(json.loads(told.stdout.splitlines()[-1]))
                out.unlink()
        size = source.stat().st_size / 1e6
    fastest = {way: min(own, key=lambda figures: figures["seconds"]) for way, own in found.items()}
    machine = f"{platform.machine()}, {os.cpu_count()} processors"
    print(json.dumps({"rows": given.rows, "input_MB": size, "machine": machine, "ways": fastest}, indent=1))


if __name__ == "__main__":
    main()
