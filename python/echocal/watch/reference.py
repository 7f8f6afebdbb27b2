"""What a corrected distance is compared with, and which model a sensor has."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from echocal.errors import DataError, UsageError, among
from echocal.keywords import command_line, keyword
from echocal.model import Model
from echocal.model.folder import ModelFolder

Models = Callable[[str], Model | None]


@dataclass(frozen=True, kw_only=True)
class Reference:
    """What the corrected distance is compared with: exactly one of these, or a column of the rows.

    Attributes
    ----------
    reference_distance : float or None
        Distance of the target in every row [m].
    constant_distance : bool
        The target does not move; its distance is not known.
    same_target : str or None
        Column that names the target: the other sensors of the same target are the reference.
    within : float
        Age at which a row of another sensor is no reference any more [s].
    reference_later : bool
        Rows may have no column for it at first.
    correct_only : bool
        Nothing is tested.
    """

    reference_distance: float | None = None
    constant_distance: bool = False
    same_target: str | None = None
    within: float = 900.0
    reference_later: bool = False
    correct_only: bool = False

    def __post_init__(self) -> None:
        given = [
            keyword(one.name)
            for one in fields(self)
            if one.name != "within" and getattr(self, one.name) not in {None, False}
        ]
        if len(given) > 1:
            raise UsageError(f"{' and '.join(given)} contradict each other: give one of them")
        if self.reference_distance is not None and not self.reference_distance > 0.0:
            message = f"{keyword('reference_distance', self.reference_distance)}: give a distance above 0 m"
            raise UsageError(message)

    @property
    def kind(self) -> str:
        """Where the reference comes from, in a word."""
        if self.correct_only:
            return "none"
        if self.constant_distance:
            return "constant"
        if self.same_target is not None:
            return "others"
        return "column" if self.reference_distance is None else "distance"


def models_of(model: Model | None, folder: Path | None) -> Models:
    """Model by sensor: one for all, or that of a folder (`ModelFolder`); None where a sensor has none.

    Raises `UsageError` if the folder does not exist.
    """
    if folder is None:
        return lambda _: model
    if not folder.is_dir():
        made = command_line("diagnose", by="COLUMN", models="DIR")
        raise UsageError(f"{keyword('models', str(folder))} is no folder; `{made}` writes one")
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

    Raises `UsageError` if a request names a column that no row has, and `DataError` if the rows have no
    time, nothing to be compared with, or were corrected before. `asked` are keywords that name a column,
    with the column; `results` are the columns that are appended, and `interval` is the time between rows
    that the user states [s].
    """
    listed = ", ".join(names)
    for option, column in [*asked, ("same_target", reference.same_target)]:
        if column is not None and column not in names:
            own = among(column, names, "the first rows have")
            raise UsageError(f"{keyword(option)}: no row has a column '{column}'{own}")
    taken = [name for name in results if name in names]
    if taken:
        raise DataError(f"the rows already have a column '{taken[0]}': they were corrected before; rename it")
    if reference.kind == "none":
        return
    if reference.kind == "column" and not reference.reference_later and "reference_distance" not in known:
        raise DataError(
            "no row has a reference distance, so nothing tells an error from a target that moves; say what "
            f"the corrected distance can be compared with: {keyword('reference_distance')} (in m), "
            f"{keyword('constant_distance', True)}, {keyword('same_target', 'COLUMN')} (other sensors of one "
            f"target), {keyword('reference_later', True)} (a column distance_m comes now and then), or "
            f"{keyword('correct_only', True)}"
        )
    if "elapsed_time" not in known and interval is None:
        raise DataError(
            "no row has a time, which dates a change and gives the false alarms per year; the rows have "
            f"{listed}: add a column time (ISO 8601) or time_s, or give {keyword('interval')} in s"
        )
