"""The study's laws of sound in true air, and what its compensation formula leaves over."""

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate import Calibration, calibrate
from echocal.model import Model
from echocal.observations import read_observations
from echocal.study.origin import REFERENCE_LAW, STATED_LAW, error, reading_in, speed
from echocal.study.tables import DISTANCE, Tables, observations
from echocal.study.verdict import Claim, Finding, Verdict, check

Array = NDArray[np.float64]


def best_line(law: str, temperature: np.ndarray, **air: float) -> Calibration:
    """Fit a linear law to the echo times that another law gives over a range of temperatures."""
    echo = Model(law).time_of_flight(DISTANCE, temperature=temperature, **air)
    table = {"echo_s": echo, "temperature_C": temperature, "distance_m": np.full_like(temperature, DISTANCE)}
    return calibrate(read_observations(table), Model(STATED_LAW), fit=["law.intercept", "law.slope"])


@check
def ascription(tables: Tables, claim: Claim) -> Finding:
    """Whether Cramer (1993) is the source of 331.4 + 0.6 T."""
    temperature = tables.table1.range(51)
    away = speed(STATED_LAW, temperature) - speed("cramer", temperature)
    line = best_line("cramer", temperature)
    a, b = line["law.intercept"].value, line["law.slope"].value
    because = (
        f"Cramer's equation has 16 coefficients and is not linear; in dry air 331.4 + 0.6 T differs from it "
        f"by {away.min():+.2f} to {away.max():+.2f} m/s; the best line for it over 0–50 °C is "
        f"{a:.2f} + {b:.4f} T"
    )
    wrong = np.abs(away).max() > 300e-6 * a  # Cramer's own stated uncertainty, 300 ppm
    numbers = {"low": away.min(), "high": away.max(), "intercept": a, "slope": b}
    verdict = Verdict.PHYSICALLY_WRONG if wrong else Verdict.REPRODUCED
    return claim.found(
        verdict, f"{a:.2f} + {b:.3f} T", because, physical="a curve, see Cramer 1993", numbers=numbers
    )


@check
def validity(tables: Tables, claim: Claim) -> Finding:
    """Whether the equation is valid for dry air to the accuracy that the study claims with it."""
    temperature = tables.table1.range(51)
    true = speed(REFERENCE_LAW, temperature)
    off = (speed(STATED_LAW, temperature) / true - 1.0) * 100.0
    worst = int(np.abs(off).argmax())
    holds = temperature[np.abs(off) < claim.number.value]
    because = (
        f"in dry air its error is {off[worst]:+.2f} % at {temperature[worst]:g} °C "
        f"({off[worst] * DISTANCE * 10.0:+.1f} mm at 2 m); "
        f"it is within the claimed {claim.printed} % only up to {holds.max():.0f} °C"
    )
    wrong = np.abs(off).max() >= claim.number.value
    verdict = Verdict.PHYSICALLY_WRONG if wrong else Verdict.REPRODUCED
    physical = f"{true[worst]:.2f} m/s at {temperature[worst]:g} °C, dry"
    return claim.found(
        verdict, f"{abs(off[worst]):.2f}", because, physical=physical, numbers={"worst": off[worst]}
    )


@check
def rise(tables: Tables, claim: Claim) -> Finding:
    """Rise of the speed of sound per degree: in Table 1, and in true air."""
    table = tables.table1
    steps = np.diff(table.values("actual_speed_m_s")) / np.diff(table.temperature)
    ends = table.temperature[[0, -1]]
    slopes = {}
    for humidity in (0.0, 0.5):
        low, high = (speed(REFERENCE_LAW, ends + side, relative_humidity=humidity) for side in (-0.5, 0.5))
        slopes[humidity] = high - low
    because = (
        f"Table 1's steps are {steps.min():.3f} to {steps.max():.3f} m/s per °C, "
        f"{steps.mean():.3f} on average; true air has {slopes[0.0][0]:.2f} at 0 °C to {slopes[0.0][1]:.2f} "
        f"at 50 °C when dry, "
        f"{slopes[0.5][0]:.2f} to {slopes[0.5][1]:.2f} at 50 % RH"
    )
    physical = f"{slopes[0.5][0]:.2f} to {slopes[0.5][1]:.2f} at 50 % RH"
    return claim.found(claim.number.holds(steps.mean()), f"{steps.mean():.3f}", because, physical=physical)


