"""What scripts generated is fresh: the reference table, the coefficients, the tables of the page."""

import re
from pathlib import Path

import fit_virial
import moist_air
import numpy as np
import physics_tables
import pytest

ROOT = Path(__file__).parents[1]


def test_stored_reference_is_what_the_packages_say() -> None:
    columns = physics_tables.reference()
    names = ("temperature_C", "water_vapor_mole_fraction", "pressure_Pa")
    points = np.column_stack([columns[name] for name in names])[::4]
    for reference in (moist_air.hapropssi, moist_air.iapws):
        stored = columns[f"speed_{reference.__name__}_m_per_s"][::4]
        live = [reference(*point) for point in points]
        np.testing.assert_allclose(stored, live, rtol=1e-8)


@pytest.mark.slow
def test_stored_coefficients_are_what_the_fit_gives() -> None:
    """To 0.1 ppm of the speed: releases of CoolProp may differ in the last digits."""
    text = (ROOT / "rust/core/src/air/virial_coefficients.rs").read_text(encoding="utf-8")
    arrays = re.findall(r"\[f64; \d+\] = \[(.*?)\];", text, re.DOTALL)
    stored = [[float(value) for value in array.split(",") if value.strip()] for array in arrays]
    air, water, co2, *virials = map(np.array, stored)
    fresh = fit_virial.fit()
    parts = {
        "air_heat_capacity": air,
        "water_heat_capacity": water,
        "dry": np.concatenate(virials[:2]),
        "wet": np.concatenate(virials[2:]),
    }
    np.testing.assert_allclose(co2, fresh["co2_heat_capacity"], rtol=1e-6)
    temperature, humidity, pressure = fit_virial.validation_points(64).T
    moist = [
        moist_air.water_vapor_mole_fraction(*p) for p in zip(temperature, humidity, pressure, strict=True)
    ]
    speeds = [fit_virial.evaluate(p, temperature, pressure, np.array(moist)) for p in (parts, fresh)]
    np.testing.assert_allclose(*speeds, rtol=1e-7)


def test_page_shows_what_the_script_prints() -> None:
    page = physics_tables.PAGE.read_text(encoding="utf-8")
    assert physics_tables.replaced(page) == page
