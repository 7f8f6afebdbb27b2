"""From a column as read to numbers: missing values, error codes, text that is no number."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError, UsageError, among
from echocal.keywords import keyword
from echocal.observations.fields import fields, row, shown

_GROUPED = re.compile(r"[-+]?\d{1,3}([.,' ])\d{3}(?:(?:\1\d{3})*(?!\1)[.,]\d+|(?:\1\d{3})+)")
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?(?:inf|infinity|nan)", re.IGNORECASE)  # what Arrow takes for numbers, too
EXACT = 2.0**53
"""Integers of this size and more are not all floats: each that is not becomes one that is."""

EMPTY = frozenset(
    (
        *("", "NA", "N/A", "n/a", "nan", "NaN", "NAN", "-nan", "-NaN", "null", "NULL", "None", "<NA>", "NaT"),
        *("#N/A", "#N/A N/A", "#NA", "1.#IND", "-1.#IND", "1.#QNAN", "-1.#QNAN"),  # of spreadsheets and C
    )
)
"""Texts that mean "no value" in any column."""

NO_NUMBER = EMPTY | {
    "-", "--", "---", "#NV", "n.a.", "none", "undefined", "unavailable", "unknown", "Nan", "INF", "-INF",
}  # fmt: skip
"""Texts that mean "no value" in a column of numbers."""

_FEW = 10  # of so many fields, one may be no number

NO_ECHO = "no echo"
"""Reason of a row whose line says that no echo came."""

SILENT = (
    r"time[ds]?[ _-]?out(?!\s*[:=]\s*\d)"
    r"|out[ _-]of[ _-](?:max\w*[ _-])?range|(?:over|beyond)[ _-](?:max\w*[ _-])?range"
    r"|no[ _-]?(?:echo|ping|pulse|object|obstacle|signal|reading|target|return|response|measure\w*|valid\w*)"
    r"|retry(?:ing)?|invalid|too[ _-](?:far|close)|not[ _-](?:detected|valid)|lost[ _-](?:echo|ping|pulse)"
    r"|(?:echo|ping|pulse)[ _-](?:was[ _-])?(?:lost|missed|missing)|nothing (?:in|within|detected)"
)
"""Words that say so, wherever the letters are small or large."""

_WORDS = re.compile(
    rf"(?i)(?<![a-z])(?:{SILENT}|error (?:getting|reading|measuring) (?:the )?distance)(?![a-z])"
)
_OTHERS = re.compile(
    r"(?i)(?<![a-z])(?:wi-?fi|mqtt|ntp|https?|tcp|udp|socket|server|broker|connect\w*|dht\w*|temp\w*|humid\w*"
    r"|dallas|ds18\w*|bme\w*|i2c|api|ota|dns|ip|client|login|password|lora\w*|modem|network)(?![a-z])"
)
"""Of which a line may speak instead."""
_ECHO_OF_CODE = re.compile(r"\s+warnings\.warn\(")


class Missing:
    """The error codes that mean "no value", for every column or by column, in the units of the file."""

    def __init__(self, codes: Collection[Any] | Mapping[str, Any] = ()) -> None:
        by_column = codes if isinstance(codes, Mapping) else {"": codes}
        self._codes = {
            column: [str(code).strip() for code in (listed if _listed(listed) else [listed])]
            for column, listed in by_column.items()
        }

    def refuse_unknown(self, columns: Collection[str]) -> None:
        """Refuse codes for a column that is not there."""
        absent = sorted(set(self._codes) - {"", *columns})
        if absent:
            raise UsageError(
                f"error codes for column '{absent[0]}', which is not there{among(absent[0], columns)}"
            )

    def texts(self, column: str) -> frozenset[str]:
        """Codes of a column, as text."""
        return frozenset(self._codes.get(column, [])) | frozenset(self._codes.get("", []))

    def numbers(self, column: str) -> list[float]:
        """Codes of a column that are numbers."""
        return [float(code) for code in self.texts(column) if _is_number(code)]


def number_of(text: str, absent: Collection[str], decimal: str = ".") -> float | None:
    """Number that a field is, NaN where it means "no value"; None where it is neither.

    Examples
    --------
    >>> from echocal.observations.numbers import NO_NUMBER, number_of
    >>> number_of("2,5", NO_NUMBER, ","), number_of("n/a", NO_NUMBER), number_of("far", NO_NUMBER)
    (2.5, nan, None)
    """
    plain = text.strip()
    if plain in absent:
        return np.nan
    if decimal != ".":
        plain = plain.replace(decimal, ".")
        if plain in absent:
            return np.nan
    return float(plain) if NUMBER.fullmatch(plain) or _NOT_FINITE.fullmatch(plain) else None


def to_numbers(
    values: pd.Series[Any],
    column: str,
    missing: Missing,
    corrupt: list[int] | None = None,
    *,
    part: bool = False,
) -> Column:
    """Numbers of a column; NaN where the field is empty or holds an error code.

    Raises `DataError` if a field holds text that is no number.

    Parameters
    ----------
    corrupt : list of int, optional
        Takes the places of texts that are no numbers, if at most a tenth of the fields is such; they are NaN.
    part : bool
        Whether the column goes on elsewhere: then `corrupt` takes all of them, and `Damage` judges the whole.
    """
    if pd.api.types.is_datetime64_any_dtype(values) or pd.api.types.is_timedelta64_dtype(values):
        raise DataError(f"column '{column}' holds {values.dtype}, not numbers")
    if pd.api.types.is_complex_dtype(values):
        raise DataError(
            f"column '{column}' holds complex numbers ({values.dtype}); give the real part, or its magnitude"
        )
    if pd.api.types.is_numeric_dtype(values):
        numbers = values.to_numpy(dtype=np.float64, na_value=np.nan, copy=True)
    else:
        numbers = _parse(values, column, missing, corrupt, part=part)
    codes = missing.numbers(column)
    if codes:
        numbers[np.isin(numbers, codes)] = np.nan
    return numbers


def _parse(
    values: pd.Series[Any], column: str, missing: Missing, corrupt: list[int] | None, *, part: bool
) -> Column:
    texts = fields(values, column)
    absent = texts.isin(NO_NUMBER | missing.texts(column)).to_numpy()
    numbers = pd.to_numeric(texts.where(~absent), errors="coerce").to_numpy(dtype=np.float64, copy=True)
    wrong = np.flatnonzero(np.isnan(numbers) & ~absent)
    wrong = wrong[[not says_no_echo(text) for text in texts.iloc[wrong]]]
    if corrupt is not None and (part or not Damage.of(texts.iloc[wrong]).is_refused(len(texts))):
        corrupt += wrong.tolist()
    elif len(wrong):
        raise DataError(
            f"column '{column}' has text in {len(wrong)} of {len(texts)} rows, "
            f"first at {row(wrong[0])}: '{shown(texts.iloc[wrong[0]])}'; {_hint(texts.iloc[wrong])}"
        )
    return numbers


@dataclass(frozen=True)
class Damage:
    """Texts of a column that are no numbers: few of them are damage, and others a mistake."""

    count: int = 0
    meant: bool = False  # whether one of them is meant as a number, as with a decimal comma
    distinct: frozenset[str] = frozenset()  # one of them, or two that differ

    @classmethod
    def of(cls, texts: pd.Series[Any]) -> Damage:
        """That of some texts, none of which is a number."""
        meant = any(_GROUPED.fullmatch(text) or _is_number(text.replace(",", ".", 1)) for text in texts)
        return cls(len(texts), meant, frozenset(sorted(set(texts))[:2]))

    def __add__(self, other: Damage) -> Damage:
        distinct = frozenset(sorted(self.distinct | other.distinct)[:2])
        return Damage(self.count + other.count, self.meant or other.meant, distinct)

    def is_refused(self, rows: int) -> bool:
        """Whether it is too much of so many rows, is meant as numbers, or is one code again and again."""
        again = self.count > 1 and len(self.distinct) == 1
        return self.count > 0 and (_FEW * self.count > rows or self.meant or again)


def _hint(texts: pd.Series[Any]) -> str:
    """Way out of texts that are no numbers."""
    grouped = next(filter(None, map(_GROUPED.fullmatch, texts)), None)
    if grouped is not None:
        plain = grouped[0].replace(grouped[1], "")
        return f"'{grouped[0]}' has separators of thousands: write such numbers without, as {plain}"
    if "," in texts.iloc[0] and _is_number(texts.iloc[0].replace(",", ".", 1)):
        return f"a decimal comma? pass {keyword('decimal', ',')}"
    if _is_number(texts.iloc[0]):
        return "write plain digits with a decimal point, as 2945.7"
    return f'if it means "no value": {keyword("missing", [shown(texts.iloc[0])])}'


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _listed(codes: Any) -> bool:
    return isinstance(codes, Collection) and not isinstance(codes, str)


def says_no_echo(text: str) -> bool:
    """Whether a line says that no echo came.

    Examples
    --------
    >>> says_no_echo("'Tank' - Distance measurement timed out!"), says_no_echo("MQTT connection timed out")
    (True, False)
    >>> says_no_echo("Timeout: 11661 us")  # what it is set to
    False
    """
    return bool(_WORDS.search(text)) and not (_OTHERS.search(text) or _ECHO_OF_CODE.match(text))
