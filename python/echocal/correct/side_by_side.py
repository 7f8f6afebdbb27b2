"""Several rangers in columns beside each other: each is corrected by its own model, into its own table."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from echocal.correct.inputs import ENDINGS, find_inputs
from echocal.errors import UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.folder import ModelFolder, file_name
from echocal.observations.hints import of_ranger
from echocal.observations.names import IGNORE

if TYPE_CHECKING:
    from echocal.correct.driver import Summary


def rangers_of(by: str | None, models: str | Path | None) -> dict[str, Model]:
    """Model of each ranger that `by` names, as ``"left_cm,right_cm"``; none where it names one column.

    Raises `UsageError` if one of several rangers has no model, or there is no folder of models.

    Examples
    --------
    >>> rangers_of("sensor_id", "models")
    {}
    """
    names = [name.strip() for name in (by or "").split(",")]
    if len(names) < 2:
        return {}
    if models is None:
        raise UsageError(
            f"{keyword('by', by)} are rangers beside each other, and each is corrected by its own model: "
            f"give their folder, {keyword('models', 'DIR')}"
        )
    folder = ModelFolder(Path(models))
    found = {name: folder.model(name) for name in names}
    for name, model in found.items():
        if model is None:
            known = [path.stem for path in sorted(Path(models).glob("*.json"))]
            message = f"{keyword('by', by)}: {models} has no model of column '{name}'{among(name, known)}"
            raise UsageError(message)
    return {name: model for name, model in found.items() if model is not None}


def correct_rangers(
    work: Callable[..., "Summary"],
    source: str | Path,
    out: Path,
    rangers: Mapping[str, Model],
    columns: Mapping[str, str],
    **how: Any,
) -> dict[str, "Summary"]:
    """Correct one table once for each ranger, into a folder with a file for each.

    `work` is `echocal.correct_files`, which gets `how`; the results are by the name of the file. Raises
    `UsageError` if the output is named as a file, or the input is a folder.
    """
    inputs = find_inputs(str(source))
    if not inputs.single or out.suffix in ENDINGS:
        raise UsageError(
            f"{keyword('by', ','.join(rangers))} are rangers beside each other in one table, and each has a "
            f"file of its own: give one table, and a folder for {keyword('out', 'DIR')}"
        )
    out.mkdir(parents=True, exist_ok=True)
    done = {}
    for name, model in rangers.items():
        said = of_ranger(name)
        own = {**({name: said} if said else {}), **columns}
        own |= {other: IGNORE for other in rangers if other != name}
        file = ranger_file(name, source)
        done[file] = work(source, out / file, model, columns=own, **how)
    return done


def ranger_file(name: str, source: str | Path) -> str:
    """Name of the file of a ranger; its ending is that of the table."""
    endings = (ending for ending in sorted(ENDINGS, key=len, reverse=True) if str(source).endswith(ending))
    return f"{Path(file_name(name)).stem}{next(endings, '.csv')}"
