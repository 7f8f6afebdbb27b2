"""Generated files as they were when last looked at: what a change of the generator does, is seen.

After a change that is meant, run ``python tests/firmware/test_golden.py`` and read the difference.
"""

from pathlib import Path

import pytest

from echocal import Model, firmware
from echocal.firmware import Firmware

GOLDEN = Path(__file__).parent / "golden"
ORIGIN = {
    "verdict": "named",
    "causes": [
        {
            "id": "fixed_delay",
            "probability": 0.97,
            "probability_alone": 0.61,
            "indistinguishable_from": ["zero_error", "*/ zero"],
        },
        {"id": "clock_error", "probability": 0.99, "indistinguishable_from": []},
    ],
    "gain": {
        "rms_before_m": 5.1e-3,
        "rms_after_m": 1.2e-3,
        "held_out_rows": 400,
        "variance_removed": 0.945,
        "variance_removed_interval_95": [0.93, 0.96],
        "scheme": "nested, blocked by time, 5 folds",
    },
}
CASES = {
    "dry_air": (Model("cramer"), {}),
    "delay_and_zero": (
        Model("ideal_gas", {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": -4e-3}}),
        {"max_error": 0.1e-3},
    ),
    "avr": (Model("cramer"), {"target": "avr", "form": "interpolated_table", "max_error": 0.2e-3}),
    "diagnosed": (Model("cramer", {"fixed_delay": {"delay": 31e-6}}, provenance=ORIGIN), {}),
    "diagnosed_micropython": (Model("cramer", provenance=ORIGIN), {"package": "micropython"}),
    "filter": (Model("cramer"), {"target": "avr", "median": 5, "gate": 0.3}),
    "table": (Model("cramer"), {"form": "interpolated_table", "max_error": 0.2e-3}),
    "arduino": (Model("cramer"), {"target": "avr", "package": "arduino"}),
    "platformio": (Model("cramer"), {"target": "cortex-m0", "package": "platformio"}),
    "esphome": (Model("cramer"), {"package": "esphome"}),
    "micropython": (Model("cramer"), {"package": "micropython", "form": "interpolated_table"}),
}


def make(name: str) -> Firmware:
    model, request = CASES[name]
    return firmware.generate(model, temperature=(0.5, -20.0, 60.0), **request)


@pytest.mark.parametrize("name", CASES)
def test_files_are_fresh(name: str) -> None:
    made = make(name)
    for file in made.files:
        assert made.files[file] == (GOLDEN / name / file).read_text(), f"{name}/{file} has changed"
    here = (path.relative_to(GOLDEN / name) for path in (GOLDEN / name).rglob("*") if path.is_file())
    assert sorted(made.files) == sorted(map(str, here))


if __name__ == "__main__":
    for case in CASES:
        for file, text in make(case).files.items():
            (GOLDEN / case / file).parent.mkdir(parents=True, exist_ok=True)
            (GOLDEN / case / file).write_text(text, encoding="utf-8")
