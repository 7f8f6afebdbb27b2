"""Verdicts on the study, each pinned by its numbers; another table brings another verdict."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from echocal import DataError
from echocal.study import Study, Tables, Verdict, claims, given, run
from echocal.study.origin import speed
from echocal.study.tables import Printed, Table

YES, NO, WRONG = Verdict.REPRODUCED, Verdict.NOT_REPRODUCED, Verdict.PHYSICALLY_WRONG


@pytest.fixture(scope="module")
def study() -> Study:
    return run()


VERDICTS = {
    "table1-speed": (NO, "0/26"),
    "table1-time": (YES, "26/26"),
    "table1-distance": (YES, "26/26"),
    "table1-error": (NO, "25/26"),
    "table1-sign": (NO, "10/26"),
    "table2-calculation": (NO, "12/27"),
    "table2-table1": (NO, "23/26"),
    "table2-tinkercad": (NO, "2/27"),
    "latency": (WRONG, "-44.8"),
    "increment-2": (NO, "2"),
    "increment-1": (NO, "2"),
    "rmse-calculation": (YES, "53.50"),
    "mae-calculation": (YES, "45.00"),
    "rmse-tinkercad": (YES, "56.57"),
    "mae-tinkercad": (YES, "47.26"),
    "r-calculation": (YES, "-0.9997"),
    "r-tinkercad": (YES, "-0.9987"),
    "agreement-rmse": (YES, "8.00"),
    "agreement-mae": (YES, "7.67"),
    "agreement-r": (YES, "0.9990"),
    "line-slope": (YES, "-0.0034349"),
    "line-intercept": (YES, "2.0681"),
    "line-r2": (YES, "0.99938"),
    "parabola-square": (YES, "6.1337e-06"),
    "parabola-slope": (YES, "-0.0037427"),
    "parabola-intercept": (YES, "2.0706"),
    "parabola-r2": (YES, "0.99996"),
    "compensation-table1": (YES, "0.033–0.058"),
    "compensation-table2": (YES, "0.028–0.053"),
    "compensation-tinkercad": (NO, "0.526–0.551"),
    "compensation-air": (WRONG, "0.68"),
    "thermometer": (NO, "±1.8 mm"),
    "uncompensated": (YES, "-5.05"),
    "error-0": (YES, "+3.55"),
    "error-50": (YES, "-5.05"),
    "millimeters-0": (YES, "+71"),
    "millimeters-50": (YES, "-101"),
    "near-zero": (NO, "1.998–2.002"),
    "smallest-error": (YES, "19.33"),
    "abstract-5": (YES, "5.06"),
    "both-extremes": (NO, "3.53 and 5.06"),
    "conclusion-extremes": (NO, "3.53 and 5.06"),
    "datasheet": (YES, "18.5–20.2 °C"),
    "ascription": (WRONG, "331.67 + 0.579 T"),
    "validity": (WRONG, "0.28"),
    "rise": (YES, "0.600"),
    "speed-20": (YES, "343.4"),
    "humidity-coefficient": (WRONG, "3.6e-05"),
    "humidity-gain": (WRONG, "1.6"),
    "humidity-negligible": (WRONG, "7.2"),
    "pressure-exponent": (WRONG, "-0.0016"),
    "pressure-percent": (WRONG, "4.9"),
    "pressure-altitude": (WRONG, "-224"),
}


def test_every_claim_is_pinned() -> None:
    assert [claim.id for claim in claims()] == list(VERDICTS)


@pytest.mark.parametrize("name", VERDICTS)
def test_verdict(study: Study, name: str) -> None:
    verdict, recomputed = VERDICTS[name]
    assert (study[name].verdict, study[name].recomputed) == (verdict, recomputed)
    assert study[name].because


def test_true_air_stands_beside(study: Study) -> None:
    cells = {cell.temperature: cell for cell in study["table1-speed"].cells}
    # the other law for humid air, which holds its 300 ppm up to this water content
    for at in (0.0, 20.0, 46.0):
        assert cells[at].physical == pytest.approx(
            float(speed("cramer", at, relative_humidity=0.5)), rel=300e-6
        )
    assert study["smallest-error"].numbers["half"] == pytest.approx(18.45, abs=0.01)
    assert study["compensation-air"].numbers["saturated"] == pytest.approx(1.64, abs=0.01)
    assert study["pressure-percent"].numbers["true_high"] == pytest.approx(-0.014, abs=0.001)


def test_the_tables_give_away_their_making(study: Study) -> None:
    found = {discovery.id: discovery for discovery in study.discoveries}
    law = found["law"].numbers
    assert abs(law["intercept"] - 331.3) < 2.0 * law["intercept_u"]
    assert found["thermometer"].numbers == {"exact": 6, "best": 25, "bits": 10}
    assert "needs 10.20 °C, and the converter gives 10.02: the same digits" in found["thermometer"].text
    assert found["second_table"].numbers == {"stated": 12, "table_law": 27, "rows": 27}
    assert found["odd_row"].numbers["temperature"] == 6.0
    assert found["odd_row"].numbers["twin"] == 4.0
    assert "zero_error.offset and clock_error.frequency_error" in found["change"].text


def test_what_explains_tinkercad(study: Study) -> None:
    values = {a.cause: a.estimate.value for a in study.alternatives}
    assert values["zero_error.offset"] == pytest.approx(-7.74e-3, abs=5e-5)
    assert values["fixed_delay.delay"] == pytest.approx(-44.8e-6, abs=5e-7)
    left = [a.residual_standard_deviation for a in study.alternatives]
    assert left == sorted(left)
    assert left[-1] / left[0] < 1.05  # one distance cannot tell them apart


def changed(table: Table, column: str, edit: dict[float, str]) -> Table:
    """The table with other numbers printed at some temperatures."""
    cells = tuple(
        Printed(edit.get(float(t), number.text))
        for t, number in zip(table.temperature, table.columns[column], strict=True)
    )
    return replace(table, columns={**table.columns, column: cells})


@pytest.mark.slow
def test_one_other_cell_changes_the_verdict() -> None:
    tables = Tables.load()
    first = changed(tables.table1, "measured_distance_m", {30.0: "1.966"})
    second = changed(tables.table2, "measured_distance_calculation_m", {0.0: "2.091"})
    study = run(Tables(first, second))
    cells = {cell.temperature: cell for cell in study["table1-distance"].cells}
    assert [t for t, cell in cells.items() if cell.verdict is NO] == [30.0]
    for name in ("table1-distance", "rmse-calculation", "line-intercept", "compensation-table2"):
        assert study[name].verdict is NO, name


def test_a_table_by_the_stated_law_is_reproduced() -> None:
    """Written with 331.4 + 0.6 T and signs, Table 1 would have stood."""
    tables = Tables.load()
    t = tables.table1.temperature
    fast = 331.4 + 0.6 * t  # oracle: the study's equation as it stands
    error = (343.0 / fast - 1.0) * 100.0
    first = changed(tables.table1, "actual_speed_m_s", {a: f"{b:.3f}" for a, b in zip(t, fast, strict=True)})
    first = changed(first, "error_percent", {a: f"{b:.3f}" for a, b in zip(t, error, strict=True)})
    first = changed(
        first, "measured_distance_m", {a: f"{686.0 / b:.3f}" for a, b in zip(t, fast, strict=True)}
    )
    study = run(Tables(first, tables.table2))
    for name in ("table1-speed", "table1-time", "table1-distance", "table1-sign"):
        assert study[name].verdict is YES, name
    law = study.discoveries[0].numbers
    assert law["intercept"] == pytest.approx(331.4, abs=1e-6)
    assert study.discoveries[1].title == "Table 1's temperatures are as printed"


def test_readings_that_are_late_may_be_latency() -> None:
    tables = Tables.load()
    t2 = tables.table2.temperature
    late = {
        t: f"{v + 0.008:.3f}"
        for t, v in zip(t2, tables.table2.values("measured_distance_calculation_m"), strict=True)
    }
    study = run(Tables(tables.table1, changed(tables.table2, "measured_distance_tinkercad_m", late)))
    assert study["latency"].verdict is YES
    assert study["latency"].numbers["delay_us"] == pytest.approx(46.6, abs=1.0)


def test_tables_as_in_the_study(shared: Path) -> None:
    for name in ("table1", "table2"):
        table = getattr(Tables.load(), name)
        theirs = np.genfromtxt(shared / "study" / f"{name}.csv", delimiter=",", skip_header=1)
        np.testing.assert_array_equal(
            np.transpose([table.values(column) for column in table.columns]), theirs
        )


def test_unreadable_table(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"cannot read table1\.csv"):
        Tables.load(tmp_path)
    (tmp_path / "table1.csv").write_text("# source\ntemperature_C\n0\n")
    with pytest.raises(DataError, match="has 1 columns, not 7"):
        Tables.load(tmp_path)


def test_what_is_not_judged_is_said() -> None:
    assert all(entry["number"] and entry["why"] for entry in given())
