"""The bench's own air: against published tables and other people's programs, never against the core."""

from pathlib import Path

import CoolProp.CoolProp
import numpy as np
import pandas as pd
import pyfar
import pytest

from echocal.virtual_bench import air

PUBLISHED = Path(__file__).parent / "published"


def published(name: str) -> pd.DataFrame:
    return pd.read_csv(PUBLISHED / f"{name}.csv", comment="#")


def test_speed_of_sound_in_a_standard() -> None:
    """IEC 61094-2; what is left out (unlike gases, the enhancement factor) costs 2e-5 in a room."""
    table = published("iec_61094_2_table_f1")
    conditions = [
        table[name] for name in ("temperature_C", "relative_humidity", "pressure_Pa", "co2_mole_fraction")
    ]
    assert air.speed_of_sound(*conditions) == pytest.approx(table["speed_m_per_s"].to_numpy(), rel=2e-5)


def test_speed_of_sound_in_moist_air() -> None:
    """Against equations of state by CoolProp; they differ most in warm and damp air."""
    table = published("moist_air_reference").query("temperature_C <= 50")
    conditions = [table[name] for name in ("temperature_C", "relative_humidity", "pressure_Pa")]
    apart = np.abs(air.speed_of_sound(*conditions) / table["speed_hapropssi_m_per_s"].to_numpy() - 1)
    for warmest, most in ((20.0, 1.1e-4), (40.0, 2e-4), (50.0, 3e-4)):
        assert apart[table["temperature_C"] <= warmest].max() < most


def test_speed_of_sound_in_dry_air_against_coolprop(random: np.random.Generator) -> None:
    """CoolProp's air is a fit of Lemmon et al. 2000, which tells the speed of sound to 2e-4."""
    for temperature, pressure in zip(
        random.uniform(-30, 60, 20), random.uniform(6e4, 1.1e5, 20), strict=True
    ):
        theirs = CoolProp.CoolProp.PropsSI("A", "T", temperature + 273.15, "P", pressure, "Air")
        assert air.speed_of_sound(temperature, 0.0, pressure, 0.0) == pytest.approx(theirs, rel=2.5e-4)


def test_saturation_pressure_against_coolprop(random: np.random.Generator) -> None:
    for temperature in random.uniform(0.1, 60, 20):
        theirs = CoolProp.CoolProp.PropsSI("P", "T", temperature + 273.15, "Q", 0, "Water")
        assert air.saturation_pressure(temperature) == pytest.approx(theirs, rel=1e-3)


def test_absorption_against_pyfar(random: np.random.Generator) -> None:
    """At the reference pressure, where pyfar 0.8.1 has the water content right; 40 kHz and around."""
    frequencies = np.array([20e3, 40e3, 60e3])
    for temperature, humidity in zip(random.uniform(-20, 50, 30), random.uniform(0.05, 1, 30), strict=True):
        theirs = pyfar.constants.air_attenuation(temperature, frequencies, humidity)[0].ravel()
        ours = [float(air.absorption(temperature, humidity, 101325.0, f)) for f in frequencies]
        assert ours == pytest.approx(theirs, rel=6e-3)  # two formulas for the saturation pressure


def test_absorption_in_standards() -> None:
    """ISO 9613-1 at audible frequencies, IEC 61094-3 up to 50 kHz; both print few digits."""
    table = published("iso_9613_1_table_1")
    exact = 1000 * 10 ** (table["midband_exponent_k"] / 10)
    rows = zip(table["temperature_C"], table["relative_humidity"], exact, strict=True)
    ours = [1000 * float(air.absorption(t, h, 101325.0, f)) for t, h, f in rows]
    assert ours == pytest.approx(table["attenuation_dB_per_km"].to_numpy(), rel=6e-3)
    table = published("iec_61094_3_table_b1")
    rows = zip(table["temperature_C"], table["relative_humidity"], table["frequency_Hz"], strict=True)
    ours = [float(air.absorption(t, h, 101325.0, f)) for t, h, f in rows]
    assert ours == pytest.approx(table["attenuation_dB_per_m"].to_numpy(), rel=6e-3, abs=6e-5)


def test_absorption_at_other_pressures(random: np.random.Generator) -> None:
    """ISO 9613-1, clause 6: at a fixed molar share of water all rates go with the pressure.

    So the attenuation of a wavelength depends on frequency over pressure only, but for the classical part.
    """
    temperature, share = random.uniform(0, 40), random.uniform(0.002, 0.02)
    for pressure in random.uniform(5e4, 1.2e5, 10):
        ratio = pressure / 101325.0
        wet = [share * p / air.saturation_pressure(temperature) for p in (pressure, 101325.0)]
        here = air.absorption(temperature, wet[0], pressure, 40e3 * ratio)
        there = air.absorption(temperature, wet[1], 101325.0, 40e3)
        assert here == pytest.approx(ratio * there, rel=1e-12)


def test_a_phase_is_faster_at_high_frequency_and_an_envelope_faster_still_in_between(
    random: np.random.Generator,
) -> None:
    temperature, humidity = random.uniform(-10, 45), random.uniform(0.1, 0.9)

    def number(frequency: float) -> float:
        speed = float(air.speed_of_sound(temperature, humidity, frequency=frequency))
        return 2 * np.pi * frequency / speed

    group = float(air.speed_of_sound(temperature, humidity, frequency=40e3, group=True))
    assert group == pytest.approx(4 * np.pi / (number(40e3 + 1) - number(40e3 - 1)), rel=1e-7)
    speeds = [float(air.speed_of_sound(temperature, humidity, frequency=f)) for f in (0.0, 4e3, 4e4, 4e6)]
    assert np.all(np.diff(speeds) > 0)
    assert speeds[-1] - speeds[0] < 0.3  # of 343 m/s: what two vibrations hold of the heat
    assert group > speeds[2]
