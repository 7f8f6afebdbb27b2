"""``echocal calibrate``, from a table to a model file."""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from echocal import Model
from echocal.cli import app, main


@pytest.fixture
def table(tmp_path: Path) -> Path:
    distance = np.tile([0.5, 1.0, 2.0, 3.0], 10)
    temperature = np.linspace(5.0, 35.0, 40)
    echo = Model("linear", {"fixed_delay": {"delay": 40e-6}}).time_of_flight(
        distance, temperature=temperature
    )
    path = tmp_path / "bench.csv"
    frame = pd.DataFrame({"distance_m": distance, "temperature_C": temperature, "echo_us": echo * 1e6})
    frame.to_csv(path, index=False)
    return path


def test_writes_a_model_with_uncertainties(table: Path) -> None:
    out = table.with_name("model.json")
    arguments = [
        "calibrate",
        str(table),
        "--fit",
        "fixed_delay",
        "--fit",
        "zero_error.offset",
        "--law",
        "linear",
    ]
    result = CliRunner().invoke(app, [*arguments, "-o", str(out)])
    assert result.exit_code == 0, result.output
    assert "40 of 40 rows used" in result.output
    assert "zero_error.offset are correlated" in result.output.replace("\n", " ")
    model = Model.load(out)
    assert model.effects["fixed_delay"]["delay"] == pytest.approx(40e-6, rel=1e-6)
    assert model.covariance is not None


def test_json_and_quiet(table: Path) -> None:
    arguments = ["calibrate", str(table), "--fit", "fixed_delay", "--law", "linear", "--quiet", "--json", "-"]
    result = CliRunner().invoke(app, arguments)
    assert json.loads(result.stdout)["parameters"][0]["name"] == "fixed_delay.delay"


def test_a_mistake_is_one_line(
    table: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["echocal", "calibrate", str(table), "--fit", "fixed_dely"])
    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith("echocal: unknown effect 'fixed_dely'")
    assert error.count("\n") == 1
