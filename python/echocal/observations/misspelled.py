"""A quantity that a table lacks: which column may hold it, by a name that is nearly one of it."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from difflib import get_close_matches

from echocal.errors import AbsentError, DataError
from echocal.keywords import keyword
from echocal.observations.names import phrase
from echocal.observations.plan import Assignment
from echocal.observations.units import FORMS
from echocal.quantities import Form

_LONGEST = 80  # letters of a name that is compared: the time goes with their square
_MISSPELLED = 0.75  # likeness from which on a name is taken for another one misspelled


def misspelled(quantity: str, names: Collection[str]) -> str:
    """Which column may hold a quantity, by a name that is nearly one of it, and what columns there are.

    Examples
    --------
    >>> misspelled("temperature", ["echo_us", "temprature_C"])
    "; did you mean: columns={'temprature_C': 'temperature_C'}? The table has: echo_us, temprature_C"
    >>> misspelled("temperature", ["echo_us"])
    '; the table has: echo_us'
    """
    forms = [form for form in FORMS if form.quantity == quantity]
    found = meant([name for name in names if len(name) <= _LONGEST], forms)
    said = f"; did you mean: {keyword('columns', found)}? The" if found else "; the"
    return f"{said} table has: {', '.join(names)}"


@contextmanager
def naming(names: Collection[str]) -> Iterator[None]:
    """Tell, where a quantity is absent, which of the columns of the user's table may hold it."""
    try:
        yield
    except AbsentError as error:
        raise DataError(f"{error}{misspelled(error.quantity, names)}") from None


def meant(others: Collection[str], forms: Collection[Form]) -> dict[str, str]:
    """Request of a column whose name says a quantity in other words, or misspells it."""
    for name in others:
        said = phrase(name)
        if said and said[0] in forms:
            return {name: Assignment(name, *said).name}
    known = [name for form in forms for name in form.names]
    for name in others:
        if near := get_close_matches(name, known, n=1, cutoff=_MISSPELLED):
            return {name: near[0]}
    return {}
