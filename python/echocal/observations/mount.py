"""The height of a sensor above the zero of a level: distance = mount height - level."""

from collections.abc import Iterable, Mapping

from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations.names import BELOW, EXTRA, IGNORE, by_request, is_level_name
from echocal.observations.plan import Assignment, Plan

MOUNT_HEIGHT, HEIGHT_FITTED = "mount_height_m", "mount_height_fitted"
"""What a model keeps of the levels of its diagnosis."""
_HEIGHTS = (0.0, 100.0)  # m: as far as a distance
LEAST = 8  # rows with a distance beside the level, from which on the height is fitted


def mounted(requests: Mapping[str, str], height: float | None) -> dict[str, str]:
    """Meanings of columns, each level with the height of the sensor above its zero, if it has none yet.

    Raises `UsageError` if a height is given and is none, or every level has another one.

    Examples
    --------
    >>> mounted({"Lvl": "level_cm", "T": "temperature_C"}, 2.6)
    {'Lvl': 'level_cm below 2.6 m', 'T': 'temperature_C'}
    """
    if height is None:
        return dict(requests)
    if not _HEIGHTS[0] < height <= _HEIGHTS[1]:
        raise UsageError(
            f"{keyword('mount_height', height)}: the height of the sensor above the zero of the level is in "
            f"m, above {_HEIGHTS[0]:g} and at most {_HEIGHTS[1]:g}"
        )
    levels = [name for name, own in requests.items() if is_level(name, own)]
    if not levels:
        return dict(requests)
    own = {name: requests[name].partition(BELOW)[2] for name in levels}
    if not any(above in ("", f"{height!r} m") for above in own.values()):
        name, above = next(iter(own.items()))
        raise UsageError(
            f"{keyword('mount_height', height)} is for no level: '{name}' has a height of its own, {above}; "
            f"leave one of them out"
        )
    return {**requests, **_below(levels, requests, height)}


def _below(levels: Iterable[str], requests: Mapping[str, str], height: float) -> dict[str, str]:
    """Meanings of levels, each with this height if it has none."""
    return {n: requests[n] if BELOW in requests[n] else f"{requests[n]}{BELOW}{height!r} m" for n in levels}


def with_named_levels(
    names: Iterable[str], requests: Mapping[str, str], height: float | None
) -> dict[str, str]:
    """Meanings of columns; a height makes those levels that are called as echocal calls levels.

    Raises `UsageError` if a height is given, and no column is a level.

    Examples
    --------
    >>> with_named_levels(["level_m", "temperature_C"], {}, 2.6)
    {'level_m': 'level_m below 2.6 m'}
    """
    if height is None or any(is_level(name, own) for name, own in requests.items()):
        return dict(requests)
    found = {name: name for name in names if name not in requests and is_level_name(name)}
    if not found:
        raise UsageError(
            f"{keyword('mount_height', height)} is for a column that holds a level; say which: "
            f"{keyword('columns', {'NAME': 'level_m'})}, or 'reference_level_m' for the reference"
        )
    return {**requests, **mounted(found, height)}


def mount_height(plan: Plan) -> float | None:
    """Height of the sensor above the zero of the levels of a table [m]; None where it has none."""
    held = (plan.assignments.get(name) for name in ("reading", "reference_distance"))
    return next((own.form.mount_height for own in held if own is not None and own.form.level), None)


def refuse_unmounted(plan: Plan) -> None:
    """Raise `UsageError` for a level whose height is not known."""
    for source in plan.assignments.values():
        if source.form.level and source.form.mount_height is None:
            raise UsageError(without_height(source))


def is_level(column: str, request: str) -> bool:
    """Whether a meaning is that of a level."""
    return _held(column, request) != ""


def holds_level(column: str, request: str) -> bool:
    """Whether a meaning is that of a level that the device indicates, and not of a reference."""
    return _held(column, request) == "reading"


def _held(column: str, request: str) -> str:
    """Which quantity a level tells; empty for what is no level."""
    found = None if request.strip() in (EXTRA, IGNORE) else by_request(column, request)
    return found[0].quantity if found is not None and found[0].level else ""


def kept_height(model: Model) -> float | None:
    """Height of the sensor [m] with which the table of a model's diagnosis was read."""
    kept = model.provenance.get(MOUNT_HEIGHT)
    return kept if isinstance(kept, float) else None


def mounted_as(requests: Mapping[str, str], model: Model) -> Mapping[str, str]:
    """Levels with the height that the diagnosis of the model had, where the user states none."""
    kept = kept_height(model)
    levels = {name: own for name, own in requests.items() if is_level(name, own)}
    if kept is None or not levels:
        return requests
    own = _below(levels, levels, kept)
    fitted = f"{BELOW}{kept!r} m"
    other = [name for name in own if own[name] == levels[name] and not own[name].endswith(fitted)]
    if model.provenance.get(HEIGHT_FITTED) and other:
        raise UsageError(
            f"'{levels[other[0]]}': the diagnosis of the model fitted the mount height, {kept:g} m, together "
            f"with a zero error; leave {keyword('mount_height')} out, or give it to the diagnosis"
        )
    return {**requests, **own}


def level_zero(plan: Plan, model: Model) -> float:
    """Height above the zero of a level [m] from which a corrected distance counts down.

    It is the mount height. Where that was fitted, its error is in the zero error of the model.
    """
    height = mount_height(plan)
    assert height is not None  # `refuse_unmounted`
    if not model.provenance.get(HEIGHT_FITTED):
        return height
    return height - model.effects.get("zero_error", {}).get("offset", 0.0)


def without_height(source: Assignment) -> str:
    """What to say of a level whose height is not known."""
    return (
        f"column '{source.column}' holds a level, and distance = mount height - level: give the height of "
        f"the sensor above the zero of the level, in m: {keyword('mount_height', 'METERS')}. It is "
        f"fitted only where at least {LEAST} rows have a distance, too"
    )
