"""Results in a notebook and in the terminal: a headline, an explanation, a table."""

import base64
import io
import warnings
from functools import singledispatch
from html import escape

import numpy as np
import pandas as pd

from echocal.budget import Budget
from echocal.budget.coverage import plus_minus
from echocal.calibrate import Calibration
from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.results.explain import lead
from echocal.errors import DomainWarning, EchocalError
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import QUANTITIES
from echocal.registry import effects
from echocal.report.budget import probability_text
from echocal.report.echo_times import counted, echo_table, said
from echocal.shown import Shown
from echocal.verify import Verification
from echocal.waveforms import EchoTimes

_MM = 1e3  # mm in a meter
_DPI = 80  # of a figure in a notebook


@singledispatch
def headline(result: object) -> str:
    """Say in a line what a result is."""
    raise TypeError(type(result).__name__)


@singledispatch
def dataframe(result: object) -> pd.DataFrame:
    """Return a result as a table."""
    raise TypeError(type(result).__name__)


@singledispatch
def explanation(result: object) -> str:
    """Explain a result: its headline and its table."""
    table = dataframe(result)
    notes = "".join(f"\nNote: {note}." for note in getattr(result, "notes", ()))
    return headline(result) + ("\n" + table.to_string() if len(table) else "") + notes


def html(result: Shown) -> str:
    """Return the headline, of a diagnosis its sentence, the figure and the table as HTML."""
    said = f"<p>{escape(lead(result))}.</p>" if isinstance(result, Diagnosis) else ""
    notes = "".join(f"<li>{escape(note)}</li>" for note in getattr(result, "notes", ()))
    listed = f"<ul>{notes}</ul>" if notes else ""
    table = dataframe(result).to_html(max_rows=10, border=0, escape=True)
    return f"<p><b>{escape(headline(result))}</b></p>{said}{_figure(result)}{table}{listed}"


def _figure(result: Shown) -> str:
    """The figure of a result as an image in the text; nothing where it cannot be drawn."""
    image = io.BytesIO()
    try:
        with warnings.catch_warnings(action="ignore", category=DomainWarning):  # the range is not the user's
            result.plot().savefig(image, format="png", dpi=_DPI)
    except EchocalError:  # a model that needs conditions of which nothing is known here
        return ""
    text = base64.b64encode(image.getvalue()).decode()
    return f'<img alt="{escape(headline(result))}" src="data:image/png;base64,{text}">'


@headline.register
def _(result: Diagnosis) -> str:
    named = [cause.id for cause in result.causes if not cause.doubt]
    word = "good enough" if result.good_enough else result.verdict
    said = f"Diagnosis {word}" + (f": {', '.join(named)}" if named else "")
    if result.gain is None or not result.gain.held_out_rows:
        return said
    before, after = _MM * result.gain.rms_before_m, _MM * result.gain.rms_after_m
    return f"{said}; RMS error {before:.2f} -> {after:.2f} mm on {result.gain.judged_rows}"


@explanation.register
def _(result: Diagnosis) -> str:
    return result.explain()


@dataframe.register
def _(result: Diagnosis) -> pd.DataFrame:
    """A row for each parameter; a cause without one has a row, too."""
    none = Parameter("", np.nan, np.nan, "")
    rows = [
        {
            "cause": cause.id,
            "kind": cause.kind,
            "probability": cause.probability,
            "probability_alone": cause.probability_alone,
            "parameter": parameter.name,
            "value": parameter.value,
            "standard_uncertainty": parameter.standard_uncertainty,
            "unit": parameter.unit,
            "in_model": cause.in_model,
            "cannot_be_told_from": ", ".join(cause.indistinguishable_from),
            "doubt": cause.doubt,
        }
        for cause in result.causes
        for parameter in cause.parameters or (none,)
    ]
    columns = ["cause", "kind", "probability", "probability_alone", "parameter", "value"]
    columns += ["standard_uncertainty", "unit", "in_model", "cannot_be_told_from", "doubt"]
    return pd.DataFrame(rows, columns=columns).set_index("cause")


@headline.register
def _(result: Model) -> str:
    return f"Model: law {result.law}" + (f" with {', '.join(result.effects)}" if result.effects else "")


@dataframe.register
def _(result: Model) -> pd.DataFrame:
    units = {effect.id: {p.name: p.unit for p in effect.parameters} for effect in effects()}
    spread = result.standard_uncertainties
    rows = [
        (
            effect,
            name,
            value,
            spread.get(f"{effect}.{name}", spread.get(name)),
            units.get(effect, {}).get(name, ""),
        )
        for effect, parameters in result.effects.items()
        for name, value in parameters.items()
    ]
    return pd.DataFrame(rows, columns=["effect", "parameter", "value", "standard_uncertainty", "unit"])


@headline.register
def _(result: Calibration) -> str:
    used, total = result.rows["used"], result.rows["total"]
    return f"Calibration: {', '.join(result.names)}; {used} of {total} rows, RMS residual {result.rms:.4g}"


