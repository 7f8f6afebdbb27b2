"""The median filter: its C gives the twin's outputs and statuses, in every order of a window."""

import csv
import functools
import io
import itertools
from pathlib import Path

import numpy as np
import pytest
from conftest import made
from test_misra import findings
from toolchain import STRICT, run

from echocal import Model, UsageError, firmware
from echocal.firmware import Firmware

HALF_DEGREES = (0.5, -20.0, 60.0)
OUT_OF_RANGE = -(2**31)
TOO_FEW, OUTLIERS = 254, 255
EVERY_ORDER = """
#include <stdio.h>
#include "echocal_correction.h"
#include "echocal_filter.h"
#define CHOICES (ECHOCAL_FILTER_WINDOW + 1U)
int main(void)
{
    unsigned long window, count = 1UL;
    unsigned int place;
    for (place = 0U; place < ECHOCAL_FILTER_WINDOW; place++) {
        count *= CHOICES;
    }
    for (window = 0UL; window < count; window++) {
        static const echocal_filter_state fresh;
        echocal_filter_state state = fresh;
        unsigned long rest = window;
        int32_t given = 0;
        for (place = 0U; place < ECHOCAL_FILTER_WINDOW; place++) {
            const int32_t choice = (int32_t)(rest % CHOICES);
            rest /= CHOICES;
            given = (choice == 0) ? echocal_filter(&state, ECHOCAL_OUT_OF_RANGE, ECHOCAL_NO_ECHO)
                                  : echocal_filter(&state, choice, ECHOCAL_OK);
        }
        (void)putchar((given == ECHOCAL_OUT_OF_RANGE) ? ('A' + state.status) : ('0' + given));
    }
    return 0;
}
"""
EACH = """
#include <stdio.h>
#include "echocal_filter.h"
int main(void)
{
    static echocal_filter_state state;
    long distance;
    unsigned int status;
    while (scanf("%ld %u", &distance, &status) == 2) {
        const int32_t given = echocal_filter(&state, (int32_t)distance, (uint8_t)status);
        printf("%ld %u\\n", (long)given, (unsigned int)state.status);
    }
    return 0;
}
"""


@functools.cache
def filtering(median: int, gate: float | None = None, package: str = "c", unit: str = "um") -> Firmware:
    request = {"temperature": HALF_DEGREES, "output_unit": unit, "max_error": 2e-3}
    return firmware.generate(Model("cramer"), median=median, gate=gate, package=package, **request)


def program(packed: Firmware, folder: Path, text: str, compiler: str = "gcc") -> Path:
    packed.save(folder)
    (folder / "main.c").write_text(text)
    parts = (folder / "main.c", folder / "echocal_filter.c")
    run(compiler, "-std=c99", "-O2", *STRICT, f"-I{folder}", *parts, "-o", folder / compiler)
    return folder / compiler


def rows(packed: Firmware) -> np.ndarray:
    lines = csv.reader(io.StringIO(packed.files["echocal_filter_golden.csv"]))
    return np.array([*itertools.islice(lines, 1, None)], dtype=np.int64)


@pytest.mark.parametrize("median", [3, 5, 7])
def test_every_order_of_a_window(median: int, tmp_path: Path) -> None:
    """Without a gate only the order counts: these windows have each order, each tie and each gap there is."""
    said = run(program(filtering(median), tmp_path, EVERY_ORDER))
    window = np.arange((median + 1) ** median)[:, None] // (median + 1) ** np.arange(median) % (median + 1)
    heard = (window > 0).sum(axis=1)
    middle = median - heard + (heard - 1) // 2  # the lower of two
    medians = np.take_along_axis(np.sort(window), np.minimum(middle, median - 1)[:, None], axis=1)[:, 0]
    expected = np.where(heard > median // 2, medians + ord("0"), ord("A") + 1)
    assert (np.frombuffer(said.encode(), np.uint8) == expected).all()


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    ("median", "gate"), [(3, None), (3, 0.3), (5, 1e-6), (5, 0.02), (7, 2147.0), (7, 0.1)]
)
def test_the_c_gives_what_the_twin_gives(
    compiler: str, median: int, gate: float | None, random: np.random.Generator, tmp_path: Path
) -> None:
    packed = filtering(median, gate)
    golden = rows(packed)
    width = 3 * int((gate or 0.1) * 1e6)
    scattered = random.integers(-width, width, 3000).clip(OUT_OF_RANGE + 1, 2**31 - 1)
    ends = random.choice([OUT_OF_RANGE, OUT_OF_RANGE + 1, -1, 0, 1, 2**31 - 1], 3000)
    distances = np.concatenate([golden[:, 0], np.where(random.random(3000) < 0.7, scattered, ends)])
    statuses = np.concatenate([golden[:, 1], random.choice([0, 0, 0, 0, 1, 2, 5], 3000)])
    text = "\n".join(f"{distance} {status}" for distance, status in zip(distances, statuses, strict=True))
    answers = run(program(packed, tmp_path, EACH, compiler), text=text).split()
    said = np.array(answers, dtype=np.int64).reshape(-1, 2)
    outputs, why = packed.filtered(distances, statuses)
    assert (said[:, 0] == outputs).all()
    assert (said[:, 1] == why).all()
    assert (said[: len(golden)] == golden[:, 2:]).all()
    assert ((why == 0) == (outputs != OUT_OF_RANGE)).all()
    assert {TOO_FEW, 0, 1} <= set(why.tolist())
    assert (OUTLIERS in why) == (gate is not None)


