"""Echo times from what the device indicated, and whether both agree."""

import warnings
from collections.abc import Callable, Mapping

import numpy as np

from echocal import _core
from echocal.arrays import Column, Mask
from echocal.errors import DataError, DomainWarning, UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations.fields import row
from echocal.observations.part import Part
from echocal.observations.plan import Assignment

DEFAULT_SPEED = "linear"
"""Law that the firmware is assumed to use if the user does not state one."""


_SPEEDS = (200.0, 600.0)
"""m/s, of a fixed reading speed: that of an ideal dry gas, 331.3 sqrt(T / 273.15 K), at 100 and 896 K."""


class FirmwareSpeed:
    """The speed of sound that the firmware turned echo times into readings with.

    Raises `ModelError` if the text is no law, and `DataError` if the law needs a temperature that the table
    does not have.

    Parameters
    ----------
    text : str, float or None
        Name of a law, an expression (``331.3+0.606*T``) or a fixed speed [m/s] (``343``).
    conditions : mapping of str to ndarray, shape (n,)
        Recorded influence quantities.
    thermometer : callable
        Says what to map if there is no temperature: ``"NAME=temperature_C"``.
    """

    def __init__(
        self,
        text: str | float | None,
        conditions: Mapping[str, Column],
        thermometer: Callable[[], Mapping[str, str]],
    ) -> None:
        self.stated = text is not None
        self._model = Model(str(text) if self.stated else DEFAULT_SPEED)
        self.law = self._model.law
        self._conditions: dict[str, Column] = {}
        if self.fixed:
            _refuse_speed(float(self.law))
        else:
            self._conditions = {name: conditions[name] for name in self._reads() if name in conditions}
            if "temperature" not in self._conditions:
                raise DataError(
                    f"readings become echo times with the speed that the firmware used: '{self.law}' needs a "
                    f"temperature and the table has none; map one ({keyword('columns', thermometer())}), or "
                    f"say the speed: {keyword('reading_speed', 343)}; one that nobody recorded: "
                    f"{keyword('at', {'temperature': '20+-2'})}"
                )

    @property
    def fixed(self) -> bool:
        """Whether the speed is one number, whatever the air."""
        try:
            float(self.law)
        except ValueError:
            return False
        return True

    def echo_time(self, reading: Column, usable: Mask) -> Column:
        """Echo time [s] of a reading [m].

        Raises `DataError` if the speed is none that a usable row can have been made with.
        """
        used = {name: np.where(usable, values, np.nan) for name, values in self._conditions.items()}
        told = reading if usable.all() else np.where(usable, reading, np.nan)
        echo_time = self._model.time_of_flight(told, **(used or self._given()))
        if not usable.all():  # unusable rows have been reported
            with warnings.catch_warnings(action="ignore", category=DomainWarning):
                echo_time = self._model.time_of_flight(reading, **self._given())
        wrong = np.flatnonzero(usable & ~((echo_time > 0.0) & (echo_time < np.inf)))
        if len(wrong):
            speed = np.broadcast_to(self._model.speed_of_sound(1.0, **self._given()), echo_time.shape)
            raise DataError(
                f"readings cannot be made with the speed '{self.law}': it is {speed[wrong[0]]:g} m/s at "
                f"{row(wrong[0])}; say the one that the firmware used: {keyword('reading_speed', 343)}"
            )
        return echo_time

    def reading(self, echo_time: Column) -> Column:
        """Reading [m] of an echo time [s]."""
        return self._model.distance(echo_time, **self._given())

    def _given(self) -> Mapping[str, Column | float]:
        # a fixed speed must not become NaN where no temperature was recorded
        return {"temperature": 0.0} if self.fixed else self._conditions

    def _reads(self) -> list[str]:
        by_id = {facts["id"]: facts["reads"] for facts in _core.laws()}
        return list(by_id.get(self.law, ["temperature"]))


def _refuse_speed(speed: float) -> None:
    """Refuse what is no speed of sound in air, with the speed that it may mean."""
    low, high = _SPEEDS
    if low <= speed <= high:
        return
    meant = [f"; {speed:g} {unit} is {c:.1f} m/s" for unit, c in _meant(speed) if low <= c <= high]
    raise UsageError(
        f"the reading speed is {speed:g} m/s; the speed of sound in air lies within {low:g} .. {high:g} m/s"
        f"{meant[0] if meant else ''}; say the speed that the firmware used: "
        f"{keyword('reading_speed', 343)}"
    )


def _meant(number: float) -> list[tuple[str, float]]:
    """Speeds [m/s] that firmware writes as a number in another unit."""
    if not number > 0.0:
        return []
    return [
        ("cm/s", number / 100),
        ("km/h", number / 3.6),
        ("ft/s", number * 0.3048),
        ("cm/us", number * 1e4),
        ("mm/us", number * 1e3),
        ("cm/us of the whole path", number * 2e4),
        ("mm/us of the whole path", number * 2e3),
        ("us/cm, out and back,", 2e4 / number),
        ("us/cm, one way,", 1e4 / number),
        ("us/inch, out and back,", 2 * 0.0254e6 / number),
        ("us/inch, one way,", 0.0254e6 / number),
    ]


def disagreeing(
    reading: Column,
    echo_time: Column,
    speed: FirmwareSpeed,
    sources: tuple[Assignment, Assignment],
    part: Part | None = None,
) -> Mask:
    """Rows whose reading is not what the firmware makes of the echo time.

    Raises `DataError` if that is most rows.
    """
    expected = speed.reading(echo_time)
    # any speed that firmware uses is within 10 % of any law; 10 mm is integer centimeters
    tolerance = 0.01 + 0.10 * np.abs(expected)
    known = np.isfinite(reading) & np.isfinite(expected)
    apart = known & (np.abs(reading - expected) > tolerance)
    if part is not None:
        part.disagreeing[:] = int(apart[part.counted].sum()), int(known[part.counted].sum())
    elif 2 * apart.sum() > known.sum():
        ratio = float(np.median(reading[known] / expected[known]))
        echo, indicated = (source.column for source in sources)
        raise DataError(
            f"'{echo}' and '{indicated}' disagree in {apart.sum()} of {known.sum()} rows: the reading is "
            f"{ratio:.3f} times speed ({speed.law}) x echo time / 2 (median); check units, one way or two, "
            f"and {keyword('reading_speed')}, or leave one out: {keyword('columns', {indicated: 'ignore'})}"
        )
    return np.asarray(apart, dtype=np.bool_)