@dataframe.register
def _(result: Calibration) -> pd.DataFrame:
    bounded = set(result.at_bounds)
    rows = [(each.value, each.standard_uncertainty, each.unit, each.name in bounded) for each in result]
    names = pd.Index(result.names, name="parameter")
    return pd.DataFrame(rows, columns=["value", "standard_uncertainty", "unit", "at_bound"], index=names)


@headline.register
def _(result: Observations) -> str:
    quantities = ", ".join(result.conditions)
    known = ", reference distance" if result.reference_distance is not None else ""
    return f"Observations: {int(result.usable.sum())} of {len(result)} rows usable; {quantities}{known}"


@dataframe.register
def _(result: Observations) -> pd.DataFrame:
    columns: dict[str, object] = {} if result.time is None else {"time": result.time}
    columns["echo_time [s]"] = result.echo_time
    if result.reading is not None:
        columns["reading [m]"] = result.reading
    if result.reference_distance is not None:
        columns["reference_distance [m]"] = result.reference_distance
    for name, values in result.conditions.items():
        columns[f"{name} [{QUANTITIES[name].unit}]" if name in QUANTITIES else name] = values
    columns |= {**result.labels, **result.extra}
    frame = pd.DataFrame({**columns, "unusable": result.unusable})
    frame.index = pd.RangeIndex(1, len(frame) + 1, name="row")
    return frame


@explanation.register
def _(result: Observations) -> str:
    counts = [f"{count} rows: {why}" for why, count in result.unusable_counts.items()]
    return "\n".join([headline(result), *counts, *(f"Note: {note}." for note in result.notes)])


@headline.register
def _(result: Verification) -> str:
    bound = _MM * result.maximum_permissible_error
    return (
        f"Verification {result.decision}: {result.exceeding} of {result.count} "
        f"errors exceed {bound:.3g} mm; the largest is {_MM * result.maximum_error:+.3g} mm"
        f"{_guard(result)}"
    )


def _guard(result: Verification) -> str:
    """The guard band, where an uncertainty is stated."""
    if result.least_probability is None:
        return ""
    return (
        f"; with a guard band of {_MM * result.guard_band:.2g} mm, {result.undecided} are undecided; the "
        f"least probability of conformity is {probability_text(result.least_probability)}"
    )


@explanation.register
def _(result: Verification) -> str:
    """The headline, the decision as a rule, what was not examined, and the notes."""
    counted = {"not examined": result.unusable, "examined without it": result.outside_smooth}
    lines = [f"{n} rows {what}: {why}" for what, own in counted.items() for why, n in own.items()]
    rule = "No uncertainty is stated: an error conforms if it does not exceed the bound."
    if result.least_probability is not None:
        rule = "An error conforms if it is within the bound less the guard band (JCGM 106:2012, 8.3)."
    return "\n".join([headline(result), rule, *lines, *(f"Note: {note}." for note in result.notes)])


@dataframe.register
def _(result: Verification) -> pd.DataFrame:
    rows = {
        "maximum permissible error": result.maximum_permissible_error,
        "maximum error": result.maximum_error,
        "mean error": result.mean_error,
        "RMS error": result.rms_error,
    }
    if result.least_probability is not None:
        rows["guard band"] = result.guard_band
    found = pd.DataFrame({"[mm]": _MM * np.array(list(rows.values()))}, index=list(rows))
    found.index.name = "figure"
    return found


@headline.register
def _(result: EchoTimes) -> str:
    return said(result)


@dataframe.register
def _(result: EchoTimes) -> pd.DataFrame:
    return echo_table(result)


@explanation.register
def _(result: EchoTimes) -> str:
    return "\n".join([said(result), *(f"{count} captures: {why}" for why, count in counted(result).items())])


@headline.register
def _(result: Budget) -> str:
    row = int(np.nanargmax(result.expanded_uncertainty))
    largest = plus_minus(_MM * result.distance[row], _MM * result.expanded_uncertainty[row], "mm")
    return f"Budget of {len(result.distance)} distances; the largest uncertainty: {largest}"


@dataframe.register
def _(result: Budget) -> pd.DataFrame:
    tables = [
        pd.DataFrame(
            {
                "row": result.row,
                "distance_m": result.distance,
                "source": entry.words,
                "type": entry.evaluation,
                "distribution": entry.distribution,
                "standard_uncertainty": entry.standard_uncertainty,
                "unit": entry.unit,
                "sensitivity": entry.sensitivity,
                "degrees_of_freedom": entry.degrees_of_freedom,
                "contribution_m": entry.contribution,
                "share": share,
                "combined_standard_uncertainty_m": result.standard_uncertainty,
                "coverage_factor": result.coverage_factor,
                "expanded_uncertainty_m": result.expanded_uncertainty,
            }
        )
        for entry, share in zip(result.entries, result.itemized.shares.T, strict=True)
    ]
    return pd.concat(tables).sort_values("row", kind="stable").reset_index(drop=True)
