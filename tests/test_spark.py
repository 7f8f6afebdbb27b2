"""The recipe of docs/dataframes.md on Spark."""

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal

sql = pytest.importorskip("pyspark.sql")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        shutil.which("java") is None and "JAVA_HOME" not in os.environ, reason="Spark needs Java"
    ),
]

ROWS, FILES = 20_000, 3
TEXT = Path(__file__).parents[1] / "examples" / "tank_model.json"


@pytest.fixture(scope="module")
def spark() -> Iterator[Any]:
    os.environ["PYSPARK_PYTHON"] = sys.executable
    session = sql.SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false").getOrCreate()
    yield session
    session.stop()


def test_the_same_bits_as_here(spark: Any, tmp_path: Path, random: np.random.Generator) -> None:
    """From Parquet to Parquet; rows have a key, since Spark keeps no order between files."""
    model, text = echocal.Model.load(TEXT), TEXT.read_text()
    for number in range(FILES):
        table = {
            "row": np.arange(number * ROWS, (number + 1) * ROWS),
            "time": random.uniform(0.002, 0.02, ROWS),
            "temperature": pa.array(random.uniform(0, 30, ROWS), mask=random.random(ROWS) < 0.1),
        }
        (tmp_path / "in").mkdir(exist_ok=True)
        pq.write_table(pa.table(table), tmp_path / "in" / f"{number}.parquet", row_group_size=5000)

    def corrected(batches: Iterator[Any]) -> Iterator[Any]:
        import tempfile

        import pyarrow as pa

        import echocal

        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write(text)
            file.flush()
            model = echocal.Model.load(file.name)
        for batch in batches:
            time = batch["time"].to_numpy()
            temperature = batch["temperature"].to_numpy(zero_copy_only=False)
            yield batch.append_column("distance", pa.array(model.distance(time, temperature=temperature)))

    echoes = spark.read.parquet(str(tmp_path / "in"))
    schema = "row long, time double, temperature double, distance double"
    echoes.mapInArrow(corrected, schema).write.parquet(str(tmp_path / "out"))
    found = pq.read_table(tmp_path / "out").sort_by("row")
    assert found["row"].to_pylist() == list(range(FILES * ROWS))
    temperature = found["temperature"].to_numpy()
    expected = model.distance(found["time"].to_numpy(), temperature=temperature)
    np.testing.assert_array_equal(found["distance"].to_numpy(), expected)
    assert 0 < np.isnan(expected).sum() < len(expected) / 2
