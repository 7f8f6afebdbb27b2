"""What a corrected distance is compared with, and which model a sensor has."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from echocal.errors import DataError, UsageError, among
from echocal.model import Model
from echocal.model.folder import ModelFolder

__all__ = ["Models", "Reference", "models_of", "refuse_columns"]

Models = Callable[[str], Model | None]


@dataclass(frozen=True, kw_only=True)
class Reference:
    """What the corrected distance is compared with: exactly one of these, or a column of the rows.

    Attributes
    ----------
    distance : float or None
        Distance of the target in every row [m].
    constant : bool
        The target does not move; its distance is not known.
    target : str or None
        Column that names the target: the other sensors of the same target are the reference.
    within : float
        Age at which a row of another sensor is no reference any more [s].
    later : bool
        Rows may have no column for it at first.
    none : bool
        Nothing is tested.
    """

    distance: float | None = None
    constant: bool = False
    target: str | None = None
    within: float = 900.0
    later: bool = False
    none: bool = False

    def __post_init__(self) -> None:
        given = [
            name
            for name, value in (
                ("--reference-distance", self.distance is not None),
                ("--constant-distance", self.constant),
                ("--same-target", self.target is not None),
                ("--reference-later", self.later),
                ("--correct-only", self.none),
            )
            if value
        ]
        if len(given) > 1:
            message = f"{' and '.join(given)} contradict each other: give one of them"
            raise UsageError(message)
        if self.distance is not None and not self.distance > 0.0:
            message = f"--reference-distance is {self.distance!r}; give a distance above 0 m"
            raise UsageError(message)

    @property
    def kind(self) -> str:
        """Where the reference comes from, in a word."""
        if self.none:
            return "none"
        if self.constant:
            return "constant"
        if self.target is not None:
            return "others"
        return "column" if self.distance is None else "distance"


def models_of(model: Model | None, folder: Path | None) -> Models:
    """Model by sensor: one for all, or that of a folder (`ModelFolder`); None where a sensor has none.

    Raises
    ------
    UsageError
        If the folder does not exist.
    """
    if folder is None:
        return lambda _: model
    if not folder.is_dir():
        message = f"--models {folder} is no folder; `echocal diagnose --by COLUMN --models DIR` writes one"
        raise UsageError(message)
    return ModelFolder(folder).model


def refuse_columns(
    names: Sequence[str],
    asked: Sequence[tuple[str, str | None]],
    known: Collection[str],
    results: Sequence[str],
    reference: Reference,
    interval: float | None,
) -> None:
    """Refuse, on the first rows, what no test is possible with.

    Parameters
    ----------
    names, known : collection of str
        Columns of the rows, and quantities that the rows have.
    asked : sequence of (str, str)
        Options that name a column, with the column.
    results : sequence of str
        Columns that are appended.
    reference : Reference
    interval : float or None
        Time between rows that the user states [s].

    Raises
    ------
    UsageError
        If a request names a column that no row has.
    DataError
        If the rows have no time, nothing to be compared with, or were corrected before.
    """
    listed = ", ".join(names)
    for option, column in [*asked, ("--same-target", reference.target)]:
        if column is not None and column not in names:
            message = f"{option}: no row has a column '{column}'{among(column, names, 'the first rows have')}"
            raise UsageError(message)
    taken = [name for name in results if name in names]
    if taken:
        message = f"the rows already have a column '{taken[0]}': they were corrected before; rename it"
        raise DataError(message)
    if reference.kind == "none":
        return
    if reference.kind == "column" and not reference.later and "reference_distance" not in known:
        message = (
            "no row has a reference distance, so nothing tells an error from a target that moves; say what "
            "the corrected distance can be compared with: --reference-distance M, --constant-distance, "
            "--same-target COLUMN (other sensors of one target), --reference-later (a column distance_m "
            "comes now and then), or --correct-only"
        )
        raise DataError(message)
    if "elapsed_time" not in known and interval is None:
        message = (
            "no row has a time, which dates a change and gives the false alarms per year; the rows have "
            f"{listed}: add a column time (ISO 8601) or time_s, or give --interval SECONDS"
        )
        raise DataError(message)
