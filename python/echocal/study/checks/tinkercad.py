"""The Tinkercad column: whether it replicates the calculation, and what latency could explain."""

import numpy as np

from echocal.study.origin import explain, table_law
from echocal.study.tables import Tables
from echocal.study.verdict import Cell, Claim, Finding, Verdict, check


@check
def replicates(tables: Tables, claim: Claim) -> Finding:
    """Rows in which Tinkercad and the calculation agree within the data sheet's accuracy."""
    table = tables.table2
    away = (
        table.values("measured_distance_tinkercad_m") - table.values("measured_distance_calculation_m")
    ) * 1e3
    rounding = (
        table.half("measured_distance_tinkercad_m") + table.half("measured_distance_calculation_m")
    ) * 1e3
    inside = np.abs(away) - rounding <= claim.number.value
    cells = tuple(
        Cell(
            row + 1,
            float(table.temperature[row]),
            printed.text,
            float(table.values("measured_distance_calculation_m")[row]),
            Verdict.REPRODUCED if inside[row] else Verdict.NOT_REPRODUCED,
        )
        for row, printed in enumerate(table.columns["measured_distance_tinkercad_m"])
    )
    because = (
        f"{int(inside.sum())} of {len(table)} rows agree within ±{claim.printed} mm; "
        f"every reading is too short, by {-away.max():.0f} to {-away.min():.0f} mm, {-away.mean():.1f} mm on "
        f"average"
    )
    if away.max() >= 0.0:
        because = f"{int(inside.sum())} of {len(table)} rows agree within ±{claim.printed} mm"
    numbers = {"mean": float(away.mean()), "scatter": float(away.std(ddof=1))}
    return claim.found(
        bool(inside.all()), f"{int(inside.sum())}/{len(table)}", because, cells=cells, numbers=numbers
    )


@check
def latency(tables: Tables, claim: Claim) -> Finding:
    """The delay that would explain Tinkercad's readings; a latency cannot be negative."""
    delay = explain(tables, ["fixed_delay.delay"])["fixed_delay.delay"]
    micro, sigma = delay.value * 1e6, delay.standard_uncertainty * 1e6
    because = (
        f"calibrated against {table_law(tables)}, the delay that explains the column is "
        f"{micro:.1f} ± {sigma:.1f} µs: "
    )
    if micro < -2.0 * sigma:
        because += "negative, while a latency lengthens the echo and can only make readings longer"
        verdict = Verdict.PHYSICALLY_WRONG
    else:
        because += "not negative, so a latency may explain it"
        verdict = Verdict.REPRODUCED
    return claim.found(
        verdict, f"{micro:.1f}", because, physical="≥ 0 µs", numbers={"delay_us": micro, "sigma_us": sigma}
    )