def test_a_true_step_is_followed_after_a_majority_of_measurements() -> None:
    distances, statuses = [1_000_000] * 5 + [2_000_000] * 5, [0] * 10
    outputs, why = filtering(5, 0.3).filtered(distances, statuses)
    assert outputs.tolist() == [OUT_OF_RANGE] * 2 + [1_000_000] * 5 + [2_000_000] * 3
    assert why.tolist() == [TOO_FEW] * 2 + [0] * 8


def test_the_golden_sequence_has_every_kind_of_answer() -> None:
    for median, gate in itertools.product([3, 5, 7], [None, 0.1]):
        found = set(rows(filtering(median, gate))[:, 3].tolist())
        assert {0, 1, 3, TOO_FEW} <= found
        assert (OUTLIERS in found) == (gate is not None)


def test_a_state_that_was_overwritten_does_not_lead_out_of_itself(tmp_path: Path) -> None:
    """A state in memory that survives a reset may hold anything."""
    text = EACH.replace(
        "static echocal_filter_state state;", "echocal_filter_state state;\nstate.next = 255U;"
    )
    spoiled = program(
        filtering(3),
        tmp_path,
        text.replace("state.next", "fill(&state); state.next").replace(
            "int main",
            "#include <string.h>\nstatic void fill(void *state)\n{\n"
            "    (void)memset(state, 0xA5, sizeof(echocal_filter_state));\n}\nint main",
        ),
    )
    answers = run(spoiled, text="1000 0\n1001 0\n1002 0\n1003 0\n").split()
    assert answers[4:] == ["1001", "0", "1002", "0"], "three measurements later it is as a new one"


@pytest.mark.parametrize("package", ["arduino", "platformio", "esp-idf", "zephyr"])
def test_each_package_with_c_has_it_and_compiles_it(package: str) -> None:
    files = filtering(5, 0.3, package).files
    sources = [path for path in files if path.endswith("echocal_filter.c")]
    assert len(sources) == 1
    assert sources[0].replace("filter", "correction") in files
    listed = {"esp-idf": "CMakeLists.txt", "zephyr": "zephyr/CMakeLists.txt"}.get(package)
    if listed:
        assert "src/echocal_filter.c" in files[listed]
    if package == "arduino":
        assert any(
            '#include "echocal_filter.h"' in text for path, text in files.items() if "Echocal_" in path
        )
        assert "echocal_filter\tKEYWORD2" in files["keywords.txt"]


def test_without_one_nothing_is_written_of_it() -> None:
    for package in ("c", "arduino", "esp-idf"):
        files = made("degree_2", package).files
        assert not [path for path in files if "filter" in path]
        assert not [path for path, text in files.items() if "filter" in text.lower()]


def test_two_sensors_have_two_filters() -> None:
    packed = firmware.generate(Model("cramer"), temperature=HALF_DEGREES, median=3, name="left_tank")
    text = packed.files["left_tank_filter.c"] + packed.files["left_tank_filter.h"]
    assert "int32_t left_tank_filter(left_tank_filter_state *state" in text
    assert "echocal_" not in text.lower()


def test_the_command_makes_it_again() -> None:
    report = filtering(5, 0.3, unit="mm").report
    assert "--median 5 --gate-mm 300" in report["provenance"]["command"]
    assert report["provenance"]["filter"] == {"gate": 300, "window": 5}


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ({"median": 4}, "a median of 4 measurements is not offered; choose 3, 5 or 7"),
        ({"median": 2.5}, "median is 2.5; give a whole number"),
        (
            {"gate": 0.3},
            "a gate is about a median of the last distances, and none is wanted: give median=5 too",
        ),
        (
            {"median": 3, "gate": 1e-9},
            "the gate is 0.000001 mm: give at least 0.001 mm, one unit of the output",
        ),
        (
            {"median": 3, "package": "esphome"},
            "the package esphome has no median filter; ESPHome has its own",
        ),
        ({"median": 3, "package": "rust"}, "the package rust has no median filter; it is written in C"),
        ({"median": 3, "package": "micropython"}, "the package micropython has no median filter"),
    ],
)
def test_what_cannot_be_is_refused_before_the_proof(wish: dict[str, object], said: str) -> None:
    proofs: list[object] = []
    with pytest.raises(UsageError, match=said):
        firmware.generate(Model("cramer"), progress=lambda *step: proofs.append(step), **wish)
    assert not proofs


@pytest.mark.parametrize(
    ("measurements", "said"),
    [
        (([1.5], [0]), "distances has dtype float64"),
        (([1], [256]), "statuses is 256 in row 0, outside 0 .. 255"),
        (([1, 2], [0]), "2 distances and 1 statuses"),
    ],
)
def test_the_twin_refuses_what_the_function_does_not_take(measurements: tuple[list, list], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        filtering(3).filtered(*measurements)
    with pytest.raises(UsageError, match="no median filter: generate it with median=5"):
        made("degree_2").filtered([1], [0])


@pytest.mark.slow
@pytest.mark.parametrize("gate", [None, 0.3])
def test_misra(gate: float | None, tmp_path: Path) -> None:
    assert findings(filtering(5, gate), tmp_path, "filter.c") <= {
        ("echocal_filter.h", "2.5"),
        ("echocal_correction.h", "2.5"),
    }
