"""Every number that decides a verdict, once: its value, its unit, what it means and where it comes from.

`echocal.diagnose(..., settings=)` takes another set, and a diagnosis records the set that it was made
with. Numbers that change the time or the memory alone stay where they are used; so do the facts of a
cause (its prior, its usual size), which stand in the cause's own file. The equations are those of
docs/method.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from echocal.diagnose.settings.claims import ClaimSettings
from echocal.diagnose.settings.noise_models import NoiseModelSettings
from echocal.diagnose.settings.priors import PriorSettings, TermSettings
from echocal.diagnose.settings.rows import RowSettings
from echocal.diagnose.settings.search import SearchSettings
from echocal.diagnose.settings.validation import ValidationSettings
from echocal.errors import UsageError

__all__ = [
    "ClaimSettings",
    "NoiseModelSettings",
    "PriorSettings",
    "RowSettings",
    "SearchSettings",
    "Settings",
    "TermSettings",
    "ValidationSettings",
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
    search: SearchSettings = field(default_factory=SearchSettings)
    claims: ClaimSettings = field(default_factory=ClaimSettings)
    validation: ValidationSettings = field(default_factory=ValidationSettings)

    @classmethod
    def of(cls, given: Settings | Mapping[str, Mapping[str, Any]] | None) -> Settings:
        """Read settings as a diagnosis records them; what is not given is the default.

        Raises
        ------
        UsageError
            If there is no such group or number; the text lists what there is.
        """
        if isinstance(given, Settings):
            return given
        settings = cls()
        if given is None:
            return settings
        if not isinstance(given, Mapping):
            message = f"settings map groups to numbers, {{'claims': {{'named': 0.9}}}}; got {given!r}"
            raise UsageError(message)
        for group, numbers in given.items():
            _refuse_unknown(group, [f.name for f in fields(cls)], "group of settings")
            own = getattr(settings, group)
            if not isinstance(numbers, Mapping):
                message = f"the settings of {group} map names to numbers; got {numbers!r}"
                raise UsageError(message)
            for name, value in numbers.items():
                _refuse_unknown(name, [f.name for f in fields(own)], f"number in the settings of {group}")
                own = replace(own, **{name: _like(getattr(own, name), value, f"{group}.{name}")})
            settings = replace(settings, **{group: own})
        return settings

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """As plain data; `Settings.of` reads it again."""
        return asdict(self)


def table() -> Iterator[tuple[str, str, Any, str, str, str]]:
    """List every number: group, name, value, unit, meaning, source.

    Yields
    ------
    tuple

    Examples
    --------
    >>> from echocal.diagnose.settings import table
    >>> next(value for group, name, value, *_ in table() if name == "named")
    0.9
    """
    settings = Settings()
    for group in fields(settings):
        own = getattr(settings, group.name)
        for one in fields(own):
            facts = one.metadata
            yield (
                group.name,
                one.name,
                getattr(own, one.name),
                facts["unit"],
                facts["meaning"],
                facts["source"],
            )


def _refuse_unknown(name: str, known: list[str], what: str) -> None:
    if name not in known:
        message = f"'{name}' is no {what}; there are {', '.join(known)}"
        raise UsageError(message)


def _like(default: Any, value: Any, name: str) -> Any:
    """A value of the default's kind: lists of a JSON file become tuples."""
    if isinstance(default, tuple):
        if isinstance(value, list | tuple) and len(value) > 0:
            last = len(default) - 1
            return tuple(_like(default[min(i, last)], one, name) for i, one in enumerate(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        kind = type(default)
        if kind is float or float(value).is_integer():
            return kind(value)
    message = f"settings give {name} the value {value!r}; give one like {default!r}"
    raise UsageError(message)
