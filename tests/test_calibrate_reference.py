"""Reference fits: certified values of the NIST Statistical Reference Datasets, and lmfit as a rival.

The certified values stand on the page of each dataset that its file names.
"""

from dataclasses import dataclass, field
from pathlib import Path

import lmfit
import numpy as np
import pandas as pd
import pytest

from echocal import Calibration, Model, Regression, calibrate
from echocal.calibrate import Parameter
from echocal.observations import Observations

NIST = Path(__file__).parent / "nist"


def table(name: str) -> Observations:
    frame = pd.read_csv(NIST / f"{name}.csv", comment="#", dtype=float)
    empty = np.full(len(frame), "")
    extra = {column: frame[column].to_numpy() for column in frame}
    return Observations(np.full(len(frame), np.nan), {}, None, empty, extra=extra)


LINEAR = {
    "norris": (
        Regression.polynomial("x", 1, response="y"),
        [-0.262323073774029, 1.00211681802045],
        [0.232818234301152, 0.429796848199937e-3],
        (0.884796396144373, 0.999993745883712),
    ),
    "wampler4": (
        Regression.polynomial("x", 5, response="y"),
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [
            215232.624678170,
            236355.173469681,
            77934.3524331583,
            10147.5507550350,
            564.566512170752,
            11.2324854679312,
        ],
        (236014.502379268, 0.957478440825662),
    ),
    "longley": (
        Regression(("1", "x1", "x2", "x3", "x4", "x5", "x6"), response="y"),
        [
            -3482258.63459582,
            15.0618722713733,
            -0.358191792925910e-1,
            -2.02022980381683,
            -1.03322686717359,
            -0.511041056535807e-1,
            1829.15146461355,
        ],
        [
            890420.383607373,
            84.9149257747669,
            0.334910077722432e-1,
            0.488399681651699,
            0.214274163161675,
            0.226073200069370,
            455.478499142212,
        ],
        (304.854073561965, 0.995479004577296),
    ),
}


@pytest.mark.parametrize("name", LINEAR)
def test_linear_reference(name: str) -> None:
    form, values, deviations, (residual, r_squared) = LINEAR[name]
    found = calibrate(table(name), form)
    # wampler4's noise is 2e5 times its coefficients, which costs the last digits in double precision
    np.testing.assert_allclose(found.values, values, rtol=1e-7 if name == "wampler4" else 1e-9)
    np.testing.assert_allclose(found.standard_uncertainties, deviations, rtol=1e-9)
    assert found.residual_standard_deviation == pytest.approx(residual, rel=1e-12)
    assert found.r_squared == pytest.approx(r_squared, rel=1e-12)


@dataclass
class Misra:
    """y = b1 g(b2 x), three saturating curves for the same adsorption data."""

    kind: str
    start: tuple[float, float]
    unit: str = "1"
    has_intercept: bool = True
    linear: bool = False
    calls: list[int] = field(default_factory=list)

    @property
    def parameters(self) -> list[Parameter]:
        return [Parameter(name, start=value) for name, value in zip(("b1", "b2"), self.start, strict=True)]

    def observed(self, observations: Observations) -> np.ndarray:
        return observations.extra["y"]

    def columns(self, observations: Observations) -> dict[str, np.ndarray]:
        return {"x": observations.extra["x"]}

    def evaluate(self, values: np.ndarray, columns: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        (b1, b2), x = values, columns["x"]
        u = b2 * x
        value, slope = {
            "a": lambda: (1.0 - np.exp(-u), np.exp(-u)),
            "b": lambda: (1.0 - (1.0 + u / 2.0) ** -2.0, (1.0 + u / 2.0) ** -3.0),
            "d": lambda: (u / (1.0 + u), (1.0 + u) ** -2.0),
        }[self.kind]()
        return b1 * value, np.stack([value, b1 * slope * x], axis=-1)

    def fitted(self, values: np.ndarray, covariance: np.ndarray) -> np.ndarray:
        return values


NONLINEAR = {
    "a": ([2.3894212918e2, 5.5015643181e-4], [2.7070075241, 7.2668688436e-6], 1.0187876330e-1),
    "b": ([3.3799746163e2, 3.9039091287e-4], [3.1643950207, 4.2547321834e-6], 7.9301471998e-2),
    "d": ([4.3736970754e2, 3.0227324449e-4], [3.6489174345, 2.9334354479e-6], 6.8568272111e-2),
}


@pytest.mark.parametrize("kind", NONLINEAR)
@pytest.mark.parametrize("start", [(500.0, 1e-4), (250.0, 5e-4)])
def test_nonlinear_reference(kind: str, start: tuple[float, float]) -> None:
    values, deviations, residual = NONLINEAR[kind]
    found = calibrate(table("misra1"), Misra(kind, start))
    np.testing.assert_allclose(found.values, values, rtol=1e-9)
    np.testing.assert_allclose(found.standard_uncertainties, deviations, rtol=1e-8)
    assert found.residual_standard_deviation == pytest.approx(residual, rel=1e-9)


def rival(observations: Observations, model: Model, found: Calibration) -> lmfit.minimizer.MinimizerResult:
    """The same problem for lmfit, with derivatives by differences."""
    distance = observations.reference_distance
    observed = observations.echo_time / Model(model.law).time_of_flight(1.0, **observations.conditions)

    def residual(parameters: lmfit.Parameters) -> np.ndarray:
        effects: dict[str, dict[str, float]] = {}
        for name in found.names:
            effect, parameter = name.split(".")
            effects.setdefault(effect, {})[parameter] = parameters[name.replace(".", "__")].value
        return Model(model.law, effects).indicate(distance, **observations.conditions) - observed

    parameters = lmfit.Parameters()
    for name in found.names:
        parameters.add(name.replace(".", "__"), value=1e-5)
    return lmfit.minimize(residual, parameters, method="leastsq")


def test_agrees_with_lmfit() -> None:
    rng = np.random.default_rng(7)
    distance = np.tile([0.2, 0.5, 1.0, 2.0, 3.0, 4.0], 20)
    temperature = rng.uniform(0.0, 50.0, len(distance))
    effects = {
        "fixed_delay": {"delay": 40e-6},
        "zero_error": {"offset": -3e-3},
        "speed_slope": {"slope": 4e-3},
    }
    echo = Model("linear", effects).time_of_flight(distance, temperature=temperature)
    echo += 2.0 * -3e-3 / 343.0 + rng.normal(0.0, 5e-6, len(distance))
    data = Observations(echo, {"temperature": temperature}, distance, np.full(len(distance), ""))
    fit = ["fixed_delay.delay", "zero_error.offset", "speed_slope.slope"]
    found = calibrate(data, Model("linear"), fit)
    theirs = rival(data, Model("linear"), found)
    for name, value, deviation in zip(found.names, found.values, found.standard_uncertainties, strict=True):
        parameter = theirs.params[name.replace(".", "__")]
        assert value == pytest.approx(parameter.value, abs=1e-3 * deviation)
        assert deviation == pytest.approx(parameter.stderr, rel=1e-3)
    assert found.residual_standard_deviation**2 == pytest.approx(theirs.redchi, rel=1e-6)
