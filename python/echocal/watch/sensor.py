"""One sensor: its model corrects its rows, its monitor tests them, its changes are told."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError, DomainWarning
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.correction import corrected_distance
from echocal.watch.events import Event, instant
from echocal.watch.monitor import DAY, Alarm, Monitor
from echocal.watch.rows import Block, taken
from echocal.watch.settings import WatchSettings
from echocal.watch.signatures import Signature, Signatures, refuse_unwatchable, step_and_drift

__all__ = ["Sensor"]

Column = NDArray[np.float64]

_RATES = {"temperature_rate": "temperature", "radiation_rate": "radiation"}
_WINDOW = 15.0  # s: what a rate is taken over at least, as far back as at the end of a table


@dataclass
class Sensor:
    """The rows of one sensor, in the order in which they come.

    Attributes
    ----------
    id : str
    model : Model
    settings : WatchSettings
    reference : {"column", "distance", "constant", "others", "none"}
        Where its reference distance comes from.
    interval : float or None
        Time between rows [s] that the user states.
    """

    id: str
    model: Model
    settings: WatchSettings
    reference: str
    interval: float | None = None
    monitor: Monitor = field(init=False)
    recorded: list[str] | None = None
    level: float | None = None
    before: list[list[float]] = field(default_factory=list)
    follow: dict[str, Any] | None = None
    told: list[Any] | None = None
    outside: list[str] = field(default_factory=list)
    late: int = 0
    rows: int = 0
    _signatures: Signatures | None = None

    def __post_init__(self) -> None:
        refuse_unwatchable(self.model)
        self.monitor = Monitor(self.settings, self.interval)

    def correct(self, block: Block, places: NDArray[np.intp]) -> tuple[Column, list[str], Observations]:
        """Corrected distances [m] of some rows of a block, and why one has none."""
        seen = self._with_rates(taken(block.observations, places), block.time[places])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", DomainWarning)
            try:
                distance = corrected_distance(seen, self.model)
            except DataError as error:
                return np.full(len(places), np.nan), [str(error)] * len(places), seen
        left = (str(warning.message).partition(":")[0] for warning in caught)
        self.outside += [text for text in dict.fromkeys(left) if text not in self.outside]
        status = seen.unusable.astype(object)
        lost = seen.usable & np.isnan(distance)
        status[lost] = "no distance fits"
        for column in self.model.columns.values():
            status[lost & np.isnan(seen.thermometers[column])] = f"{column} missing"
        return distance, status.tolist(), seen

    def test(
        self,
        distance: Column,
        reference: Column,
        time: Column,
        seen: Observations,
        numbers: list[int],
        ask: Callable[["Sensor", float, int], Event | None],
        farthest: Callable[[str, int, float], str | None],
    ) -> list[Event]:
        """Test corrected rows against their reference, in the order of time; `ask` runs the diagnosis.

        `farthest` is the sensor of the same target that has moved farthest since a time.
        """
        if self.reference == "none":
            return []
        if self.reference == "constant":
            reference = distance
        usable = np.isfinite(distance) & np.isfinite(reference) & np.isfinite(time)
        if self.recorded is None:
            if not usable.any():
                return []
            self.recorded = list(seen.conditions)
        signatures = self._candidates()
        blank = np.full(len(time), np.nan)
        conditions = {name: seen.conditions.get(name, blank) for name in self.recorded}
        with warnings.catch_warnings(action="ignore"):  # the correction has told it
            found = signatures.at(np.where(usable, reference, np.nan), conditions)
        found = np.column_stack([np.full(len(time), 0.005), found])
        against = (
            np.full(len(time), self._level(distance, usable)) if self.reference == "constant" else reference
        )
        events: list[Event] = []
        for row in np.flatnonzero(usable).tolist():
            if time[row] <= self.monitor.last:
                self.late += 1
                continue
            residual = float(distance[row] - against[row])
            own = float(time[row]), residual, found[row], numbers[row]
            events += self._row(*own, ask, farthest)
        return events

    def _level(self, distance: Column, usable: NDArray[np.bool_]) -> float:
        """The first distance, which stands in for one that is unknown but constant [m]."""
        if self.level is None and usable.any():
            self.level = float(distance[usable][0])
        return 0.0 if self.level is None else self.level

    def _row(
        self,
        time: float,
        residual: float,
        signature: Column,
        number: int,
        ask: Callable[["Sensor", float, int], Event | None],
        farthest: Callable[[str, int, float], str | None],
    ) -> list[Event]:
        events = []
        was_learning = self.monitor.learning
        alarm = self.monitor.add(time, residual, signature)
        if was_learning and not self.monitor.learning:
            events.append(self._learned(time, number))
        if alarm is not None:
            events.append(self._change(alarm, number, farthest(self.id, number, alarm.times[0])))
        verdict = ask(self, time, number) if self._is_due() else None
        return events if verdict is None else [*events, verdict]

    def _is_due(self) -> bool:
        """Whether the diagnosis runs: at the fewest rows after an onset, and whenever they have doubled."""
        if self.follow is None:
            return False
        self.follow["rows"] += 1
        rows, before = self.follow["rows"], self.follow["at"]
        return bool(rows >= self.settings.fewest and rows >= 2 * before)

    def _candidates(self) -> Signatures:
        if self._signatures is None:
            self._signatures = Signatures(self.model, self.recorded or ())
        return self._signatures

    def _with_rates(self, seen: Observations, time: Column) -> Observations:
        """Rates from this row and the rows before it; the rows after it have not come yet."""
        quantities = [(rate, of) for rate, of in _RATES.items() if of in seen.conditions]
        conditions = {
            name: values
            for name, values in seen.conditions.items()
            if not name.startswith("temperature_later_")
        }
        conditions.pop("elapsed_time", None)  # of the table that was read, which is no campaign
        conditions.pop("position_in_group", None)
        for rate, _ in quantities:
            conditions[rate] = np.full(len(time), np.nan)
        for row, now in enumerate(time.tolist()):
            values = [float(seen.conditions[of][row]) for _, of in quantities]
            if not (np.isfinite(now) and np.isfinite(values).all()):
                continue
            for place, (rate, _) in enumerate(quantities):
                conditions[rate][row] = self._rate(now, values[place], place)
            if quantities and (not self.before or now > self.before[-1][0]):
                old = [row for row in self.before if row[0] < now - _WINDOW]
                self.before = [*old[-1:], *[r for r in self.before if r[0] >= now - _WINDOW], [now, *values]]
        return replace(seen, conditions=conditions)

    def _rate(self, now: float, value: float, place: int) -> float:
        earlier = [row for row in self.before if row[0] < now]
        if not earlier:
            return 0.0
        times = [row[0] for row in earlier]
        start = max(min(now - _WINDOW, times[-1]), times[0])
        was = float(np.interp(start, times, [row[1 + place] for row in earlier]))
        return (value - was) / (now - start)

    def signatures(self) -> list[Signature]:
        """All that are tested or belong to the class of one that is."""
        return [step_and_drift()[0], *self._candidates().listed, step_and_drift()[1]]

    def classes(self) -> list[list[str]]:
        """Causes by class, the drift last: the rows so far cannot tell those of one class apart."""
        listed = self.signatures()
        return [[listed[c].id for c in own] for own in self.monitor.classes] + [[listed[-1].id]]

    def _learned(self, time: float, row: int) -> Event:
        own = self.monitor
        level = 0.5 * own.height**2
        sentence = (
            f"learned what is usual from {self.settings.learn} rows: noise {1e3 * own.scale:.2f} mm "
            f"(autocorrelation {own.rho:g}), a row every {own.interval:g} s; tests {len(own.tested) + 1} "
            f"signatures; tells a change from a log likelihood ratio of {level:.1f} on, for at most "
            f"{self.settings.false_alarms:g} false alarms a year"
        )
        details = {
            "standard_deviation_m": own.scale,
            "autocorrelation": own.rho,
            "white_part": own.theta,
            "interval_s": own.interval,
            "threshold": level,
            "false_alarms_per_year": self.settings.false_alarms,
            "tested": self.classes(),
        }
        self.follow = {"since": None, "from": -1e300, "at": 0, "rows": self.settings.learn - 1}
        return Event("learned", self.id, time, row, sentence, details)

    def _change(self, alarm: Alarm, row: int, farthest: str | None) -> Event:
        listed, classes = self.signatures(), self.classes()
        columns = [*(own[0] for own in self.monitor.classes), len(listed) - 1]
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
        since, low, high = alarm.times
        first = candidates[0]
        value, unsure = first["value"], first["standard_uncertainty"]
        size = f"{first['parameter']} {value:.3g} +- {unsure:.2g} {first['unit']}"
        others = f", or {len(first['ids']) - 1} causes like it" if len(first["ids"]) > 1 else ""
        doubt = _doubt(self.reference, self.id, farthest)
        sentence = (
            f"CHANGED since {instant(since)} (between {instant(low)} and {instant(high)}), told after "
            f"{alarm.onset.rows} rows, {(alarm.time - since) / DAY:.2g} days; most like "
            f"{first['ids'][0]}{others} ({first['probability']:.0%}; {size}){doubt}"
        )
        details = {
            "since": instant(since),
            "since_interval": [instant(low), instant(high)],
            "rows_since": alarm.onset.rows,
            "log_likelihood_ratio": alarm.statistic**2 / 2.0,
            "threshold": alarm.height**2 / 2.0,
            "candidates": candidates,
            "reference": self.reference,
            "moved_farthest": farthest,
        }
        self.follow = {"since": since, "from": since, "at": 0, "rows": alarm.onset.rows - 1}
        return Event("change", self.id, alarm.time, row, sentence, details)

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        names = ("recorded", "level", "before", "follow", "told", "outside", "late", "rows")
        return {name: getattr(self, name) for name in names} | {
            "monitor": self.monitor.to_dict(),
            "model": self.model.hash,
        }

    def restore(self, kept: dict[str, Any]) -> None:
        """Continue where `to_dict` was called."""
        if kept["model"] != self.model.hash:
            who = f"sensor {self.id}" if self.id else "the sensor"
            message = (
                f"the state is of another model of {who} ({kept['model'][:12]}, now {self.model.hash[:12]}): "
                "give that model, or begin with another --state"
            )
            raise DataError(message)
        for name in ("recorded", "level", "before", "follow", "told", "outside", "late", "rows"):
            setattr(self, name, kept[name])
        self.monitor = Monitor.restored(kept["monitor"], self.settings)


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
