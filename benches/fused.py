"""What a core with floating point could do instead: Cramer's polynomials in float, each step fused.

As good as it gets by hand: minimax up to rounding, range checks as in the generated functions, no library.
"""

import numpy as np
from hobby import Formula
from numpy.polynomial import Chebyshev

import echocal

CODES = np.arange(-320, 961)
DAMP = 100  # whole percents
CHECK = (
    "if (((echo_us - (uint32_t)ECHOCAL_ECHO_US_FIRST)"
    " > (uint32_t)(ECHOCAL_ECHO_US_LAST - ECHOCAL_ECHO_US_FIRST))"
    " || (code < -320) || (code > 960)%s) { return INT32_MIN; }"
    " const float e = (float)echo_us, t = (float)code%s; return (int32_t)(e * %s);"
)


def speeds(relative_humidity: float) -> np.ndarray:
    """Half the speed of sound [um/us] at every temperature code."""
    dry = {"co2_mole_fraction": 0.0, "law": "cramer"}
    return np.asarray(echocal.speed_of_sound(CODES * 0.0625, relative_humidity, **dry)) / 2


def horner(values: np.ndarray, degree: int) -> str:
    """A polynomial in the code as nested fused multiply-adds."""
    *rest, first = Chebyshev.fit(CODES, values, degree).convert(kind=np.polynomial.Polynomial).coef
    text = f"{first:.9g}f"
    for coefficient in reversed(rest):
        text = f"__builtin_fmaf({text}, t, {coefficient:.9g}f)"
    return text


def formulas() -> list[Formula]:
    """Of the temperature, and of temperature and humidity."""
    damps = np.arange(0, DAMP + 1, 10)
    every = np.array([speeds(damp / DAMP) for damp in damps])
    growth = (every[-1] - every[0]) / DAMP
    base = (every - damps[:, None] * growth).mean(axis=0)
    both = f"__builtin_fmaf(h, {horner(growth, 5)}, {horner(base, 2)})"
    return [
        Formula(
            "Cramer's parabola in float, fused",
            CHECK % ("", "", horner(speeds(0.0), 2)),
            library=False,
        ),
        Formula(
            "parabola + h * degree 5 in float, fused",
            CHECK % (f" || (damp > {DAMP}U)", ", h = (float)damp", both),
            humid=True,
            library=False,
        ),
    ]
