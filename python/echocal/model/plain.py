"""Models as plain data: what a task for another process contains, in place of a pickled object."""

import json
from pathlib import Path
from typing import Any

from echocal.model.composition import Model
from echocal.model.reading import built


def from_plain(plain: dict[str, Any], origin: str = "the model of the task") -> Model:
    """The model of plain data; it is checked as a file is.

    Raises `ModelError` if it is no valid model, or does not match its hash; the text begins with `origin`.

    Examples
    --------
    >>> from echocal.model import Model
    >>> from echocal.model.document import to_plain
    >>> from echocal.model.plain import from_plain
    >>> from_plain(to_plain(Model("linear", {"zero_error": {"offset": 2e-3}}))).effects
    {'zero_error': {'offset': 0.002}}
    """
    return built(Model, Path(origin), json.dumps(plain))
