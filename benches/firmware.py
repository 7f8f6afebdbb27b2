"""Generated functions beside what hobby libraries compute, measured in one run: figures of docs/firmware.md.

Run ``python benches/firmware.py`` with the tools of `.ci/packages.txt`; it writes benches/firmware.json and
the table.
"""

import json
import subprocess
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import fused
import numpy as np
from firmware_page import PAGE, RESULTS, fresh
from hobby import FORMULAS, Formula, written
from numpy.typing import NDArray

import echocal
from echocal import Model, firmware, silicon
from echocal.firmware import Firmware
from echocal.silicon import Generated

DRY = {"relative_humidity": 0.0, "co2_mole_fraction": 0.0}
DS18B20 = (0.0625, -20.0, 60.0)
AIR: dict[str, dict[str, Any]] = {
    "dry": {"assume": DRY},
    "50 %": {"assume": DRY | {"relative_humidity": 0.5}},
    "measured": {"humidity": (0.01, 0.0, 1.0), "assume": {"co2_mole_fraction": 0.0}},
}
REACH = 4.0  # m
ECHOES = np.arange(500, 25_001, 500)  # us; what every function accepts
OURS = [  # core, target, what is saved, options, bound [m]
    ("avr", "avr", "size", "-Os", 0.1e-3),
    ("avr", "avr", "size", "-Os", 0.06e-3),
    ("avr", "avr", "speed", "-Os", 0.5e-3),
    ("avr", "avr", "speed", "-Os", 0.06e-3),
    ("avr", "c99", "size", "-Os", 0.1e-3),
    ("cortex-m0", "cortex-m0", "size", "-Os", 0.1e-3),
    ("cortex-m3", "cortex-m3", "size", "-Os", 0.1e-3),
    ("cortex-m4f", "cortex-m4f", "size", "-Os", 0.1e-3),
    ("rv32", "rv32", "size", "-Os", 0.1e-3),
    ("rv32e", "rv32e", "size", "-Os", 0.1e-3),
]
BAKED = [  # humidity 50 %, assumed
    ("avr", "avr", "size", "-Os", 0.1e-3),
    ("avr", "avr", "size", "-Os", 0.06e-3),
    ("avr", "avr", "speed", "-Os", 0.1e-3),
    ("cortex-m0", "cortex-m0", "size", "-Os", 0.1e-3),
]
HUMID = [
    ("avr", "avr", "size", "-Os", 0.5e-3),
    ("avr", "avr", "speed", "-Os", 0.35e-3),
    ("cortex-m0", "cortex-m0", "size", "-Os", 0.5e-3),
    ("cortex-m4f", "cortex-m4f", "size", "-Os", 0.5e-3),
]
HARNESS = """
#include <stdio.h>
#include "echocal_correction.h"
int main(void)
{
    int echo, code, damp;
    for (code = -320; code <= 960; code++)
        for (damp = 0; damp <= %d; damp++)
            for (echo = 500; echo <= 25000; echo += 500) {
                int32_t distance = echocal_distance_um((uint16_t)echo, (int16_t)code%s);
                fwrite(&distance, sizeof distance, 1, stdout);
            }
    return 0;
}
"""


def outputs(made: Generated, humid: bool) -> NDArray[np.float64]:
    """Distances [m] that the C gives on this machine: temperature, humidity (one if it reads none), echo."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("echocal_correction.h", "echocal_correction.c"):
            (folder / file).write_text(made.files[file])
        (folder / "main.c").write_text(HARNESS % ((100, ", (uint8_t)damp") if humid else (0, "")))
        program = folder / "main"
        parts = (folder / "main.c", folder / "echocal_correction.c")
        subprocess.run(["gcc", "-O1", "-w", *parts, "-lm", "-o", program], check=True)
        flat = np.frombuffer(subprocess.run([program], capture_output=True, check=True).stdout, np.int32)
    return flat.reshape(1281, -1, ECHOES.size) * 1e-6


def errors(made: Generated, humid: bool) -> dict[str, float]:
    """Largest error [m] against Cramer up to 4 m, in dry air and at any humidity, every 500 us."""
    found = outputs(made, humid)
    warm = np.arange(-320, 961)[:, None, None] * 0.0625
    damp = np.arange(101)[:, None] * 0.01
    air = {"co2_mole_fraction": 0.0, "law": "cramer"}
    truth = echocal.distance(ECHOES * 1e-6, temperature=warm, relative_humidity=damp, **air)
    error = np.where(truth <= REACH, np.abs(found - truth), 0.0)
    return {"dry_m": float(error[:, 0].max()), "humid_m": float(error.max())}


def theirs(formula: Formula, beside: Firmware, core: str) -> dict[str, Any]:
    """One formula on one core."""
    text = written(formula, beside)
    library = ("-lm",) if formula.library or core == "avr" else ()  # avr-libc has its float there
    found = silicon.measure(text, core, library=library, strict=False)
    assert found is not None, silicon.missing(core)
    return {"label": formula.label, **asdict(found), **errors(text, formula.humid)}


def ours(core: str, target: str, prefer: str, options: str, bound: float, air: str) -> dict[str, Any]:
    """One generated function on one core."""
    codes: dict[str, Any] = {"temperature": DS18B20, "max_error": bound, "prefer": prefer} | AIR[air]
    made = firmware.generate(Model("cramer"), target, n_threads=2, **codes)
    found = silicon.measure(made, core, options)
    assert found is not None, silicon.missing(core)
    proven = {"proven_m": made.report["error_proven_m"], "form": made.report["form"]["description"]}
    return {
        "label": f"`{target}`, {prefer}, {options}, {bound * 1e3:g} mm",
        "air": air,
        **proven,
        **asdict(found),
        **errors(made, air == "measured"),
    }


def measure() -> dict[str, Any]:
    """Every row."""
    codes: dict[str, Any] = {"temperature": DS18B20, "max_error": 0.5e-3}
    plain = firmware.generate(Model("cramer"), assume=DRY, **codes)
    coarse = {"temperature": DS18B20, "humidity": (0.01, 0.0, 1.0), "form": "additive"}
    moist = firmware.generate(Model("cramer"), "avr", max_error=2e-3, **coarse)
    rows = [theirs(formula, moist if formula.humid else plain, "avr") for formula in FORMULAS]
    rows += [theirs(FORMULAS[1], plain, core) for core in silicon.CORES if core != "avr"]
    rows += [theirs(one, moist if one.humid else plain, "cortex-m4f") for one in fused.formulas()]
    return {
        "theirs": rows,
        "ours": [ours(*row, air="dry") for row in OURS],
        "baked": [ours(*row, air="50 %") for row in BAKED],
        "humid": [ours(*row, air="measured") for row in HUMID],
    }


def main() -> None:
    results = measure()
    RESULTS.write_text(json.dumps(results, indent=1) + "\n")
    PAGE.write_text(fresh(PAGE.read_text(), results))


if __name__ == "__main__":
    main()
