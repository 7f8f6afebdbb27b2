"""Measured data in SI units, every row accounted for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.shown import Shown

if TYPE_CHECKING:
    from echocal.observations.found import Join


@dataclass(frozen=True, repr=False)
class Observations(Shown):
    """A table of echoes in SI units: as many rows as its source, in the same order.

    Attributes
    ----------
    echo_time : ndarray, shape (n,)
        Recorded echo time, out and back [s]. Where the source has readings instead, this is
        ``2 reading / c`` with the speed that the firmware used.
    conditions : mapping of str to ndarray, shape (n,)
        Recorded influence quantities by name (see `echocal.quantities.QUANTITIES`), only those
        that the source has, and those that are derived from its rows, such as rates of change.
    reference_distance : ndarray, shape (n,), or None
        Reference distance [m]; None where the source has none.
    unusable : ndarray of str, shape (n,)
        Reason code for each row that cannot be used, e.g. ``"temperature_C out of range"``;
        empty for a usable row. Values of such rows are kept as recorded, NaN where missing.
    reading : ndarray, shape (n,), or None
        What the device indicated [m]; None where the source has only echo times.
    time : ndarray of datetime64[ns], shape (n,), or None
        Instants in UTC; None where the source has none.
    labels : mapping of str to ndarray, shape (n,)
        Integer codes of ``stand`` and ``group``, and of further columns of text with few different ones,
        numbered as they appear, and values of ``order``, where the source has them; -1 where empty.
    extra : mapping of str to ndarray, shape (n,)
        Further numeric columns, unchanged: candidates for unexplained terms.
    thermometers : mapping of str to ndarray, shape (n,)
        Those of them that are thermometers (``temperature_box_C``, or mapped ``=thermometer_C``) [degC],
        NaN where one has no possible value.
    reading_speed : str
        Law or speed [m/s] that the user states for the readings, with which they became echo times; else
        empty.
    source_names : mapping of str to str
        Name of the source's column by quantity, for messages and plots.
    notes : tuple of str
        What a person should know about the table, one sentence each.
    stated : mapping of str to (float, float)
        Conditions that the user states for all rows, where the table has no column: value and standard
        uncertainty [SI], by quantity.
    joined : mapping of str to Join
        How values that were recorded at other times than the rows came to them: by quantity, or by column
        where it holds none.
    mount_height : float or None
        Height of the sensor above the zero of the levels of the source [m], by which they became distances;
        None where the source has distances.
    mount_height_fitted : bool
        Whether the user did not state it: then its error is a zero error.
    reference_join_uncertainty : float or None
        Standard uncertainty of a reference distance by its join from another log [m]; None without one.
    refused : mapping of str to str
        By quantity, why its column looks as if it were in another unit. Only a table that is read
        with everything trusted has such columns, for a diagnosis to find a fault that explains them.

    Examples
    --------
    >>> import warnings
    >>> import echocal
    >>> table = {"echo_us": [11660, 0, 11500], "humidity_percent": [40, 41, 143]}
    >>> with warnings.catch_warnings(action="ignore"):
    ...     data = echocal.read_observations(table)
    >>> data.usable
    array([ True, False, False])
    >>> data.unusable_counts
    {'echo_us out of range': 1, 'humidity_percent out of range': 1}
    """

    echo_time: Column
    conditions: Mapping[str, Column]
    reference_distance: Column | None
    unusable: NDArray[np.str_]
    reading: Column | None = None
    time: NDArray[np.datetime64] | None = None
    labels: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    extra: Mapping[str, Column] = field(default_factory=dict)
    thermometers: Mapping[str, Column] = field(default_factory=dict)
    reading_speed: str = ""
    source_names: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    stated: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    joined: Mapping[str, Join] = field(default_factory=dict, repr=False)
    mount_height: float | None = None
    mount_height_fitted: bool = False
    reference_join_uncertainty: float | None = None
    refused: Mapping[str, str] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        return len(self.echo_time)

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Which rows can be used, shape (n,)."""
        codes = np.ascontiguousarray(self.unusable, dtype=np.str_)
        # a text is empty if its first character is: no text is compared
        return np.asarray(codes.view(np.uint32).reshape(len(codes), codes.dtype.itemsize // 4)[:, 0] == 0)

    @property
    def unusable_counts(self) -> dict[str, int]:
        """Number of rows by reason code, the most frequent first."""
        return dict(Counter(self.unusable[~self.usable].tolist()).most_common())

    def bound(self, columns: Mapping[str, str]) -> dict[str, Column]:
        """Values of quantities that a model reads from further thermometers.

        Parameters
        ----------
        columns : mapping of str to str
            Name of the column by quantity, see `Model.columns`.

        Raises
        ------
        DataError
            If the table has no such thermometer.
        """
        for quantity, column in columns.items():
            if column not in self.thermometers:
                raise DataError(_no_thermometer(quantity, column, self))
        return {quantity: self.thermometers[column] for quantity, column in columns.items()}

    def require(
        self,
        purpose: str,
        *,
        rows: int = 1,
        conditions: Collection[str] = (),
        reference_distance: bool = False,
    ) -> None:
        """Refuse a table that a purpose cannot do with.

        Parameters
        ----------
        purpose : str
            What the table is for, as the subject of the message: ``"diagnosis"``.
        rows : int
            Usable rows that it needs at least.
        conditions : collection of str
            Influence quantities that it needs.
        reference_distance : bool
            Whether it needs a reference distance.

        Raises
        ------
        DataError
            If something is missing.
        """
        absent = [name for name in conditions if name not in self.conditions]
        if absent:
            raise DataError(_absent(purpose, absent[0], self))
        if reference_distance and self.reference_distance is None:
            raise DataError(_absent(purpose, "reference_distance", self))
        count = int(self.usable.sum())
        if count < rows:
            counts = ", ".join(f"{number} {reason}" for reason, number in self.unusable_counts.items())
            noun = "row" if len(self) == 1 else "rows"
            raise DataError(
                f"{purpose} needs at least {rows} usable rows; the table has {count} of {len(self)} {noun}"
                f"{f' (unusable: {counts})' if counts else ''}"
            )


def _no_thermometer(quantity: str, column: str, observations: Observations) -> str:
    others = ", ".join(observations.thermometers)
    if column in observations.extra:
        way = keyword("columns", {column: "thermometer_C"})
        what = f"has that column, but it is not known to be a thermometer: {way}"
    elif others:
        what = f"has other thermometers ({others}): rename the one that is meant"
    else:
        what = f"has no further thermometer: record it in a column '{column}', in degC"
    return f"the model reads {quantity} from the column '{column}', and the table {what}"


def _absent(purpose: str, quantity: str, observations: Observations) -> str:
    # the names live beside the units; imported late because most tables are complete
    from echocal.observations.misspelled import misspelled
    from echocal.observations.units import FORMS

    names = [name for form in FORMS if form.quantity == quantity for name in form.names]
    return (
        f"{purpose} needs a column for {quantity.replace('_', ' ')}; accepted: {', '.join(names)}; "
        f"map another with {keyword('columns', {'NAME': names[0]})}"
        f"{misspelled(quantity, [*observations.source_names.values(), *observations.extra])}"
    )
