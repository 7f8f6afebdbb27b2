"""What a sensor tells: each event with its sentence and its details."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from echocal.keywords import keyword
from echocal.watch.clock import Clock, Moved, Waiting
from echocal.watch.events import Event, finite, instant
from echocal.watch.monitor import DAY, Alarm, Monitor
from echocal.watch.settings import WatchSettings
from echocal.watch.signatures import Signature


class Watched(Protocol):
    """What the sentences tell of a sensor; see `echocal.watch.sensor.Sensor`."""

    id: str
    settings: WatchSettings
    reference: str
    monitor: Monitor
    clock: Clock
    dated: bool
    ignored: int
    follow: dict[str, Any] | None

    def signatures(self) -> list[Signature]:
        """All that are tested or belong to the class of one that is."""

    def classes(self) -> list[list[str]]:
        """Causes by class."""


def ignored(sensor: Watched, row: Waiting, rows: Sequence[Waiting], why: str) -> list[Event]:
    """Rows that the test does not take; told for the first one, and whenever they have doubled."""
    before, sensor.ignored = sensor.ignored, sensor.ignored + len(rows)
    if before.bit_length() == sensor.ignored.bit_length():
        return []
    count = "1 row is" if sensor.ignored == 1 else f"{sensor.ignored} rows so far are"
    sentence = f"{count} corrected, but not tested; the last one because {why}"
    details = {"rows": sensor.ignored, "reason": why}
    return [Event("ignored", sensor.id, finite(row.time), row.number, sentence, details)]


def why_refuted(sensor: Watched, rows: Sequence[Waiting], last: float | None) -> str:
    """Why rows are refuted by the one after them."""
    time = instant(rows[-1].time, dated=sensor.dated)
    if last is None:
        return (
            f"its time is {time}, and the rows after it go on from another one; where several devices are in "
            f"one stream: {keyword('by', 'COLUMN')}"
        )
    if rows[-1].time == last:
        return f"its time {time} is that of the row before: a clock that stands still, or counts too coarsely"
    before = instant(last, dated=sensor.dated)
    return f"its time {time} leaps from {before}, and the rows after it do not go on from there"


def moved(sensor: Watched, row: Waiting, leap: Moved) -> Event:
    """The clock goes on from elsewhere."""
    before, after = (instant(time, dated=sensor.dated) for time in (leap.before, leap.after))
    sentence = (
        f"the clock goes on from {after} after {before}: it was set, or began again. "
        f"{sensor.settings.confirm} rows go on from there, and so does the test"
    )
    details = {"before": before, "after": after}
    return Event("clock", sensor.id, row.time, row.number, sentence, details)


def learned(sensor: Watched, row: Waiting) -> Event:
    """What is usual is known; the diagnosis of these rows is due."""
    own, settings = sensor.monitor, sensor.settings
    level = 0.5 * own.height**2
    rate = f"for at most {settings.false_alarms:g} false alarms a year"
    if own.unstated:
        rate = f"but no rate of false alarms is stated, because {own.unstated}"
    sentence = (
        f"learned what is usual from {settings.learn} rows: noise {1e3 * own.scale:.2f} mm "
        f"(autocorrelation {own.rho:g}), a row every {own.interval:g} s; tests {len(own.tested) + 1} "
        f"signatures; tells a change from a log likelihood ratio of {level:.1f} on, {rate}"
    )
    details = {
        "standard_deviation_m": own.scale,
        "autocorrelation": own.rho,
        "white_part": own.theta,
        "interval_s": own.interval,
        "threshold": level,
        "false_alarms_per_year": None if own.unstated else settings.false_alarms,
        "no_rate_because": own.unstated or None,
        "tested": sensor.classes(),
    }
    sensor.follow = {"since": None, "from": -1e300, "at": 0, "rows": settings.learn - 1}
    return Event("learned", sensor.id, row.time, row.number, sentence, details)


def changed(sensor: Watched, row: Waiting, alarm: Alarm, farthest: str | None) -> Event:
    """A change; the diagnosis of the rows since is due later."""
    listed, classes = sensor.signatures(), sensor.classes()
    columns = [*(own[0] for own in sensor.monitor.classes), len(listed) - 1]
    order = np.argsort(-alarm.onset.probabilities, kind="stable")
    candidates = []
    for place in order[:5].tolist():
        one = listed[columns[place]]
        candidates.append(
            {
                "ids": classes[place],
                "probability": alarm.onset.probabilities[place],
                "parameter": one.parameter,
                "value": one.scale * alarm.onset.sizes[place],
                "standard_uncertainty": one.scale * alarm.onset.uncertainties[place],
                "unit": one.unit,
            }
        )
    since, low, high = (instant(sensor.clock.shown(time), dated=sensor.dated) for time in alarm.times)
    first = candidates[0]
    value, unsure = first["value"], first["standard_uncertainty"]
    size = f"{first['parameter']} {value:.3g} +- {unsure:.2g} {first['unit']}"
    others = f", or {len(first['ids']) - 1} causes like it" if len(first["ids"]) > 1 else ""
    sentence = (
        f"CHANGED since {since} (between {low} and {high}), told after "
        f"{alarm.onset.rows} rows, {(alarm.time - alarm.times[0]) / DAY:.2g} days; most like "
        f"{first['ids'][0]}{others} ({first['probability']:.0%}; {size})"
        f"{_doubt(sensor.reference, sensor.id, farthest)}"
    )
    details = {
        "since": since,
        "since_interval": [low, high],
        "rows_since": alarm.onset.rows,
        "log_likelihood_ratio": alarm.statistic**2 / 2.0,
        "threshold": alarm.height**2 / 2.0,
        "candidates": candidates,
        "reference": sensor.reference,
        "moved_farthest": farthest,
    }
    sensor.follow = {"since": since, "from": alarm.times[0], "at": 0, "rows": alarm.onset.rows - 1}
    return Event("change", sensor.id, row.time, row.number, sentence, details)


def _doubt(reference: str, sensor: str, farthest: str | None) -> str:
    if reference == "constant":
        return "; the target may have moved, which looks like a step or a drift"
    if reference != "others":
        return ""
    if farthest is None:
        return "; another sensor of the target may have changed instead"
    if farthest == sensor:
        return "; of the sensors of the target, it has moved farthest"
    return f"; sensor {farthest} of the target has moved farther, and has probably changed instead"
