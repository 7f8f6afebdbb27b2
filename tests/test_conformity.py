"""What is in the uncertainty of an error, and what verify and certificate decide with it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import echocal
from echocal.budget.conformity import budget_of_errors
from echocal.budget.coverage import plus_minus
from echocal.cli import app
from echocal.report.html.certificate import certify

LOG = {"echo_us": [5846.0, 11690.0], "distance_m": [1.0, 2.0]}
BOUND = {"maximum_permissible_error": 4e-3}


@pytest.mark.parametrize("stated", [(), {"tape": "II"}])
def test_a_condition_stated_with_its_uncertainty_is_in_that_of_an_error(
    stated: tuple[()] | dict[str, str],
) -> None:
    law = echocal.Model("linear")
    by_at = echocal.read_observations(LOG, at={"temperature": "20+-2"})
    exact = echocal.read_observations(LOG, at={"temperature": "20"})
    more = {**dict(stated), "temperature_C": 2}
    wide, same = (
        certify(law, rows, uncertainties=u, **BOUND).conformity
        for rows, u in ((by_at, stated), (exact, more))
    )
    assert wide.expanded_uncertainty == pytest.approx(same.expanded_uncertainty)
    assert wide.expanded_uncertainty[1] > 13e-3
    found = echocal.verify(by_at, model=law, uncertainties=stated, **BOUND)
    assert (found.decision, found.passed) == ("undecided", False)
    assert found.guard_band == pytest.approx(wide.expanded_uncertainty.max())


def test_the_join_of_a_reference_is_in_the_uncertainty_of_an_error() -> None:
    table = echocal.read_observations({**LOG, "temperature_C": [20.0, 20.0]})
    joined = replace(table, reference_join_uncertainty=2e-3)
    for model in (None, echocal.Model("linear")):
        found = budget_of_errors(joined, model, np.array([1.0, 2.0]), ())
        assert [(e.quantity, e.evaluation) for e in found.entries] == [("reference_distance", "B")]
        assert found.standard_uncertainty.tolist() == [2e-3, 2e-3]
        assert echocal.verify(joined, model=model, **BOUND).guard_band == pytest.approx(4e-3, rel=1e-5)


def test_a_path_is_no_law() -> None:
    with pytest.raises(echocal.EchocalError, match=r"got 'level-model.json'; Model.load\(path\)"):
        echocal.budget("level-model.json", LOG)


def test_an_error_without_uncertainty_has_three_decimals() -> None:
    assert [plus_minus(x, 0.0, "mm") for x in (-3.10393, 4.99983e-09)] == ["-3.104 mm", "0 mm"]


@pytest.mark.parametrize(
    ("bound", "decision", "code"),
    [("9", "conforms", 0), ("4.5", "undecided", 5), ("1", "does not conform", 1)],
)
def test_verify_and_certificate_decide_alike(
    bound: str, decision: str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("reading_mm,distance_mm,temperature_C\n1998,2000,20\n2004,2000,20\n")
    echocal.Model("linear").save("model.json")
    given = ("--uncertainty", "temperature_C=0.3")
    verified = CliRunner().invoke(
        app, ["verify", "log.csv", "--model", "model.json", "--maximum-permissible-error-mm", bound, *given]
    )
    certified = CliRunner().invoke(
        app, ["certificate", "model.json", "log.csv", "-o", "c.html", "--mpe-mm", bound, *given]
    )
    assert (verified.exit_code, certified.exit_code) == (code, code)
    assert f"verification: {decision}" in verified.output
    assert f"{decision}: Of 2 errors" in certified.output


def test_the_height_of_a_model_is_that_of_its_levels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("Lvl,Stage,temperature_C\n0.6,0.6,20\n1.1,1.1,20\n")
    echocal.Model("linear", provenance={"mount_height_m": 2.6}).save("model.json")
    model = echocal.Model.load("model.json")
    columns = {"Lvl": "level_m", "Stage": "reference_level_m"}
    found = echocal.budget(model, "log.csv", columns=columns, trials=0)
    assert found.distance == pytest.approx([2.0, 1.5])
    assert echocal.verify("log.csv", model=model, columns=columns, **BOUND).passed
    flags = ("--column", "Lvl=level_m", "--column", "Stage=reference_level_m")
    for words in (
        ("verify", "log.csv", "--model", "model.json", "--maximum-permissible-error-mm", "1"),
        ("certificate", "model.json", "log.csv", "-o", "c.html"),
        ("budget", "model.json", "log.csv", "--trials", "0"),
    ):
        done = CliRunner().invoke(app, [*words, *flags])
        assert done.exit_code == 0, done.output
    with pytest.raises(echocal.UsageError, match="METERS"):
        echocal.verify("log.csv", columns=columns, **BOUND)
