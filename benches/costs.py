"""Weights of the generator's cost models, fitted to measured functions: firmware_gen/src/target/weights.rs.

Run ``python benches/costs.py`` with the tools of `.ci/packages.txt` (some minutes), then build again. The
search only ranks by these weights; whatever a report states was measured.
"""

import itertools
import json
import re
import sys
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from echocal import Model, firmware, silicon
from echocal.errors import BoundError, EchocalError, UsageError
from echocal.firmware import Firmware

WEIGHTS = Path(__file__).parents[1] / "firmware_gen" / "src" / "target" / "weights.rs"
RESIDUALS = Path(__file__).with_name("costs.json")
TARGETS = ("c99", "avr", "cortex-m0", "cortex-m3", "cortex-m4f", "rv32", "rv32e")
STAND = {"c99": ("avr", "cortex-m0", "rv32")}  # cores that stand for any
DELAYED = {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": -4e-3}}
MODELS = (Model("cramer"), Model("ideal_gas", DELAYED), Model("320-0.5*T", DELAYED))
FORMS = ("polynomial", "square", "factored", "interpolated_table", "segments", "full_table")
BOUNDS = (2e-3, 0.5e-3, 0.2e-3, 0.1e-3, 0.05e-3, 0.01e-3, 0.002e-3)
WARM = ((0.5, -20.0, 60.0), (0.0625, 0.0, 45.0))
COARSE = (2.0, -20.0, 60.0)
DAMP = ((0.05, 0.0, 1.0), (0.25, 0.0, 1.0))
PREFER = ("size", "speed")
# Pull of a weight to its old value, beside a relative error of 1. The steps say little of an AVR's registers:
# there the weights once counted in the compiler's output are only to be scaled.
BELIEF = {"avr": 0.3}
WEAK = 0.02
Wish = tuple[Model, dict[str, Any]]

HEAD = """//! What the steps of a function cost on each target, in tenths: fitted by `benches/costs.py`.
//!
//! Each line is one of `FEATURES`: tenths of a byte, and of a cycle (AVR) or an instruction.

use super::Weights;
"""


def narrow() -> Iterator[Wish]:
    """One thermometer: the counts tell too little of an AVR's registers, and its fit to more ranks worse."""
    for model, form, bound, prefer in itertools.product(MODELS, FORMS, BOUNDS, PREFER):
        yield model, {"temperature": WARM[0], "form": form, "max_error": bound, "prefer": prefer}
    for bound, prefer in itertools.product(BOUNDS[:2], PREFER):
        yield MODELS[0], {"temperature": WARM[0], "humidity": DAMP[0], "max_error": bound, "prefer": prefer}


def wide() -> Iterator[Wish]:
    """Two thermometers, two hygrometers."""
    for model, warm, form, bound, prefer in itertools.product(MODELS, WARM, FORMS, BOUNDS, PREFER):
        yield model, {"temperature": warm, "form": form, "max_error": bound, "prefer": prefer}
    forms = ("additive", "grid")
    for model, damp, bound, prefer, form in itertools.product(MODELS[:2], DAMP, BOUNDS[:4], PREFER, forms):
        humid = {"temperature": COARSE, "humidity": damp, "form": form}
        yield model, {**humid, "max_error": bound, "prefer": prefer}


def designs(target: str) -> list[Firmware]:
    """Functions of every form, each text once."""
    found: dict[str, Firmware] = {}
    wishes = narrow if target == "avr" else wide
    for model, wish in wishes():
        try:
            made = firmware.generate(model, target, echo=24_000, n_threads=2, **wish)
        except (BoundError, UsageError):  # not within this form's reach
            continue
        found.setdefault(made.files["echocal_correction.c"], made)
    return list(found.values())


def measured(made: Firmware, target: str) -> tuple[float, float] | None:
    """Bytes without tables, and steps; the mean over the cores of a target that stands for all."""
    try:
        cores = STAND.get(target, (target,))
        results = [silicon.measure(made, core) for core in cores]
    except EchocalError:  # too slow for a simulator's clock
        return None
    found = [one for one in results if one is not None]
    assert len(found) == len(results), f"tools are missing for {target}"
    size = np.mean([one.flash_bytes for one in found]) - made.report["table_bytes"]
    return float(size), float(np.mean([one.steps for one in found]))


def old(target: str) -> NDArray[np.int64]:
    """The weights that stand in the file now."""
    name = target.upper().replace("-", "_")
    text = WEIGHTS.read_text()
    (body,) = re.findall(rf"const {name}: Weights = \[(.*?)\];", text, re.DOTALL)
    return np.array(re.findall(r"\((\d+), (\d+)\)", body), dtype=np.int64)


def fit(
    counts: NDArray[np.float64], cost: NDArray[np.float64], before: NDArray[np.float64], pull: float
) -> Any:
    """Weights of least relative error, none negative; where no function tells, the old ones."""
    belief = pull / np.maximum(before, 1.0)
    rows = np.vstack([counts / cost[:, None], np.diag(belief)])
    right = np.concatenate([np.ones_like(cost), belief * before])
    return lsq_linear(rows, right, bounds=(0, np.inf)).x


def calibrate(target: str) -> tuple[str, dict[str, Any]]:
    """The text of a target's weights, and what they leave."""
    every = designs(target)
    with ThreadPoolExecutor(2) as pool:
        costs = list(pool.map(lambda made: measured(made, target), every))
    pairs = [(made, cost) for made, cost in zip(every, costs, strict=True) if cost is not None]
    counts = np.array([[count for _, count in made._twin.steps()] for made, _ in pairs], float)
    cost = np.array([cost for _, cost in pairs])
    before = old(target) / 10
    pull = BELIEF.get(target, WEAK)
    weights = np.array([fit(counts, cost[:, k], before[:, k], pull) for k in range(2)]).T
    rounded = np.round(10 * weights).astype(int)
    error = counts @ rounded / 10 / cost - 1
    names = [name for name, _ in pairs[0][0]._twin.steps()]
    lines = [f"    ({size}, {time}), // {name}\n" for (size, time), name in zip(rounded, names, strict=True)]
    text = f"\npub(super) const {target.upper().replace('-', '_')}: Weights = [\n{''.join(lines)}];\n"
    residual = {
        "functions": len(pairs),
        "size_rms": round(float(np.sqrt(np.mean(error[:, 0] ** 2))), 4),
        "time_rms": round(float(np.sqrt(np.mean(error[:, 1] ** 2))), 4),
    }
    return text, residual


def main() -> None:
    warnings.simplefilter("ignore")
    texts, residuals = [], {}
    for target in TARGETS:
        text, residuals[target] = calibrate(target)
        texts.append(text)
        print(target, residuals[target], file=sys.stderr, flush=True)
    WEIGHTS.write_text(HEAD + "".join(texts))
    RESIDUALS.write_text(json.dumps(residuals, indent=1) + "\n")


if __name__ == "__main__":
    main()
