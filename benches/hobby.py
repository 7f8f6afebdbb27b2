"""What others compute on a microcontroller, as its users would type it: formulas to measure ours beside.

The laws stand here a second time on purpose: it is what somebody without echocal ships.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from echocal.firmware import Firmware

WARM = "const float warm = code * 0.0625f;"


@dataclass(frozen=True)
class Formula:
    """A formula: what it is, the body of its function, and whether it reads the humidity."""

    label: str
    body: str
    humid: bool = False
    library: bool = True


@dataclass(frozen=True)
class Written:
    """The C of a formula, with the header and the codes of a generated function beside it."""

    files: Mapping[str, str]
    report: Mapping[str, Any]


FORMULAS = [
    Formula("`us / 58`, no temperature", "return (int32_t)(echo_us * 10000UL / 58UL);", library=False),
    Formula(
        "`331.4 + 0.6 * T` in float",
        f"{WARM} return (int32_t)(echo_us * (331.4f + 0.6f * warm) * 0.5f);",
        library=False,
    ),
    # Martinsos/arduino-lib-hc-sr04, src/HCSR04.cpp: cm per us, the echo halved.
    Formula(
        "`0.03313 + 0.0000606 * T` in float, as HCSR04 of Martinsos",
        f"{WARM} const float speed = 0.03313f + 0.0000606f * warm;"
        " return (int32_t)(echo_us / 2.0f * speed * 10000.0f);",
        library=False,
    ),
    Formula(
        "`331.3 * sqrt(1 + T / 273.15)` in float",
        f"{WARM} return (int32_t)(echo_us * (331.3f * sqrtf(1.0f + warm / 273.15f)) * 0.5f);",
    ),
    # RobTillaart/SRF05, SRF05.cpp, calculateSpeedOfSound: between a dry root and a straight line at 100 %.
    Formula(
        "dry root to moist line in float, as SRF05 of Tillaart",
        f"{WARM} float speed = 331.45f * sqrtf(1.0f + warm / 273.15f);"
        " if (damp > 0) { speed += (332.392083694084f + 0.683791630591631f * warm - speed) * damp * 0.01f; }"
        " return (int32_t)(speed * echo_us * 0.5f);",
        humid=True,
    ),
    # Cramer 1993 with Davis 1992 at 101325 Pa and no CO2, nothing folded by hand.
    Formula(
        "Cramer 1993 in float",
        f"""{WARM}
    const float t = warm, k = t + 273.15f, p = 101325.0f;
    const float psv = expf(1.2378847e-5f * k * k - 1.9121316e-2f * k + 33.93711047f - 6343.1645f / k);
    const float xw = damp * 0.01f * (1.00062f + 3.14e-8f * p + 5.6e-7f * t * t) * psv / p;
    const float speed = 331.5024f + 0.603055f * t - 0.000528f * t * t
        + (51.471935f + 0.1495874f * t - 0.000782f * t * t) * xw
        + (-1.82e-7f + 3.73e-8f * t - 2.93e-10f * t * t) * p
        - 2.835149f * xw * xw - 2.15e-13f * p * p;
    return (int32_t)(speed * echo_us * 0.5f);""",
        humid=True,
    ),
]

SOURCE = """#include "echocal_correction.h"
%s
int32_t echocal_distance_um(uint16_t echo_us, int16_t code%s)
{
    (void)code;
    %s
}
"""


def written(formula: Formula, beside: Firmware) -> Written:
    """The C of a formula with the codes of a generated function."""
    source = SOURCE % (
        "#include <math.h>" if formula.library else "",
        ", uint8_t damp" if formula.humid else "",
        formula.body,
    )
    return Written({**beside.files, "echocal_correction.c": source}, beside.report)
