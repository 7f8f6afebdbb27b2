"""Regenerate the coefficients and the reference table of the law ``virial``.

    python tests/reference/fit_virial.py [--write]

prints the deviations on points that were not used for the fit; with ``--write`` it also writes

* ``rust/core/src/air/virial_coefficients.rs`` (the coefficients) and
* ``tests/published/moist_air_reference.csv`` (the reference values that the Rust tests read).

The form is the acoustic virial expansion

    c^2 = gamma0 R T / M * (1 + beta(T, x) q + ...),   q = p / (R T)

with gamma0 of the ideal mixture. Where the two references differ (steam close to saturation: by up to
0.03 %) nothing measured says which is right; the fit aims half way, on one and the same dry air.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
from importlib.metadata import version
from pathlib import Path

import moist_air
import numpy as np
from CoolProp.CoolProp import PropsSI
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.stats import qmc

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
GAS_CONSTANT = 8.314462618  # [J/(mol K)], SI 2019
GAS_CONSTANT_LEMMON = 8.31451  # [J/(mol K)], the one dry air was fitted with
DRY_AIR_MOLAR_MASS = 28.96546e-3  # [kg/mol], CIPM-2007 at 400 ppm CO2
WATER_MOLAR_MASS = 18.01528e-3  # [kg/mol], CIPM-2007
TEMPERATURE = (-20.0, 60.0)
PRESSURE = (60e3, 110e3)
WET = 0.06  # water mole fraction above which the references part
# (power of t/100, powers of dry air and of water, power of q): steam close to saturation needs its
# third and fourth virial terms, air does not.
CROSS_TERMS = [(i, 1, 1, 1) for i in (0, 1)]
WATER_TERMS = [*((i, 0, 2, 1) for i in (0, 1, 2)), (0, 0, 3, 2), (0, 0, 4, 3)]
WET_TERMS = CROSS_TERMS + WATER_TERMS
COLUMNS = [
    "temperature_C",
    "relative_humidity",
    "pressure_Pa",
    "water_vapor_mole_fraction",
    "speed_hapropssi_m_per_s",
    "speed_iapws_m_per_s",
]


def minimax(columns: Array, target: Array, weight: Array | float = 1.0) -> Array:
    """Coefficients with the smallest largest residual (a linear program: deterministic)."""
    scale = np.abs(columns).max(axis=0)
    scaled = columns / scale * np.reshape(weight, (-1, 1))
    aim = target * weight
    bound = -np.ones((len(aim), 1))
    result = linprog(
        np.r_[np.zeros(columns.shape[1]), 1.0],
        A_ub=np.block([[scaled, bound], [-scaled, bound]]),
        b_ub=np.r_[aim, -aim],
        bounds=[(None, None)] * columns.shape[1] + [(0, None)],
        method="highs",
    )
    return np.asarray(result.x[:-1] / scale)


def powers(temperature: Array, degree: int) -> Array:
    return np.vander(temperature / 100.0, degree + 1, increasing=True)


def steam_heat_capacity(temperature: Array) -> Array:
    """cp0/R of water vapor: IAPWS R6-95, Table 1 (CoolProp refuses the vapor below 0 degC)."""
    weights = np.array([0.012436, 0.97315, 1.27950, 0.96956, 0.24873])
    gammas = np.array([1.28728967, 3.53734222, 7.74073708, 9.24437796, 27.5075105])
    argument = gammas * 647.096 / (temperature[:, None] + moist_air.ZERO_CELSIUS)
    einstein = argument**2 * np.exp(-argument) / (1.0 - np.exp(-argument)) ** 2
    return np.asarray(4.00632 + einstein @ weights)


def ideal_gas_parts() -> dict[str, Array]:
    """cp0/R of air, of water vapor, and of carbon dioxide less oxygen, as polynomials in t/100."""
    t = np.linspace(*TEMPERATURE, 81)

    def cp0(fluid: str) -> Array:
        kelvin = t + moist_air.ZERO_CELSIUS
        moles = [PropsSI("CP0MOLAR", "T", k, "P", 1e3, fluid) for k in kelvin]
        return np.array(moles) / PropsSI("GAS_CONSTANT", fluid)

    # gamma R is what the speed shows: carry Lemmon's older R into gamma.
    gamma = cp0("Air") / (cp0("Air") - 1.0) * GAS_CONSTANT_LEMMON / GAS_CONSTANT
    return {
        "air_heat_capacity": minimax(powers(t, 3), gamma / (gamma - 1.0)),
        "water_heat_capacity": minimax(powers(t, 2), steam_heat_capacity(t)),
        "co2_heat_capacity": minimax(powers(t, 1), cp0("CarbonDioxide") - cp0("Oxygen")),
    }


def ideal_gas(parts: dict[str, Array], t: Array, water: Array) -> Array:
    """gamma0 R T / M, at 400 ppm carbon dioxide."""
    cp = (1.0 - water) * (powers(t, 3) @ parts["air_heat_capacity"])
    cp = cp + water * (powers(t, 2) @ parts["water_heat_capacity"])
    mass = (1.0 - water) * DRY_AIR_MOLAR_MASS + water * WATER_MOLAR_MASS
    return np.asarray(cp / (cp - 1.0) * GAS_CONSTANT * (t + moist_air.ZERO_CELSIUS) / mass)


def molar_density(t: Array, p: Array) -> Array:
    """Of the ideal gas, p/(R T) [mol/cm3]."""
    return np.asarray(1e-6 * p / (GAS_CONSTANT * (t + moist_air.ZERO_CELSIUS)))


def dry_columns(t: Array, p: Array, water: Array) -> Array:
    q, air = molar_density(t, p), 1.0 - water
    return np.column_stack([powers(t, 2) * (air**2 * q)[:, None], air**3 * q**2])


def wet_columns(t: Array, p: Array, water: Array) -> Array:
    q = molar_density(t, p)
    return np.column_stack([(t / 100) ** i * (1 - water) ** a * water**w * q**n for i, a, w, n in WET_TERMS])


def evaluate(parts: dict[str, Array], t: Array, p: Array, water: Array) -> Array:
    deviation = dry_columns(t, p, water) @ parts["dry"] + wet_columns(t, p, water) @ parts["wet"]
    return np.asarray(np.sqrt(ideal_gas(parts, t, water) * (1.0 + deviation)))


def lobatto(low: float, high: float, n: int) -> Array:
    return np.asarray(low + (high - low) * 0.5 * (1.0 - np.cos(np.pi * np.arange(n) / (n - 1))))


def references(points: Array) -> Array:
    """Columns: temperature, relative humidity, pressure, water, HAPropsSI, IAPWS, dry shift."""
    rows = []
    for t, humidity, p in points:
        water = moist_air.water_vapor_mole_fraction(t, humidity, p)
        shift = moist_air.dry_air(t, p) / moist_air.hapropssi(t, 0.0, p)
        speeds = moist_air.hapropssi(t, water, p), moist_air.iapws(t, water, p)
        rows.append((t, humidity, p, water, *speeds, shift))
    return np.array(rows)


def fit() -> dict[str, Array]:
    parts = ideal_gas_parts()
    grid = np.array([(t, p) for t in lobatto(*TEMPERATURE, 17) for p in lobatto(1e3, 110e3, 9)])
    t, p = grid.T
    speed = np.array([moist_air.dry_air(*point) for point in grid])
    zero = np.zeros_like(t)
    parts["dry"] = minimax(dry_columns(t, p, zero), speed**2 / ideal_gas(parts, t, zero) - 1.0)

    points = [
        (t, humidity, p)
        for t in lobatto(*TEMPERATURE, 15)
        for humidity in lobatto(0.0, 1.0, 9)
        for p in lobatto(*PRESSURE, 5)
    ]
    t, _, p, water, coolprop, iapws, shift = references(np.array(points)).T
    target = (0.5 * (coolprop * shift + iapws)) ** 2 / ideal_gas(parts, t, water) - 1.0
    target = target - dry_columns(t, p, water) @ parts["dry"]
    weight = np.where(water <= WET, 2.0, 1.0)
    parts["wet"] = minimax(wet_columns(t, p, water), target, weight)
    return parts


def report(parts: dict[str, Array], table: Array) -> None:
    t, _, p, water, coolprop, iapws, shift = table.T
    speed = evaluate(parts, t, p, water)
    wet = water > WET
    print(f"{len(t)} points outside the fit; largest deviation in ppm")
    for name, reference in {
        "aim (half way)": 0.5 * (coolprop * shift + iapws),
        "HAPropsSI": coolprop,
        "IAPWS G8-10": iapws,
    }.items():
        ppm = 1e6 * np.abs(speed / reference - 1.0)
        print(f"  {name:16} x<=0.06: {ppm[~wet].max():6.1f}   x>0.06: {ppm[wet].max():6.1f}")
    ppm = 1e6 * np.abs(iapws / coolprop - 1.0)
    print(f"  {'one another':16} x<=0.06: {ppm[~wet].max():6.1f}   x>0.06: {ppm[wet].max():6.1f}")


def validation_points(n: int = 256) -> Array:
    """Sobol points (unscrambled: no seed to pick) and the corners of the box."""
    low, high = np.array([-20.0, 0.0, 60e3]), np.array([60.0, 1.0, 110e3])
    inside = qmc.Sobol(3, scramble=False).random(n)
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    return np.asarray(low + np.vstack([inside, corners]) * (high - low))


def rust(name: str, doc: str, values: Array) -> str:
    digits = ", ".join(f"{value:.10e}" for value in values)
    return f"/// {doc}\npub const {name}: [f64; {len(values)}] = [{digits}];\n"


def coefficients_as_rust(parts: dict[str, Array]) -> str:
    """The generated module, one constant per factor of the law; formatted by rustfmt afterwards."""
    wet = parts["wet"]
    constants = [
        ("AIR_HEAT_CAPACITY", "`cp0/R` of dry air with 400 ppm CO2.", parts["air_heat_capacity"]),
        ("WATER_HEAT_CAPACITY", "`cp0/R` of water vapor.", parts["water_heat_capacity"]),
        ("CO2_HEAT_CAPACITY", "`cp0/R` of CO2 less that of O2.", parts["co2_heat_capacity"]),
        ("AIR_SECOND", "Second acoustic virial, air with air [cm^3/mol].", parts["dry"][:3]),
        ("AIR_THIRD", "Third acoustic virial, air [cm^6/mol^2].", parts["dry"][3:]),
        ("CROSS_SECOND", "Second acoustic virial, air with water [cm^3/mol].", wet[:2]),
        ("WATER_SECOND", "Second acoustic virial, water with water [cm^3/mol].", wet[2:5]),
        ("WATER_THIRD", "Third acoustic virial, water [cm^6/mol^2].", wet[5:6]),
        ("WATER_FOURTH", "Fourth acoustic virial, water [cm^9/mol^3].", wet[6:7]),
    ]
    head = (
        "//! Coefficients of [`Virial`](super::Virial), all polynomials in t / 100 degC.\n"
        "//!\n//! Generated by `python tests/reference/fit_virial.py --write`; do not edit.\n\n"
    )
    blocks = [rust(name, doc.replace("[", "\\[").replace("]", "\\]"), v) for name, doc, v in constants]
    return head + "\n".join(blocks)


def write(parts: dict[str, Array], table: Array) -> None:
    target = ROOT / "rust/core/src/air/virial_coefficients.rs"
    target.write_text(coefficients_as_rust(parts), encoding="utf-8")
    subprocess.run(["rustfmt", "--edition", "2024", str(target)], check=True)
    versions = ", ".join(f"{name} {version(name)}" for name in ("CoolProp", "iapws"))
    with (ROOT / "tests/published/moist_air_reference.csv").open("w", encoding="utf-8") as file:
        file.write(f"# source: tests/reference/fit_virial.py with {versions}; points outside the fit\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for t, humidity, p, water, coolprop, iapws, _ in table:
            row = (t, humidity, p, f"{water:.12g}", f"{coolprop:.9f}", f"{iapws:.9f}")
            writer.writerow(row)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="write the coefficients and the table")
    parser.add_argument("--points", type=int, default=256, help="how many points to validate on")
    options = parser.parse_args()
    parts, table = fit(), references(validation_points(options.points))
    report(parts, table)
    if options.write:
        write(parts, table)


if __name__ == "__main__":
    main()
