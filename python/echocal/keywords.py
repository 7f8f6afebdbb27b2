"""How a message names a keyword argument: as Python spells it, by a command's flag, or by a page's field."""

import shlex
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from numbers import Real
from pathlib import PurePath
from typing import Any

__all__ = ["as_here", "by_caller", "command_line", "exact", "keyword", "naming", "on_page"]

_flags: Mapping[str, str] | None = None
"""Flag of each keyword of the command that runs; None where Python calls. One for all threads."""
_fields: Mapping[str, str] | None = None
"""Words for each keyword on the page that is served; None where there is no page."""


def keyword(name: str, *value: Any) -> str:
    """Name a keyword argument to the user, with its value if there is one.

    A command has no keywords. While one runs, the same call gives its flag. While a page is served, it gives
    the words of the page's field.

    Examples
    --------
    >>> keyword("round_mm", 0.5), keyword("columns", {"SR_U": "reading_m"})
    ('round_mm=0.5', "columns={'SR_U': 'reading_m'}")
    >>> with naming({"columns": "--column"}):
    ...     print(keyword("round_mm", 0.5), keyword("columns", {"SR_U": "reading_m"}), keyword("force", True))
    --round-mm 0.5 --column "SR_U=reading_m" --force
    """
    if _fields is not None:
        return _on_page(_fields, name, value)
    if _flags is None:
        return "=".join([name, *map(_python, value)])
    return _as_flag(name, value, _flags)


def _as_flag(name: str, value: tuple[Any, ...], flags: Mapping[str, str]) -> str:
    """The flag of a command, with the value if there is one."""
    flag = flags.get(name) or _flag(name)
    match value:
        case (bool(given),):
            return flag if given else flag.replace("--", "--no-", 1)
        case (Mapping() as pairs,):
            return " ".join(f"{flag} {_quoted(f'{own}={_plain(one)}')}" for own, one in pairs.items())
        case (list() | tuple() as listed,):
            return " ".join(f"{flag} {_quoted(str(own))}" for own in listed)
    words = (text if shlex.quote(text) == text else _quoted(text) for text in map(_plain, value))
    return " ".join([flag, *words])


def by_caller(python: str, command: str) -> str:
    """The words for who calls: a function of Python, or the command that runs.

    Examples
    --------
    >>> by_caller("pass x=...", "record it")
    'pass x=...'
    >>> with naming({}):
    ...     print(by_caller("pass x=...", "record it"))
    record it
    """
    return python if _flags is None else command


def command_line(command: str, *words: object, **options: Any) -> str:
    """A command that the user can run, whatever calls; an option that is None or False is left out.

    Examples
    --------
    >>> command_line("inspect", "my log.csv", write="table.csv", sheet=None, force=True)
    "echocal inspect 'my log.csv' --write table.csv --force"
    """
    parts = ["echocal", *command.split(), *map(_word, words)]
    for name, given in options.items():
        for one in given if isinstance(given, list) else [given]:
            text = exact(one)
            if one is True:
                parts.append(_flag(name))
            elif one is not None and one is not False:
                parts += [f"{_flag(name)}={text}"] if text.startswith("-") else [_flag(name), text]
    return shlex.join(parts)


def exact(value: Any) -> str:
    """The shortest text that reads back to the same number; other values as they are.

    Examples
    --------
    >>> exact(2.0), exact(0.0625 / 3), exact("avr")
    ('2', '0.020833333333333332', 'avr')
    """
    if not isinstance(value, Real) or isinstance(value, (bool, int)):
        return str(value)
    return repr(float(value)).removesuffix(".0")


@contextmanager
def naming(flags: Mapping[str, str] | None) -> Iterator[None]:
    """Name keywords by the flags of a command while a block runs; one that is not there, by its own name."""
    global _flags
    before, _flags = _flags, flags
    try:
        yield
    finally:
        _flags = before


@contextmanager
def on_page(fields: Mapping[str, str] | None) -> Iterator[None]:
    """Name keywords by the fields of a page while a block runs.

    The words of a field may have ``{0}`` for a name and ``{1}`` for its value, ``{1}`` alone for a value
    without a name. What has no field is a flag of the command that does the same.

    Examples
    --------
    >>> with on_page({"columns": "choose {1} beside '{0}'", "base": "'base': {1}"}):
    ...     print(keyword("columns", {"SR_U": "reading_m"}), keyword("base", 343), keyword("base"), sep="; ")
    ...     print(keyword("decimal", ","))
    choose reading_m beside 'SR_U'; 'base': 343; 'base'
    --decimal , of the command, for which this page has no field
    """
    global _fields
    before, _fields = _fields, fields
    try:
        yield
    finally:
        _fields = before


def _on_page(fields: Mapping[str, str], name: str, value: tuple[Any, ...]) -> str:
    """The field of a page, with the value if there is one."""
    match value:
        case (Mapping() as pairs,):
            own = {f"{name}.{one}": text for one, text in pairs.items()}
            found = [fields.get(key, fields.get(name, "")) for key in own]
            if all(found):
                words = zip(found, pairs.items(), strict=True)
                return ", ".join(text.format(one, _plain(to)) for text, (one, to) in words)
        case _ if name in fields:
            given = _plain(value[0]) if value and not isinstance(value[0], bool) else ""
            text = fields[name]
            return text.format("", given) if given else text.partition(": {1}")[0]
    return f"{_as_flag(name, value, {})} of the command, for which this page has no field"


def as_here(work: Callable[..., Any]) -> Callable[..., Any]:
    """The same work, which names keywords in another process as this one does."""
    flags, fields = (None if own is None else dict(own) for own in (_flags, _fields))
    return partial(_named, flags, fields, work)


def _named(
    flags: Mapping[str, str] | None, fields: Mapping[str, str] | None, work: Callable[..., Any], task: Any
) -> Any:
    with naming(flags), on_page(fields):
        return work(task)


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _word(word: object) -> str:
    """A word that is no option: a file whose name begins with a dash is named in its folder."""
    text = str(word)
    return f"./{text}" if isinstance(word, PurePath) and text[:1] == "-" != text else text


def _python(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{name!r}: {_python(one)}' for name, one in value.items())}}}"
    return _plain(value) if isinstance(value, Real) else repr(value)


def _plain(value: Any) -> str:
    return f"{value:.12g}" if isinstance(value, Real) and not isinstance(value, bool) else str(value)


def _quoted(text: str) -> str:
    """A word of a shell, in double quotes, which every shell has, where it can be."""
    return shlex.quote(text) if set('"$`\\!') & set(text) else f'"{text}"'
