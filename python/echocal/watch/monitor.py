"""One sensor's test: it learns what is usual, then tells when that changes."""

import math
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from echocal.arrays import Column
from echocal.watch.noise import Noises, coarse, growth, learn, unlike, weights, whitened
from echocal.watch.sequential import Onset, Onsets
from echocal.watch.settings import WatchSettings
from echocal.watch.threshold import slack, threshold

DAY = 86400.0
_PLAIN = (
    *("interval", "rows", "origin", "height", "seen", "trend", "classes"),
    *("scale", "recent", "growth", "rho", "theta", "unstated"),
)
_STEP = 0.005  # m: the signature of a step, its usual size


@dataclass(frozen=True)
class Alarm:
    """A change that the test tells."""

    # row, time: row of the sensor at which it is told, and its time [s]
    row: int
    time: float
    onset: Onset
    times: tuple[float, float, float]
    # statistic, height: standardized sum and its threshold
    """Time of the most probable first changed row; the change lies between the other two [s]."""
    statistic: float
    height: float


@dataclass
class Monitor:
    """The test of one sensor, row by row: the same for any division of the rows into batches.

    The score of a row is that of docs/method/several-tables.md, Eq. 50; Eq. 52 tells a change.
    """

    settings: WatchSettings
    interval: float | None = None  # usual time between rows [s]; None until it is learned
    tested: tuple[int, ...] = ()  # columns of the signatures that are tested, one of each class of aliases
    classes: list[list[int]] = field(default_factory=list)  # columns of each class
    rows: int = 0
    origin: float = 0.0
    last: float = -np.inf
    waiting: list[tuple[float, float, list[float], float, float]] = field(default_factory=list)
    noises: Noises | None = None
    rho: float = 0.0
    theta: float = 0.0
    height: float = 0.0
    seen: int = 0
    trend: float | None = None
    mean: Column = field(default_factory=lambda: np.empty(0))
    covariance: Column = field(default_factory=lambda: np.empty((0, 0)))
    memory: Column = field(default_factory=lambda: np.empty(0))
    scale: float = 0.0
    recent: float = 0.0
    growth: tuple[float, float] = (0.0, 1.0)
    unstated: str = ""  # why no rate of false alarms is stated; nothing if it is
    onsets: Onsets | None = None
    marks: dict[int, float] = field(default_factory=dict)

    @property
    def learning(self) -> bool:
        """Whether it still learns what is usual."""
        return self.noises is None

    def add(
        self, time: float, residual: float, signature: Column, distance: float = 1.0, reading: float = np.nan
    ) -> Alarm | None:
        """Take one row in, in the order of time.

        The residual is the corrected less the reference distance [m]; the reading is as it came, in any
        unit.
        """
        if self.rows == 0:
            self.origin = time
        self.rows += 1
        if self.noises is None:
            self.waiting.append((time, residual, signature.tolist(), distance, reading))
            if len(self.waiting) == self.settings.learn:
                self._learn()
            self.last = time
            return None
        weight = float(weights(distance, self.growth))
        return self._test(time, residual * weight, signature * weight, weight)

    def _learn(self) -> None:
        times, residual, distance, reading = np.array([(t, y, d, r) for t, y, _, d, r in self.waiting]).T
        if self.interval is None:
            self.interval = max(float(np.median(np.diff(times))), 1e-3)
        every = np.array([row for _, _, row, _, _ in self.waiting])
        starts = np.flatnonzero(np.diff(times, prepend=-np.inf) > self.settings.gap * self.interval)
        usual = learn(residual, every[:, :1], self._prior(1), starts, self.settings)
        self.growth = growth(usual.cleaned, distance)
        weight = weights(distance, self.growth)
        residual, every = residual * weight, every * weight[:, None]
        self._classes(whitened(every, usual.rho, usual.theta, starts))
        columns = every[:, list(self.tested)]
        prior = self._prior(len(self.tested))
        found = learn(residual, columns, prior, starts, self.settings)
        self.rho, self.theta, self.scale = found.rho, found.theta, found.scale
        self.recent = self.scale
        clip = self.settings.clip
        scores = np.clip(whitened(found.cleaned, self.rho, self.theta, starts) / self.scale, -clip, clip)
        self.unstated = coarse(reading, distance, usual.cleaned) or unlike(
            scores, whitened(columns, self.rho, self.theta, starts), self.settings.refused
        )
        self.noises = Noises(self.settings)
        for row, value in enumerate(found.cleaned.tolist()):
            self.noises.add(value, begins=row in starts)
        width = len(self.tested) + 1
        self.mean = np.append(found.mean, 0.0)
        self.covariance = np.zeros((width, width))
        self.covariance[:-1, :-1] = found.covariance
        self.covariance[-1, -1] = 1.0 / self.scale**2
        self.seen = len(residual)
        self._set_height()
        self.memory = np.zeros(width + 1)
        self.onsets = Onsets(width, self.settings.onsets, self.settings.longest)
        for row in range(int(starts[-1]), len(times)):  # what the filter remembers
            self._remember(float(residual[row]), self._columns(float(times[row]), every[row], 1.0))
        self.waiting = []

    def _classes(self, rows: Column) -> None:
        """Put signatures that rows cannot tell apart into one class; the step is the first."""
        length = np.sqrt((rows * rows).sum(axis=0))
        alike = np.abs(rows.T @ rows) / np.maximum(np.outer(length, length), 1e-300)
        self.classes = []
        for column in range(rows.shape[1]):
            if column > 0 and 3.0 * length[column] < 1e-6:
                continue  # nothing in these rows shows it
            own = [c for c in self.classes if alike[column, c[0]] > self.settings.alias]
            if own:
                own[0].append(column)
            else:
                self.classes.append([column])
        self.tested = tuple(c[0] for c in self.classes)

    def _prior(self, width: int) -> Column:
        """Precision of the sizes before anything is known; the first is the level."""
        return np.array([(_STEP / self.settings.level) ** 2, *[1.0] * (width - 1)])

    def _set_height(self) -> None:
        """Threshold for the wanted rate, with what the rows so far leave uncertain (Eq. 53, 54)."""
        assert self.noises is not None
        assert self.interval is not None
        wanted = self.settings.false_alarms * self.interval / (365.25 * DAY)
        slow, weights = self.noises.slow(), self.noises.posterior()
        assumed = self.scale * (1.0 - self.theta) / (1.0 - self.rho)
        unsure = slack(slow / assumed, weights, float(self.seen), self.settings.certainty)
        self.height = unsure * threshold(min(wanted, 0.5), len(self.tested) + 1)

    def _choose_noise(self) -> None:
        """Take the noise that is the most probable by all rows so far."""
        assert self.noises is not None
        best = int(np.argmax(self.noises.posterior()))
        rho, theta = float(self.noises.rho[best]), float(self.noises.theta[best])
        if (rho, theta) != (self.rho, self.theta):
            self.rho, self.theta = rho, theta
            before, self.scale = self.scale, float(np.sqrt(self.noises.squares[best] / self.noises.rows))
            self.recent *= self.scale / before

    def _columns(self, time: float, signature: Column, weight: float) -> Column:
        """Columns that explain what is usual: a trend counts only after a change."""
        trend = 0.0 if self.trend is None else _STEP * weight * (time - self.trend) / DAY
        return np.append(signature[list(self.tested)], trend)

    def _remember(self, value: float, columns: Column) -> None:
        self.memory = np.append(columns, value) + self.theta * self.memory

    def _test(self, time: float, residual: float, signature: Column, weight: float) -> Alarm | None:
        noises, onsets = self.noises, self.onsets
        assert noises is not None
        assert onsets is not None
        assert self.interval is not None
        columns = self._columns(time, signature, weight)
        begins = time - self.last > self.settings.gap * self.interval
        self.last = time
        change, first = self.theta - self.rho, 1.0
        if begins:
            first = float(np.sqrt((1 - self.rho**2) / (1 - 2 * self.rho * self.theta + self.theta**2)))
            self.memory = np.zeros_like(self.memory)
            onsets.past[:] = 0.0
        x = first * (columns + change * self.memory[:-1])
        y = first * (residual + change * self.memory[-1])
        along = self.covariance @ x
        spread = float(np.sqrt(1.0 + x @ along))
        error = float(y - x @ self.mean)
        scale = self.recent if self.recent > self.settings.greater * self.scale else self.scale
        clip = self.settings.clip
        score = float(np.clip(error / (scale * spread), -clip, clip))
        cleaned = score * scale * spread
        day = (time - self.origin) / DAY
        tested = signature[list(self.tested)] * first
        ratio = onsets.add(self.rows, day, tested, score, (self.rho, self.theta, scale * spread), weight)
        self.marks[self.rows] = time
        self.marks = {row: self.marks[row] for row in onsets.rows.tolist()}
        self.mean = self.mean + along * (cleaned / spread**2)
        self.covariance = self.covariance - np.outer(along, along) / spread**2
        usual = residual - (error - cleaned) / first
        noises.add(usual - float(columns @ self.mean), begins=begins)
        self._remember(usual, columns)
        self._rescale(error / spread)
        if 2.0 * ratio <= self.height**2:
            return None
        return self._alarm(time, float(np.sqrt(2.0 * ratio)))

    def _rescale(self, error: float) -> None:
        """Follow the scales, of all and of recent rows: clipped scores vary as those of normal noise."""
        self.seen += 1
        usual = _clipped_variance(self.settings.clip)
        for name, rows in (("scale", self.seen), ("recent", self.settings.recent)):
            scale = getattr(self, name)
            square = min(abs(error) / scale, self.settings.clip) ** 2 / usual
            setattr(self, name, scale * float(np.sqrt(max(1.0 + (square - 1.0) / rows, 0.25))))
        if self.seen & (self.seen - 1) == 0:
            self._choose_noise()
            self._set_height()

    def _alarm(self, time: float, statistic: float) -> Alarm:
        assert self.onsets is not None
        onset = self.onsets.onset(self.settings.interval)
        rows = sorted(self.marks)
        before = [row for row in rows if row < onset.low]
        low = self.marks[before[-1]] if before else self.marks[rows[0]]
        times = (self.marks[onset.row], low, self.marks[onset.high])
        told = Alarm(self.rows, time, onset, times, statistic, self.height)
        self.trend = time  # what has begun may go on
        self._forget()
        return told

    def _forget(self) -> None:
        """Begin anew after a change: sizes are unknown again, the noise is not."""
        assert self.onsets is not None
        width = len(self.mean)
        prior = self._prior(width)
        self.covariance = np.diag(1.0 / (prior * self.scale**2))
        self.onsets.clear()
        self.marks = {}

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        kept: dict[str, Any] = {name: getattr(self, name) for name in _PLAIN}
        kept |= {"tested": list(self.tested), "waiting": [list(row) for row in self.waiting]}
        kept["last"] = None if self.rows == 0 else self.last
        kept["marks"] = [[row, time] for row, time in self.marks.items()]
        for name in ("mean", "covariance", "memory"):
            kept[name] = getattr(self, name).tolist()
        if self.noises is not None and self.onsets is not None:
            own = self.noises
            kept["noises"] = [own.past.tolist(), own.squares.tolist(), own.rows]
            kept["onsets"] = self.onsets.to_dict()
        return kept

    @classmethod
    def restored(cls, kept: dict[str, Any], settings: WatchSettings) -> "Monitor":
        """Continue where `to_dict` was called."""
        own = cls(settings)
        for name in _PLAIN:
            setattr(own, name, kept[name])
        own.tested = tuple(kept["tested"])
        own.last = -np.inf if kept["last"] is None else kept["last"]
        own.waiting = [tuple(row) for row in kept["waiting"]]
        own.marks = {int(row): time for row, time in kept["marks"]}
        own.mean, own.memory = np.array(kept["mean"]), np.array(kept["memory"])
        width = len(own.mean)
        own.covariance = np.array(kept["covariance"]).reshape(width, width)
        if "noises" in kept:
            own.noises = Noises(settings)
            past, squares, own.noises.rows = kept["noises"]
            own.noises.past, own.noises.squares = np.array(past), np.array(squares)
            own.onsets = Onsets(width, settings.onsets, settings.longest)
            own.onsets.restore(kept["onsets"])
        return own


@cache
def _clipped_variance(clip: float) -> float:
    """Variance of a standard normal value that is clipped."""
    outside = math.erfc(clip / math.sqrt(2.0))
    density = math.exp(-0.5 * clip * clip) / math.sqrt(2.0 * math.pi)
    return 1.0 - outside - 2.0 * clip * density + clip * clip * outside
