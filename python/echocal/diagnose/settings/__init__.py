"""The numbers that decide a verdict and can be changed, each with its value, unit, meaning and source.

`echocal.diagnose(..., settings=)` takes other values, and a diagnosis records the values that it
used. The constants of the core are in rust/infer; docs/settings.md lists those that decide. Numbers
that change only the computing time or the memory are in the files that use them. The facts of a cause
(its prior, its usual size) are in the file of the cause. The equations are those of docs/method.md and
of the pages in docs/method.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass, replace
from typing import Any

from echocal.diagnose.settings.causes import Threshold, listed_thresholds
from echocal.diagnose.settings.claims import ClaimSettings
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.noise_models import NoiseModelSettings
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.priors import PriorSettings, TermSettings
from echocal.diagnose.settings.rows import RowSettings
from echocal.diagnose.settings.several_tables import FleetSettings, PoolingSettings
from echocal.errors import UsageError

__all__ = [
    "ClaimSettings",
    "FaultSettings",
    "FleetSettings",
    "NoiseModelSettings",
    "NoiseSettings",
    "PoolingSettings",
    "PriorSettings",
    "RowSettings",
    "Settings",
    "TermSettings",
    "table",
]


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The numbers of a diagnosis, by stage.

    Examples
    --------
    >>> from echocal.diagnose import Settings
    >>> settings = Settings.of({"claims": {"claim_below": 0.5}})
    >>> settings.claims.claim_below, settings.claims.named
    (0.5, 0.9)
    """

    rows: RowSettings = field(default_factory=RowSettings)
    priors: PriorSettings = field(default_factory=PriorSettings)
    terms: TermSettings = field(default_factory=TermSettings)
    noise_models: NoiseModelSettings = field(default_factory=NoiseModelSettings)
    claims: ClaimSettings = field(default_factory=ClaimSettings)
    noises: NoiseSettings = field(default_factory=NoiseSettings)
    faults: FaultSettings = field(default_factory=FaultSettings)
    pooling: PoolingSettings = field(default_factory=PoolingSettings)
    fleet: FleetSettings = field(default_factory=FleetSettings)

    @classmethod
    def of(cls, given: Settings | Mapping[str, Mapping[str, Any]] | None) -> Settings:
        """Read settings as a diagnosis records them; missing numbers have their defaults.

        Raises
        ------
        UsageError
            If a group or a number does not exist; the text lists the existing ones.
        """
        if isinstance(given, Settings):
            return given
        return cls() if given is None else _with(cls(), given, "settings")

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """As plain data; `Settings.of` reads it again."""
        return asdict(self)


def table() -> Iterator[Threshold]:
    """List all numbers: name, value, unit, and meaning with source.

    Examples
    --------
    >>> from echocal.diagnose.settings import table
    >>> next(value for name, value, *_ in table() if name == "claims.named")
    0.9
    """
    return listed_thresholds(Settings())


def _with(settings: Any, given: Any, name: str) -> Any:
    """Settings with some of their numbers replaced."""
    if not isinstance(given, Mapping):
        message = f"{name} map names to numbers, {{'claims': {{'named': 0.9}}}}; got {given!r}"
        raise UsageError(message)
    known = [f.name for f in fields(settings)]
    changed = {}
    for key, value in given.items():
        if key not in known:
            message = f"'{key}' is not one of the {name}; there are {', '.join(known)}"
            raise UsageError(message)
        own, path = getattr(settings, key), key if name == "settings" else f"{name}.{key}"
        changed[key] = _with(own, value, path) if is_dataclass(own) else _like(own, value, path)
    return replace(settings, **changed)


def _like(default: Any, value: Any, name: str) -> Any:
    """A value of the same kind as the default: lists of a JSON file become tuples."""
    if isinstance(default, Mapping):
        if isinstance(value, Mapping):
            return dict(value)
    elif isinstance(default, tuple):
        if isinstance(value, list | tuple) and len(value) > 0:
            last = len(default) - 1
            return tuple(_like(default[min(i, last)], one, name) for i, one in enumerate(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        kind = type(default)
        if kind is float or float(value).is_integer():
            return kind(value)
    message = f"settings give {name} the value {value!r}; give one like {default!r}"
    raise UsageError(message)
