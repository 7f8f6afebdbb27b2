"""The diagnosis of the rows since a change."""

import warnings
from dataclasses import asdict
from typing import Any

import pandas as pd

from echocal.diagnose import Diagnosis, diagnose
from echocal.errors import EchocalError
from echocal.watch.clock import Waiting
from echocal.watch.events import Event
from echocal.watch.rows import Row
from echocal.watch.sensor import Sensor


def told(sensor: Sensor, rows: list[Row], last: Waiting, options: dict[str, Any]) -> Event | None:
    """Run the diagnosis on rows; an event if its verdict is another one than the last one told.

    A diagnosis that fails stops no watch, whatever the reason.
    """
    assert sensor.follow is not None
    since = sensor.follow["since"]
    sensor.follow["at"] = sensor.follow["rows"]
    if 2 * sensor.follow["rows"] > sensor.settings.kept:
        sensor.follow = None
    try:
        with warnings.catch_warnings(action="ignore"):
            diagnosis = diagnose(pd.DataFrame(rows).fillna(""), base=sensor.model, **options)
    except Exception as error:
        why = str(error) if isinstance(error, EchocalError) else f"{type(error).__name__}: {error}"
        told = Event("note", sensor.id, last.time, last.number, f"no verdict: {why}")
        return _once(sensor, ["error", why, []], told)
    causes = [[cause.id, *cause.indistinguishable_from] for cause in diagnosis.causes]
    return _once(sensor, [diagnosis.verdict, since, causes], _event(sensor, diagnosis, since, last))


def _once(sensor: Sensor, verdict: list[Any], event: Event) -> Event | None:
    """The event, unless the last one told the same: another member of a class is no news."""
    last, sensor.told = sensor.told, verdict
    if last is None or last[:2] != verdict[:2]:
        return event
    former, now = last[2], verdict[2]
    same = len(former) == len(now) and all(any(set(old) & set(new) for old in former) for new in now)
    return None if same else event


def _event(sensor: Sensor, found: Diagnosis, since: str | float | None, last: Waiting) -> Event:
    causes = [
        {
            "id": cause.id,
            "kind": cause.kind,
            "probability": cause.probability,
            "indistinguishable_from": list(cause.indistinguishable_from),
            "parameters": [asdict(p) for p in cause.parameters],
        }
        for cause in found.causes
    ]
    period = "of the first rows" if since is None else f"since {since}"
    said = "; ".join(
        " or ".join([cause.id, *cause.indistinguishable_from])
        + f" ({cause.probability:.0%}"
        + "".join(
            f"; {p.name} {p.value:.3g} +- {p.standard_uncertainty:.2g} {p.unit}" for p in cause.parameters[:1]
        )
        + ")"
        for cause in found.causes[:3]
    )
    sentence = f"verdict {period}, {found.rows['used']} rows: {found.verdict}{': ' if said else ''}{said}"
    details = {
        "since": since,
        "verdict": found.verdict,
        "causes": causes,
        "rows_used": found.rows["used"],
    }
    return Event("verdict", sensor.id, last.time, last.number, sentence, details)
