"""How a table is read: every option with its default, once."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from echocal.errors import UsageError
from echocal.observations.layout import Layout
from echocal.observations.mount import mounted, with_named_levels
from echocal.observations.plan import read_columns


@dataclass(frozen=True, kw_only=True)
class ReadOptions:
    """How a table is read: what keywords, flags of commands and jobs of workers say.

    The attributes are the arguments of `echocal.read_observations`. Raises `UsageError` if an option has no
    meaning.

    Examples
    --------
    >>> from echocal.observations.options import ReadOptions
    >>> options = ReadOptions(trust="temperature_C", reading_speed=343)
    >>> options.given(), options.layout.encoding
    ({'reading_speed': '343', 'trust': ('temperature_C',)}, 'utf-8-sig')
    >>> ReadOptions(**options.plain()) == options
    True
    """

    columns: Mapping[str, str] | str | Path | None = None
    reading_speed: str | float | None = None
    missing: Collection[Any] | Mapping[str, Any] = ()
    trust: Collection[str] = ()
    time_zone: str = "UTC"
    skip_lines: int = Layout.skip_lines
    decimal: str | None = Layout.decimal
    encoding: str = Layout.encoding
    time_format: str | None = None
    at: Mapping[str, Any] | None = None
    sheet: str | None = None
    mount_height: float | None = None
    reference: Any = None
    reference_join: str = "interpolated"
    layout: Layout = field(init=False, repr=False, compare=False)
    """How a text file is written."""
    requests: dict[str, str] = field(init=False, repr=False, compare=False)
    """Meaning of columns, also where `columns` is a file."""

    def __post_init__(self) -> None:
        height = None if self.mount_height is None else float(self.mount_height)
        speed = None if self.reading_speed is None else str(self.reading_speed)
        codes: Any = self.missing
        if not isinstance(codes, Mapping | str):
            codes = tuple(codes) if isinstance(codes, Collection) else (codes,)
        said = read_columns(self.columns)
        requests = mounted(said, height)
        made = {
            "requests": requests,
            "columns": said or None,
            "reading_speed": speed,
            "missing": codes,
            "trust": _names(self.trust),
            "at": {name: str(value) for name, value in (self.at or {}).items()} or None,
            "mount_height": height,
            "reference": str(self.reference) if isinstance(self.reference, Path) else self.reference,
            "layout": Layout(self.skip_lines, self.decimal, self.encoding),
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)

    def given(self) -> dict[str, Any]:
        """The options that say something, as arguments of `echocal.read_observations`."""
        own = ((one.name, getattr(self, one.name), one.default) for one in fields(ReadOptions) if one.init)
        return {name: value for name, value, usual in own if not _same(value, usual)}

    def requests_of(self, columns: Collection[str]) -> dict[str, str]:
        """Meaning of the columns of a log; of those that only the log of the reference has, none.

        Raises `UsageError` if a mount height is given, and no column is a level.
        """
        requests = with_named_levels(columns, self.requests, self.mount_height)
        if self.reference is None:
            return requests
        return {name: request for name, request in requests.items() if name in columns}

    def plain(self) -> dict[str, Any]:
        """The same as JSON holds them."""
        return {name: _plain(value) for name, value in self.given().items()}


def _names(trust: Any) -> tuple[str, ...]:
    listed = [trust] if isinstance(trust, str) else trust
    if not isinstance(listed, Collection) or not all(isinstance(name, str) for name in listed):
        raise UsageError(f'trust lists names of columns, ["temperature_C"]; got {trust!r}')
    return tuple(listed)


def _same(value: Any, usual: Any) -> bool:
    return value is usual or (isinstance(value, type(usual)) and value == usual)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(own) for name, own in value.items()}
    several = isinstance(value, Collection) and not isinstance(value, str)
    return [str(own) for own in value] if several else value
