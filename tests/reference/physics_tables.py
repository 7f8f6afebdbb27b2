"""Regenerate the tables of docs/physics.md from echocal itself and the stored reference.

    python tests/reference/physics_tables.py [--write]

prints the tables; with ``--write`` it replaces them in the page, between their markers.
"""

from __future__ import annotations

import argparse
import csv
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import echocal
from echocal import _core

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "physics.md"
REFERENCE = ROOT / "tests" / "published" / "moist_air_reference.csv"
WET = 0.06
FOLK = ("331.4+0.6*T", "331.3+0.606*T", "343", "340", "ideal_gas", "cramer")
CONDITIONS = ((0.0, 0.0), (20.0, 0.0), (20.0, 0.5), (50.0, 0.0), (50.0, 0.5))
DISTANCE = 2.0  # [m]

Columns = dict[str, NDArray[np.float64]]


def reference() -> Columns:
    """Columns of the stored reference table."""
    with REFERENCE.open(encoding="utf-8") as file:
        file.readline()  # the source
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def deviations() -> str:
    """Largest deviation of every law from both references, in ppm."""
    columns = reference()
    air = {
        "temperature": columns["temperature_C"],
        "relative_humidity": columns["relative_humidity"],
        "pressure": columns["pressure_Pa"],
    }
    wet = columns["water_vapor_mole_fraction"] > WET
    rows = []
    for facts in _core.laws():
        cells = [f"`{facts['id']}`"]
        for rows_in in (~wet, wet):
            for name in ("speed_hapropssi_m_per_s", "speed_iapws_m_per_s"):
                speed = echocal.speed_of_sound(**air, law=facts["id"])
                ppm = 1e6 * np.abs(speed / columns[name] - 1.0)
                cells.append(f"{ppm[rows_in].max():.0f}")
        rows.append(cells)
    head = ["law", "HAPropsSI, xw <= 0.06", "IAPWS, xw <= 0.06", "HAPropsSI, xw > 0.06", "IAPWS, xw > 0.06"]
    return table(head, rows)


def folk() -> str:
    """What a formula costs against `virial`: speed [m/s] and indication at 2 m [mm]."""
    rows = []
    for law in FOLK:
        cells = [f"`{law}`"]
        for temperature, humidity in CONDITIONS:
            truth = echocal.speed_of_sound(temperature, humidity, law="virial")
            difference = echocal.speed_of_sound(temperature, humidity, law=law) - truth
            cells.append(f"{difference:+.2f} ({1e3 * DISTANCE * difference / truth:+.1f})")
        rows.append(cells)
    head = [f"{t:.0f} degC, {'dry' if h == 0 else f'{100 * h:.0f} %'}" for t, h in CONDITIONS]
    return table(["formula", *head], rows)


def dispersion() -> str:
    """What sound gains at 40 kHz [m/s]."""
    humidities = (0.0, 0.1, 0.3, 0.5, 0.7, 1.0)
    rows = []
    for temperature in (-20.0, 0.0, 10.0, 20.0, 30.0, 50.0):
        still, moving = (
            echocal.speed_of_sound(temperature, list(humidities), frequency=frequency, law="virial")
            for frequency in (0.0, 40e3)
        )
        rows.append([f"{temperature:.0f} degC", *(f"{gain:+.3f}" for gain in moving - still)])
    return table(["", *(f"{100 * humidity:.0f} %" for humidity in humidities)], rows)


TABLES = {"deviations": deviations, "folk": folk, "dispersion": dispersion}


def sections() -> Iterator[tuple[str, str]]:
    """Marker and table, in the order of the page."""
    for name, function in TABLES.items():
        yield name, function()


def replaced(page: str) -> str:
    """The page with every table renewed."""
    for name, text in sections():
        start, end = f"<!-- {name} -->\n", f"<!-- /{name} -->"
        block = re.compile(re.escape(start) + ".*?" + re.escape(end), re.DOTALL)
        if not block.search(page):
            message = f"{PAGE.name} has no block {start.strip()}"
            raise ValueError(message)
        page = block.sub(lambda _, new=f"{start}{text}\n{end}": new, page)
    return page


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="replace the tables in docs/physics.md")
    if parser.parse_args().write:
        PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    for name, text in sections():
        print(f"{name}\n\n{text}\n")


if __name__ == "__main__":
    main()
