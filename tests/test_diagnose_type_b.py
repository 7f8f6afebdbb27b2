"""The standard uncertainty of a size has what all rows of a table share: docs/method/checks.md, Eq. 17a."""

import numpy as np
import pytest

import echocal

TABLES, ROWS = 60, 300
SCALE, ARRIVAL = 4.3e-4, 7.2e-6
PLANTED = {"fixed_delay": ("delay", 60e-6), "clock_error": ("frequency_error", 6e-3)}


def error_over_uncertainty(random: np.random.Generator) -> float | None:
    """Error of a told size over its uncertainty, or None; the scale and the arrival of the table err."""
    cause = str(random.choice([*PLANTED]))
    name, usual = PLANTED[cause]
    size = float(random.choice([-1.0, 1.0]) * random.uniform(0.7, 1.3) * usual)
    distance, celsius = random.uniform(0.3, 3.0, ROWS), random.uniform(10.0, 30.0, ROWS)
    model = echocal.Model("cramer", {cause: {name: size}})
    echo = model.time_of_flight(distance, temperature=celsius, relative_humidity=0.5)
    echo *= 1.0 + SCALE * random.normal()
    echo += ARRIVAL * random.normal() + 3e-6 * random.normal(size=ROWS)
    table = {"echo_us": 1e6 * echo, "temperature_C": celsius, "humidity_percent": 50.0 + 0.0 * celsius}
    diagnosis = echocal.diagnose({**table, "distance_m": distance}, base="cramer")
    for found in diagnosis.causes:
        if found.id == cause:
            (told,) = found.parameters
            return (told.value - size) / told.standard_uncertainty
    return None


@pytest.mark.slow
@pytest.mark.statistical
def test_errors_that_all_rows_share_are_in_the_uncertainty_of_a_size(random: np.random.Generator) -> None:
    drawn = [error_over_uncertainty(random) for _ in range(TABLES)]
    off = np.array([one for one in drawn if one is not None])
    assert len(off) >= TABLES / 4  # a delay may be told as an error of the zero, its rival
    assert np.mean(np.abs(off) <= 2.0) >= 0.8
    assert 0.5 < np.sqrt(np.mean(off**2)) < 1.6


@pytest.mark.statistical
@pytest.mark.parametrize("rho", [0.0, 0.9], ids=["white", "autoregressive"])
def test_what_all_rows_share_is_no_more_than_it_is(random: np.random.Generator, rho: float) -> None:
    """At one distance a delay takes up all of both errors, whichever noise is the most probable one."""
    told = [one for _ in range(12) if (one := over_shared(random, rho)) is not None]
    assert len(told) >= 3  # the class may be told by another of its names
    np.testing.assert_allclose(told, 1.0, rtol=0.05)


def over_shared(random: np.random.Generator, rho: float) -> float | None:
    """Type B uncertainty of a delay alone over that of the errors; None if another cause is told."""
    noise = 4e-6 * random.normal(size=ROWS)
    for row in range(1, ROWS):
        noise[row] = rho * noise[row - 1] + (1.0 - rho**2) ** 0.5 * noise[row]
    celsius, model = (
        random.uniform(10.0, 30.0, ROWS),
        echocal.Model("cramer", {"fixed_delay": {"delay": 80e-6}}),
    )
    echo = model.time_of_flight(np.full(ROWS, 1.5), temperature=celsius, relative_humidity=0.5) + noise
    table = {"echo_us": 1e6 * echo, "temperature_C": celsius, "humidity_percent": np.full(ROWS, 50.0)}
    diagnosis = echocal.diagnose({**table, "distance_m": np.full(ROWS, 1.5)}, base="cramer")
    if set(diagnosis.model.effects) != {"fixed_delay"}:
        return None
    (cause,) = (found for found in diagnosis.causes if found.id == "fixed_delay")
    of_rows = diagnosis.model.standard_uncertainties["fixed_delay.delay"] or 0.0
    type_b = np.sqrt(cause.parameters[0].standard_uncertainty ** 2 - of_rows**2)
    return float(type_b / np.hypot(ARRIVAL, SCALE * echo.mean()))
