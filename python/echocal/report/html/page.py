"""The page of a diagnosis: one file that needs nothing from any host."""

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from echocal.charts.errors import (
    distance_chart,
    drawn_columns,
    left_out_chart,
    over_chart,
    time_chart,
    truth_chart,
)
from echocal.charts.parts import MOST, Chart
from echocal.charts.results import gain_chart, posterior_chart
from echocal.diagnose import Diagnosis
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.sentences import shifted_text
from echocal.diagnose.results.explain import (
    class_texts,
    further_notes,
    lead,
    parameter_text,
    place_text,
    probability_text,
    proposal_text,
    rivals_of,
    without_a_cause,
)
from echocal.model.document import text_of
from echocal.outputs import replace_text
from echocal.report.html.document import rendered

_NEARLY_ALL = 99.0  # %, above which whole numbers do not tell shares apart
_BESIDE = 3  # columns whose figures are shown, besides the time


def save_report(
    diagnosis: Diagnosis,
    path: str | Path,
    source: str = "",
    made_by: str = "",
    saved: str | Path = "",
    commands: Mapping[str, str] | None = None,
) -> None:
    """Write a diagnosis as one HTML file, a `report_page`; raises `UsageError` if it cannot be written."""
    replace_text(path, report_page(diagnosis, source, made_by, saved, commands))


def report_page(
    diagnosis: Diagnosis,
    source: str = "",
    made_by: str = "",
    saved: str | Path = "",
    commands: Mapping[str, str] | None = None,
) -> str:
    """A diagnosis as an HTML document that needs no other file and no network.

    `source` is the name of the table, `made_by` the command line that makes the page again, `saved` the file
    with the model, if it is saved; `commands` use this file, by their purpose.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> reading = 1.008 + 1e-3 * np.sin(np.arange(40.0) ** 2)
    >>> table = {"reading_m": reading, "temperature_C": np.full(40, 20.0)}
    >>> page = report_page(echocal.diagnose(table, reference_distance=1.0), "desk.csv")
    >>> "desk.csv" in page and "<html" in page
    True
    """
    title = source or "diagnosis"
    use = {"made_by": made_by, "saved": str(saved or ""), "commands": commands or {}}
    return rendered("page.html.j2", "diagnose", title, **use, **_content(diagnosis, source))


def _content(diagnosis: Diagnosis, source: str) -> dict[str, Any]:
    return {
        "source": source,
        "log": shlex.quote(source or "LOG.csv"),
        "verdict": diagnosis.verdict,
        "sentence": lead(diagnosis),
        "facts": _facts(diagnosis),
        "evidence": _evidence(diagnosis),
        "most": f"{MOST:,}",
        "causes": [_cause(cause) for cause in diagnosis.causes],
        "questions": [_sentence(text) for text in class_texts(diagnosis)],
        "unexplained": [_sentence(text) for text in _unexplained(diagnosis)],
        "refuted": [one.id for one in diagnosis.refuted],
        "gain": gain_chart(diagnosis),
        "shifted": []
        if diagnosis.gain is None
        else [_sentence(shifted_text(one)) for one in diagnosis.gain.shifted],
        "rows": diagnosis.rows,
        "left_out": diagnosis.fates.counts,
        "where": left_out_chart(diagnosis),
        "posterior": posterior_chart(diagnosis) if len(diagnosis.posterior) > 1 else None,
        "proposals": [_sentence(proposal_text(one)) for one in diagnosis.next_measurements],
        "notes": [_sentence(note) for note in further_notes(diagnosis)],
        "model": repr(diagnosis.model),
        "extended": bool(diagnosis.model.effects),
        "document": text_of(diagnosis.model),
        "settings": json.dumps(diagnosis.settings.to_dict(), indent=1),
        "seconds": diagnosis.seconds,
    }


def _sentence(text: str) -> str:
    """Begun with a capital letter and ended with a point, unless an id of the catalogue begins it."""
    first = text.split(maxsplit=1)[0] if text else ""
    whole = text if "_" in first else text[:1].upper() + text[1:]
    return whole if whole.endswith((".", ":", "!", "?")) else f"{whole}."


def _unexplained(diagnosis: Diagnosis) -> list[str]:
    shape = diagnosis.unexplained
    return [*without_a_cause(diagnosis), *([] if shape is None else [shape.description])]


def _facts(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    rows = diagnosis.rows
    speed = diagnosis.base["device_speed"]
    base = diagnosis.base["law"] if speed is None else f"{speed:g} m/s at any temperature"
    facts = [("rows used", f"{rows['used']} of {rows['total']}"), ("base", str(base))]
    gain = diagnosis.gain
    if gain is not None:
        # a constant error does not show where nobody knows the distance
        what = "error" if "distance" in diagnosis.traces.against else "scatter around the level"
        facts.append((f"{what} before", f"{1e3 * gain.rms_before_m:.2f} mm"))
        if len(gain.ladder) > 1:
            facts.append((f"{what} after", f"{1e3 * gain.rms_after_m:.2f} mm"))
            low, high = (100 * end for end in gain.variance_removed_interval_95)
            digits = 2 if low > _NEARLY_ALL else 0
            share = f"{100 * gain.variance_removed:.{digits}f} % ({low:.{digits}f} to {high:.{digits}f} %)"
            facts.append(("part of the mean square error that is removed", share))
    return facts


def _cause(cause: Any) -> dict[str, Any]:
    sizes = [parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in cause.parameters]
    return {
        "id": cause.id,
        "place": place_text(cause),
        "sizes": ", ".join(sizes),
        "probability": probability_text(cause),
        "sentence": find_cause(cause.id).sentence,
        "because": cause.because,
        "doubt": cause.doubt,
        "rivals": rivals_of(cause) if cause.indistinguishable_from else [],
        "in_model": cause.in_model,
    }


def _evidence(diagnosis: Diagnosis) -> list[Chart]:
    every = drawn_columns(diagnosis, max(1, len(diagnosis.traces.against)))
    names = [name for name in every if name not in ("time", "row")]
    if "distance" in names:  # reading against truth
        names = ["distance", *(name for name in names if name != "distance")]
    figures = [time_chart(diagnosis), *(over_chart(diagnosis, name) for name in names[:_BESIDE])]
    return figures + [one for one in (distance_chart(diagnosis), truth_chart(diagnosis)) if one is not None]
