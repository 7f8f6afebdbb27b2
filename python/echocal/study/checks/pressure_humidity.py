"""What the study says about humidity and pressure, against true air."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.study.origin import REFERENCE_LAW, reading_in, speed
from echocal.study.tables import DISTANCE, Tables
from echocal.study.verdict import Claim, Finding, Verdict, check

HUMIDITY_COEFFICIENT = 0.00016
STANDARD_PRESSURE = 101325.0  # Pa

ROOM = 20.0  # degC
AROUND = 99e3  # Pa; ten percent more and less are within the domain of the reference law


def _gain(temperature: float, humidity: float) -> float:
    """Relative gain of the speed of sound over dry air."""
    return (
        float(
            speed(REFERENCE_LAW, temperature, relative_humidity=humidity) / speed(REFERENCE_LAW, temperature)
        )
        - 1.0
    )


def _wrong(*, right: bool) -> Verdict:
    return Verdict.REPRODUCED if right else Verdict.PHYSICALLY_WRONG


@check
def humidity_coefficient(tables: Tables, claim: Claim) -> Finding:
    """The coefficient per percent of relative humidity."""
    true = {t: _gain(t, 1.0) / 100.0 for t in (0.0, ROOM, 50.0)}
    because = (
        f"true air gains {true[0.0]:.2g} per % RH at 0 °C, {true[ROOM]:.2g} at 20 °C and {true[50.0]:.2g} "
        f"at 50 °C; "
        f"no constant fits, and {claim.printed} is {HUMIDITY_COEFFICIENT / true[ROOM]:.1f} times too much "
        f"at 20 °C"
    )
    right = all(claim.number.holds(value) for value in true.values())
    numbers = {"at_0": true[0.0], "at_20": true[ROOM], "at_50": true[50.0]}
    return claim.found(
        _wrong(right=right),
        f"{true[ROOM]:.2g}",
        because,
        physical=f"{true[ROOM]:.2g} at 20 °C",
        numbers=numbers,
    )


@check
def humidity_gain(tables: Tables, claim: Claim) -> Finding:
    """The gain that the study computes from its own formula at RH = 100 %."""
    percent, fraction = ((float(refuted_humidity(1.0, rh)) - 1.0) * 100.0 for rh in (100.0, 1.0))
    true = _gain(ROOM, 1.0) * 100.0
    because = (
        f"the study's own formula gives +{percent:.1f} % with RH in percent and +{fraction:.3f} % with RH "
        f"as 0 to 1; "
        f"true air at 20 °C gains +{true:.2f} %, {true / fraction:.0f} times the claim"
    )
    numbers = {"percent": percent, "fraction": fraction, "true": true}
    return claim.found(
        _wrong(right=claim.number.holds(true)),
        f"{percent:.1f}",
        because,
        physical=f"+{true:.2f} % at 20 °C",
        numbers=numbers,
    )


@check
def humidity_negligible(tables: Tables, claim: Claim) -> Finding:
    """Whether humidity can be neglected over the study's distance, against the datasheet's accuracy."""
    shift = {
        t: abs(float(reading_in(REFERENCE_LAW, t, relative_humidity=1.0) - reading_in(REFERENCE_LAW, t)))
        * 1e3
        for t in (0.0, ROOM, 50.0)
    }
    because = (
        f"from dry to 100 % RH the reading at 2 m changes by {shift[0.0]:.1f} mm at 0 °C, {shift[ROOM]:.1f} "
        f"mm at 20 °C "
        f"and {shift[50.0]:.0f} mm at 50 °C, against the ±{claim.printed} mm of the datasheet"
    )
    right = max(shift.values()) < claim.number.value
    return claim.found(
        _wrong(right=right),
        f"{shift[ROOM]:.1f}",
        because,
        physical=f"{shift[50.0]:.0f} mm at 50 °C",
        numbers={"at_50": shift[50.0]},
    )


def _pressure_gain(change: float) -> float:
    """True relative change of the speed [%] at 20 degC, 50 % RH."""
    at = {"relative_humidity": 0.5}
    changed = speed(REFERENCE_LAW, ROOM, pressure=AROUND * (1.0 + change), **at)
    return float(changed / speed(REFERENCE_LAW, ROOM, pressure=AROUND, **at) - 1.0) * 100.0


@check
def pressure_percent(tables: Tables, claim: Claim) -> Finding:
    """What ten percent of pressure does to the speed of sound."""
    claimed = [float(refuted_pressure(100.0, STANDARD_PRESSURE * f)) - 100.0 for f in (0.9, 1.1)]
    true = [_pressure_gain(change) for change in (-0.1, 0.1)]
    because = (
        f"the square root gives {claimed[0]:+.2f} and {claimed[1]:+.2f} %, so the arithmetic is right; "
        f"true air at 20 °C, 50 % RH changes by {true[0]:+.3f} and {true[1]:+.3f} %, "
        f"{abs(claimed[1] / true[1]):.0f} times less"
    )
    right = claim.number.holds(abs(true[1]))
    numbers = {
        "claimed_low": claimed[0],
        "claimed_high": claimed[1],
        "true_low": true[0],
        "true_high": true[1],
    }
    return claim.found(
        _wrong(right=right),
        f"{claimed[1]:.1f}",
        because,
        physical=f"{true[0]:+.3f} and {true[1]:+.3f} %",
        numbers=numbers,
    )


@check
def pressure_exponent(tables: Tables, claim: Claim) -> Finding:
    """The power of pressure that the speed of sound follows."""
    low, high = (float(np.log1p(_pressure_gain(change) / 100.0) / np.log1p(change)) for change in (-0.1, 0.1))
    exponent = 0.5 * (low + high)
    because = (
        f"at fixed temperature, pressure and density rise together; the speed is proportional to p to the "
        f"power {exponent:+.4f}, "
        f"not {claim.printed}"
    )
    return claim.found(
        _wrong(right=claim.number.holds(exponent)),
        f"{exponent:+.4f}",
        because,
        physical=f"{exponent:+.4f}",
        numbers={"exponent": exponent},
    )


@check
def pressure_altitude(tables: Tables, claim: Claim, *, pressure: float) -> Finding:
    """What the claimed pressure compensation would do at altitude."""
    claimed = float(refuted_pressure(speed(REFERENCE_LAW, ROOM, relative_humidity=0.5), pressure))
    true = float(speed(REFERENCE_LAW, ROOM, relative_humidity=0.5, pressure=pressure))
    spoiled = (claimed / true - 1.0) * DISTANCE * 1e3
    gain = (true / float(speed(REFERENCE_LAW, ROOM, relative_humidity=0.5)) - 1.0) * DISTANCE * 1e3
    because = (
        f"at {pressure / 100.0:.0f} hPa (about 1900 m) the true reading changes by {gain:+.1f} mm at 2 m; "
        f"the claimed compensation would change it by {spoiled:+.0f} mm"
    )
    right = abs(gain) > claim.number.value
    return claim.found(
        _wrong(right=right),
        f"{spoiled:+.0f}",
        because,
        physical=f"{gain:+.1f} mm",
        numbers={"spoiled": spoiled, "gain": gain},
    )


def refuted_humidity(dry_speed: ArrayLike, relative_humidity: ArrayLike) -> NDArray[np.float64]:
    """REFUTED: speed of sound [m/s] in humid air as section III.B of the study has it.

    Its "RH" is in percent in one sentence and 0 to 1 in the next.
    """
    return np.asarray(dry_speed) * (1.0 + HUMIDITY_COEFFICIENT * np.asarray(relative_humidity))


def refuted_pressure(speed: ArrayLike, pressure: ArrayLike) -> NDArray[np.float64]:
    """REFUTED: speed of sound [m/s] "proportional to the square root of absolute pressure"."""
    return np.asarray(speed) * np.sqrt(np.asarray(pressure) / STANDARD_PRESSURE)
