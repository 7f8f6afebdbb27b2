"""Results in a notebook: short, explained, as a table and as a figure."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import echocal
from echocal import Model

Seeded = Callable[..., np.random.Generator]


@pytest.fixture(scope="module")
def table(request: pytest.FixtureRequest, seeded: Seeded) -> dict[str, np.ndarray]:
    random = seeded(request)
    distance = np.tile([0.5, 1.0, 1.5, 2.0, 2.5, 3.0], 40)
    temperature = 15 + 10 * np.sin(np.arange(240) / 20)
    echo = 2 * distance / echocal.speed_of_sound(temperature, 0.5) + 40e-6 + random.normal(0, 3e-6, 240)
    return {
        "echo_s": echo,
        "distance_m": distance,
        "temperature_C": temperature,
        "humidity_percent": np.full(240, 50.0),
        "time_s": 60.0 * np.arange(240),
    }


@pytest.fixture(scope="module")
def results(table: dict[str, np.ndarray]) -> dict[str, object]:
    observations = echocal.read_observations(table)
    diagnosis = echocal.diagnose(table, base="cramer")
    start = Model("cramer", {"fixed_delay": {"delay": 0.0}})
    return {
        "Diagnosis": diagnosis,
        "Model": diagnosis.model,
        "Observations": observations,
        "Calibration": echocal.calibrate(observations, start, ["fixed_delay.delay"]),
        "Verification": echocal.verify(observations, maximum_permissible_error=3e-3),
        "Budget": echocal.budget(diagnosis.model, observations, trials=0),
    }


KINDS = ["Diagnosis", "Model", "Observations", "Calibration", "Verification", "Budget"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_shows_itself(results: dict[str, object], kind: str) -> None:
    result = results[kind]
    assert type(result).__name__ == kind
    assert len(repr(result)) < 400
    assert kind in repr(result)
    page = result._repr_html_()  # type: ignore[attr-defined]
    assert page.startswith("<p><b>")
    assert "<table" in page
    assert page.count('<img alt="') == page.count("data:image/png;base64,") == 1
    assert len(page) < 200_000
    frame = result.to_dataframe()  # type: ignore[attr-defined]
    assert isinstance(frame, pd.DataFrame)
    assert len(frame)
    figure = result.plot()  # type: ignore[attr-defined]
    assert isinstance(figure, Figure)
    assert all(ax.get_xlabel() for ax in figure.axes if ax.has_data())


def test_text_is_the_explanation(results: dict[str, object]) -> None:
    assert str(results["Diagnosis"]) == results["Diagnosis"].explain()  # type: ignore[attr-defined]
    assert "of 240 errors exceed 3 mm" in str(results["Verification"])
    assert "fixed_delay.delay" in str(results["Calibration"])
    assert "240 of 240 rows usable" in str(results["Observations"])


def test_a_verification_shows_its_guard_band_and_its_decision() -> None:
    table = {"reading_m": [1.0025, 2.0], "distance_m": [1.0, 2.0], "temperature_C": [20.0, 20.0]}
    plain = echocal.verify(table, maximum_permissible_error=3e-3)
    assert "No uncertainty is stated" in str(plain)
    assert "guard band" not in repr(plain)
    found = echocal.verify(table, maximum_permissible_error=3e-3, uncertainties={"tape": "II"})
    assert "Verification undecided: 0 of 2 errors exceed 3 mm" in repr(found)
    assert "with a guard band of 0.81 mm, 1 are undecided; the least probability" in repr(found)
    assert "within the bound less the guard band (JCGM 106:2012, 8.3)" in str(found)
    assert found.to_dataframe().loc["guard band", "[mm]"] == pytest.approx(1e3 * found.guard_band)


def test_tables_hold_the_numbers(results: dict[str, object], table: dict[str, np.ndarray]) -> None:
    causes = results["Diagnosis"].to_dataframe()  # type: ignore[attr-defined]
    assert causes["probability"].between(0, 1).all()
    diagnosis = results["Diagnosis"]
    parameters = [(c.id, p) for c in diagnosis.causes for p in c.parameters]  # type: ignore[attr-defined]
    told = causes.dropna(subset="value")
    assert list(told.index) == [cause for cause, _ in parameters]
    assert told["value"].tolist() == [p.value for _, p in parameters]
    assert told["standard_uncertainty"].tolist() == [p.standard_uncertainty for _, p in parameters]
    sentence = diagnosis.explain().partition("\n")[0]  # type: ignore[attr-defined]
    assert f"<p>{sentence}</p>" in diagnosis._repr_html_()  # type: ignore[attr-defined]
    rows = results["Observations"].to_dataframe()  # type: ignore[attr-defined]
    np.testing.assert_array_equal(rows["echo_time [s]"], table["echo_s"])
    (parameter,) = results["Calibration"].to_dataframe().itertuples()  # type: ignore[attr-defined]
    assert parameter.value == pytest.approx(40e-6, abs=2e-6)
    assert parameter.unit == "s"


def test_names_of_a_table_are_no_markup() -> None:
    found = echocal.read_observations({"echo_s": [0.01] * 3, "<script>x": [1.0, 2.0, 3.0]})
    assert "<script>" not in found._repr_html_()


def test_a_model_that_cannot_be_drawn_shows_itself() -> None:
    model = Model("linear", {"supply_voltage": {"slope": 6e-5}})
    with pytest.raises(echocal.EchocalError):
        model.plot()
    assert model._repr_html_().startswith("<p><b>Model")