@check
def speed_at(tables: Tables, claim: Claim, *, temperature: float) -> Finding:
    """Speed at one temperature by the study's equation."""
    stated = float(speed(STATED_LAW, temperature))
    real = {h: float(speed(REFERENCE_LAW, temperature, relative_humidity=h)) for h in (0.0, 0.5)}
    printed = tables.table1.columns["actual_speed_m_s"][
        int(np.flatnonzero(tables.table1.temperature == temperature)[0])
    ]
    off = float(error(reading_in(REFERENCE_LAW, temperature, relative_humidity=0.5)))
    because = (
        f"331.4 + 0.6 T gives {stated:.1f} m/s, Table 1 prints {printed.text}; "
        f"true air has {real[0.0]:.2f} when dry and {real[0.5]:.2f} at 50 % RH "
        f"({off * DISTANCE * 10.0:+.1f} mm at 2 m)"
    )
    physical = f"{real[0.5]:.2f} m/s at 50 % RH"
    return claim.found(claim.number.holds(stated), f"{stated:.1f}", because, physical=physical)


def residual(temperature: Array, reading: Array) -> Array:
    """Error [%] of readings after the study's compensation d (331.4 + 0.6 T) / 343."""
    echo = observations(temperature, reading).echo_time
    return error(Model(STATED_LAW).distance(echo, temperature=temperature))


@check
def compensated(tables: Tables, claim: Claim, *, of: str) -> Finding:
    """Worst residual of a column after compensation, within the rounding of its cells."""
    table = tables.table1 if of == "measured_distance_m" else tables.table2
    temperature, reading, half = table.temperature, table.values(of), table.half(of)
    ends = np.stack([residual(temperature, reading - half), residual(temperature, reading + half)])
    smallest = np.where(np.prod(np.sign(ends), axis=0) <= 0.0, 0.0, np.abs(ends).min(axis=0))
    worst = np.abs(residual(temperature, reading))
    row = int(worst.argmax())
    over = int((worst >= claim.number.value).sum())
    because = (
        f"the printed distances leave up to {worst[row]:.3f} % (at {temperature[row]:g} °C), "
        f"{over} of {len(table)} rows at {claim.printed} % or more; "
        f"within their rounding, the smallest possible value is {smallest.max():.3f} %"
    )
    numbers = {"worst": worst.max(), "best": smallest.max()}
    return claim.found(
        smallest.max() < claim.number.value,
        f"{smallest.max():.3f}–{worst.max():.3f}",
        because,
        numbers=numbers,
    )


@check
def compensated_in_air(tables: Tables, claim: Claim) -> Finding:
    """Worst residual of the compensation in true air, 0 to 100 % RH."""
    temperature = tables.table1.range(101)
    worst = {
        humidity: residual(temperature, reading_in(REFERENCE_LAW, temperature, relative_humidity=humidity))
        for humidity in (0.0, 0.5, 1.0)
    }
    size = {humidity: float(np.abs(left).max()) for humidity, left in worst.items()}
    because = (
        f"true air leaves up to {size[0.0]:.2f} % when dry, {size[0.5]:.2f} % at 50 % RH "
        f"and {size[1.0]:.2f} % at 100 % RH ({size[1.0] * 20.0:.0f} mm at 2 m)"
    )
    holds = max(size.values()) < claim.number.value
    verdict = Verdict.REPRODUCED if holds else Verdict.PHYSICALLY_WRONG
    numbers = {"dry": size[0.0], "half": size[0.5], "saturated": size[1.0]}
    return claim.found(
        verdict, f"{size[0.5]:.2f}", because, physical=f"{size[0.5]:.2f} % at 50 % RH", numbers=numbers
    )
