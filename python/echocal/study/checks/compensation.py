"""What the study's compensation formula leaves over."""

import numpy as np
from numpy.typing import NDArray

from echocal.model import Model
from echocal.study.sensor import REFERENCE_LAW, STATED_LAW, error, reading_in
from echocal.study.tables import Tables, observations
from echocal.study.verdict import Claim, Finding, Verdict, check

Array = NDArray[np.float64]


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
