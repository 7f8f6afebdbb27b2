"""Types of columns of text: numbers if that loses no digit, truth values, else text; null if empty.

A type must hold for the whole column. So it is found piece by piece first: the types that are possible in
every piece are possible in the column.
"""

from collections.abc import Collection
from typing import Any

from echocal.observations.arrow import arrow
from echocal.observations.numbers import EMPTY, EXACT

__all__ = ["KINDS", "kind_of", "possible", "type_of", "typed"]

KINDS = ("truth", "integer", "positive", "float")
"""Types that a column of text may have; the first that is possible is taken."""

_WHOLE = r"^(0|-?[1-9][0-9]*)$"  # "007" is a name, and stays one
_INTEGER = r"^[-+]?[0-9]+$"
_PADDED = r"^[-+]?0[0-9]+$"
_NUMBER = r"^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$"
_TRUTHS = ("True", "False", "TRUE", "FALSE", "true", "false")


def possible(column: Any, decimal: str, among: Collection[str]) -> frozenset[str] | None:
    """Types that a piece of a column may have; None where it is empty, and says nothing.

    Parameters
    ----------
    column : pyarrow.Array of texts
    decimal : str
        Decimal separator.
    among : collection of str
        Types that are possible in other pieces.
    """
    texts = _filled(column)
    if texts.null_count == len(texts):
        return None
    tests = {"truth": _are_truths, "integer": _are_whole, "positive": _are_positive}
    found = {kind for kind, holds in tests.items() if kind in among and holds(texts)}
    if "float" in among and _floats(texts, decimal) is not None:
        found.add("float")
    return frozenset(found)


def kind_of(found: Collection[str] | None) -> str:
    """The type of a column, of those that are possible; ``"text"`` where it is empty or none is."""
    return next((kind for kind in KINDS if found is not None and kind in found), "text")


def typed(column: Any, kind: str, decimal: str) -> Any:
    """A piece of a column in its type."""
    pa = arrow()
    pc = pa.compute
    if kind == "text":
        return pc.if_else(pc.equal(column, ""), pa.scalar(None, column.type), column).cast(type_of(kind))
    texts = _filled(column)
    if kind == "truth":
        return pc.equal(pc.utf8_lower(texts), "true")
    if kind == "float":
        texts = pc.replace_substring(texts, decimal, ".")
    return texts.cast(type_of(kind))


def type_of(kind: str) -> Any:
    """Type in Arrow."""
    pa = arrow()
    return {
        "truth": pa.bool_(),
        "integer": pa.int64(),
        "positive": pa.uint64(),
        "float": pa.float64(),
        "text": pa.large_string(),
    }[kind]


def _filled(column: Any) -> Any:
    """Null where a text says that there is no value."""
    pa = arrow()
    absent = pa.compute.is_in(column, pa.array(sorted(EMPTY), column.type))
    return pa.compute.if_else(absent, pa.scalar(None, column.type), column)


def _are_truths(texts: Any) -> bool:
    pa = arrow()
    return bool(pa.compute.all(pa.compute.is_in(texts.drop_null(), pa.array(_TRUTHS, texts.type))).as_py())


def _are_whole(texts: Any) -> bool:
    return _fit(texts, arrow().int64())


def _are_positive(texts: Any) -> bool:
    return _fit(texts, arrow().uint64())


def _fit(texts: Any, kind: Any) -> bool:
    pa = arrow()
    if not pa.compute.all(pa.compute.match_substring_regex(texts, _WHOLE)).as_py():
        return False
    try:
        texts.cast(kind)
    except pa.ArrowInvalid:  # wider than that
        return False
    return True


def _floats(texts: Any, decimal: str) -> Any | None:
    """Floats of texts that are all numbers of a float's range, and whose integers lose no digit."""
    pa = arrow()
    pc = pa.compute
    filled = texts.drop_null()
    if decimal != "." and pc.any(pc.match_substring(filled, ".")).as_py():
        return None  # a separator of thousands, a date
    plain = pc.replace_substring(texts, decimal, ".")
    if not pc.all(pc.match_substring_regex(plain, _NUMBER)).as_py():
        return None
    if pc.any(pc.match_substring_regex(filled, _PADDED)).as_py():
        return None
    numbers = plain.cast(pa.float64())
    long = pc.and_(pc.match_substring_regex(texts, _INTEGER), pc.greater_equal(pc.abs(numbers), EXACT))
    integers = pc.filter(texts, long, null_selection_behavior="drop").to_pylist()
    exact = pc.all(pc.is_finite(numbers)).as_py() and all(int(text) == float(text) for text in integers)
    return numbers if exact else None
