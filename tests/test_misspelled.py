"""A misspelled column: every command says which it may be, and lists the columns of the user's table."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.watch import Reference

MODEL = echocal.Model("linear")


@pytest.fixture
def table(random: np.random.Generator) -> dict[str, Any]:
    distance, celsius = np.tile([0.5, 1.0, 2.0], 20), random.uniform(5.0, 35.0, 60)
    reading = MODEL.indicate(distance, temperature=celsius) + random.normal(0.0, 1e-3, 60)
    return {
        "reading_m": reading,
        "temprature_C": celsius,
        "distance_m": distance,
        "remark": np.arange(60) % 7,
    }


def test_a_misspelled_temperature(table: dict[str, Any], tmp_path: Path) -> None:
    table["echo_us"] = 1e6 * 2.0 * table.pop("reading_m") / 343.0
    log = tmp_path / "log.csv"
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values(), strict=True))]
    log.write_text("\n".join(lines) + "\n")
    meant = r"did you mean: columns=\{'temprature_C': 'temperature_C'\}\? The table has: .*temprature_C"
    for call in (
        lambda: echocal.correct(table, MODEL),
        lambda: echocal.correct_files(log, tmp_path / "out.csv", MODEL),
        lambda: echocal.diagnose(table),
    ):
        with pytest.raises(echocal.DataError, match=meant) as told:
            call()
        assert "remark" in str(told.value).partition("The table has: ")[2]
    rows = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
    (corrected, _), *_ = echocal.watch(rows, MODEL, reference=Reference(correct_only=True))
    assert "did you mean: columns={'temprature_C': 'temperature_C'}" in str(corrected[0]["status"])


def test_a_misspelled_reference(table: dict[str, Any]) -> None:
    table["temperature_C"] = table.pop("temprature_C")
    table["distanse_m"] = table.pop("distance_m") + np.linspace(0.0, 1e-2, 60)
    with pytest.raises(echocal.DataError, match=r"did you mean: columns=\{'distanse_m': 'distance_m'\}"):
        echocal.verify(table, maximum_permissible_error=3e-3)


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_correction_names_the_column_that_it_would_not_read(kind: str, tmp_path: Path) -> None:
    """No column holds an echo, so none is left out of the table that the message is about."""
    table = pd.DataFrame({"ehco_us": [5000.0, 5100.0], "temperature_C": 20.0, "remark": ["ok", 'a "b"']})
    file = tmp_path / f"log.{kind}"
    getattr(table, f"to_{kind}")(file, index=False)
    told = r"ehco_us, temperature_C, remark\. Did you mean: columns=\{'ehco_us': 'echo_us'\}"
    with pytest.raises(echocal.DataError, match=told):
        echocal.correct_files(file, tmp_path / f"out.{kind}", echocal.Model("cramer"))
    with pytest.raises(echocal.DataError, match=told):
        echocal.correct(table, echocal.Model("cramer"))
