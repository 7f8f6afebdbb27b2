"""Data sheets: the sensor's accuracy and the thermometers'."""

from echocal.model import Model
from echocal.study.checks.benchmarks import crossing
from echocal.study.sensor import REFERENCE_LAW, STATED_LAW
from echocal.study.tables import DISTANCE, Tables
from echocal.study.verdict import Claim, Finding, check


@check
def within_datasheet(tables: Tables, claim: Claim) -> Finding:
    """Temperatures between which the uncompensated sensor keeps the accuracy of its data sheet."""
    tolerance = claim.number.value * 1e-3
    stated = [crossing(STATED_LAW, DISTANCE + side) for side in (tolerance, -tolerance)]
    real = [
        crossing(REFERENCE_LAW, DISTANCE + side, relative_humidity=0.5) for side in (tolerance, -tolerance)
    ]
    table = tables.table1
    outside = int((abs(table.values("measured_distance_m") - DISTANCE) > tolerance).sum())
    because = (
        f"±{claim.printed} mm at 2 m holds from {stated[0]:.1f} to {stated[1]:.1f} °C by the study's "
        f"equation; "
        f"{outside} of {len(table)} rows of Table 1 are outside"
    )
    physical = f"{real[0]:.1f} to {real[1]:.1f} °C at 50 % RH"
    numbers = {"low": stated[0], "high": stated[1]}
    return claim.found(
        outside > 0, f"{stated[0]:.1f}–{stated[1]:.1f} °C", because, physical=physical, numbers=numbers
    )


@check
def thermometer(tables: Tables, claim: Claim, *, residual: float) -> Finding:
    """Whether a thermometer of this accuracy allows the residual that the study claims."""
    half = claim.number.value
    ends = tables.table1.temperature[[0, -1]]
    model = Model(STATED_LAW, {"temperature_offset": {"offset": half}})
    shift = abs(model.indicate(DISTANCE, temperature=ends) - DISTANCE)
    worst = float(shift.max())
    percent = worst / DISTANCE * 100.0
    because = (
        f"±{claim.printed} °C alone is ±{float(shift.min()) * 1e3:.2f} to ±{worst * 1e3:.2f} mm at 2 m, "
        f"up to {percent:.3f} %: more than the {residual:g} % that the compensation is said to leave"
    )
    if percent < residual:
        because = f"±{claim.printed} °C is at most {percent:.3f} %, less than {residual:g} %"
    numbers = {"millimeters": worst * 1e3, "percent": percent}
    return claim.found(percent < residual, f"±{worst * 1e3:.1f} mm", because, numbers=numbers)
