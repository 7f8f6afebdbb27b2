"""Figures of a calibration, a verification and an inspection."""

import numpy as np
import pandas as pd

from echocal.calibrate import Calibration
from echocal.charts.parts import Axis, Bar, Bars, Chart, Panel, Points, evenly, span
from echocal.observations.inspection import ColumnFacts, Inspection
from echocal.verify import Verification

__all__ = ["columns_chart", "errors_chart", "residual_chart"]

_MM = 1e3  # mm in a meter


def residual_chart(found: Calibration) -> Chart:
    """Residuals over the rows."""
    used = np.flatnonzero(np.isfinite(found.residuals))
    rows = used[evenly(len(used))]
    residual = Points("residual", "after", rows + 1.0, found.residuals[rows])
    y = Axis("observed minus predicted [unit of the response]", *span([residual.y]))
    return Chart("Residuals", Axis("row", 0.0, len(found.residuals) + 1.0), [Panel("", y, [residual])])


def errors_chart(found: Verification) -> Bars:
    """Magnitude of the errors beside the maximum permissible error."""
    texts = {
        "largest": (found.maximum_error, "+"),
        "mean": (found.mean_error, "+"),
        "RMS": (found.rms_error, ""),
    }
    bars = [
        Bar(
            name,
            _MM * abs(error),
            f"{_MM * error:{sign}.3g} mm",
            "out" if _is_beyond(error, found) else "after",
        )
        for name, (error, sign) in texts.items()
    ]
    bound = _MM * found.maximum_permissible_error
    bars.append(Bar("maximum permissible", bound, f"{bound:.3g} mm", "quiet"))
    return Bars("Errors", "magnitude of the error [mm]", bars, max(bar.value for bar in bars))


def columns_chart(found: Inspection) -> Chart | None:
    """Each column of numbers over the rows; None where there is none."""
    panels = [_column(found.table, one) for one in found.columns if one.median is not None]
    return Chart("", Axis("row", 0.0, found.rows + 1.0), panels) if panels else None


def _is_beyond(error: float, found: Verification) -> bool:
    return abs(error) > found.maximum_permissible_error


def _column(table: pd.DataFrame, one: ColumnFacts) -> Panel:
    values = pd.to_numeric(table[one.name], errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan)
    known = np.flatnonzero(np.isfinite(values) & ~np.isin(values, one.codes))
    rows = known[evenly(len(known))]
    unit = f" [{one.unit}]" if one.unit else ""
    y = Axis("", *span([values[rows]]))
    return Panel(f"{one.name}{unit}", y, [Points(one.name, "after", rows + 1.0, values[rows])])
