"""The diagnosis of the rows since a change."""

import warnings
from typing import Any

import pandas as pd

from echocal.diagnose import Diagnosis, diagnose
from echocal.errors import DataError, EchocalError
from echocal.watch.events import Event, instant
from echocal.watch.rows import Row
from echocal.watch.sensor import Sensor

__all__ = ["told"]


def told(sensor: Sensor, rows: list[Row], time: float, number: int, options: dict[str, Any]) -> Event | None:
    """Run the diagnosis on rows; an event if its verdict is another one than the last one told."""
    assert sensor.follow is not None
    since = sensor.follow["since"]
    sensor.follow["at"] = sensor.follow["rows"]
    if 2 * sensor.follow["rows"] > sensor.settings.kept:
        sensor.follow = None
    try:
        with warnings.catch_warnings(action="ignore"):
            diagnosis = diagnose(pd.DataFrame(rows).fillna(""), base=sensor.model, **options)
    except (DataError, EchocalError) as error:
        told = Event("note", sensor.id, time, number, f"no verdict: {error}")
        return _once(sensor, ["error", str(error), []], told)
    causes = [[cause.id, *cause.indistinguishable_from] for cause in diagnosis.causes]
    return _once(sensor, [diagnosis.verdict, since, causes], _event(sensor, diagnosis, since, time, number))


def _once(sensor: Sensor, verdict: list[Any], event: Event) -> Event | None:
    """The event, unless the last one told the same: another member of a class is no news."""
    last, sensor.told = sensor.told, verdict
    if last is None or last[:2] != verdict[:2]:
        return event
    former, now = last[2], verdict[2]
    same = len(former) == len(now) and all(any(set(old) & set(new) for old in former) for new in now)
    return None if same else event


def _event(sensor: Sensor, found: Diagnosis, since: float | None, time: float, number: int) -> Event:
    causes = [
        {
            "id": cause.id,
            "kind": cause.kind,
            "probability": cause.probability,
            "indistinguishable_from": list(cause.indistinguishable_from),
            "parameters": [
                {
                    "name": p.name,
                    "value": p.value,
                    "standard_uncertainty": p.standard_uncertainty,
                    "unit": p.unit,
                }
                for p in cause.parameters
            ],
        }
        for cause in found.causes
    ]
    period = "of the first rows" if since is None else f"since {instant(since)}"
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
        "since": None if since is None else instant(since),
        "verdict": found.verdict,
        "causes": causes,
        "rows_used": found.rows["used"],
    }
    return Event("verdict", sensor.id, time, number, sentence, details)
