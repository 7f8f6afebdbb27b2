"""Values with their unit in each cell: ``12.3 cm``."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pandas as pd

from echocal.observations.found import Found
from echocal.observations.numbers import NO_NUMBER
from echocal.observations.units_said import symbol_of

__all__ = ["step"]

_NAMELESS = re.compile(r"(?i)column \d+|unnamed \d+|units?|einheit(?:en)?")
_CELL = r"^([-+]?\d*[.,]?\d+(?:[eE][-+]?\d+)?)\s*([^\d\s.,:/-][^\d]{0,7})$"


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Take the unit out of the cells of columns where nearly all have the same."""
    units = dict(found.units)
    for name in table.columns:
        if pd.api.types.is_numeric_dtype(table[name]) or table[name].isna().all():
            continue
        texts: pd.Series[Any] = (
            table[name].astype(object).map(lambda v: v.strip() if isinstance(v, str) else v)
        )
        filled = texts[texts.map(lambda v: isinstance(v, str) and v not in NO_NUMBER)]
        parts = filled.astype(str).str.extract(_CELL)
        known = parts[1].dropna().map(symbol_of)
        usual = known[known != ""].mode()
        grouped = parts[0].dropna().str.fullmatch(r"[-+]?[1-9]\d{0,2},\d{3}")
        if grouped.any() and not parts[0].dropna().str.fullmatch(r"[-+]?0?,\d+|[-+]?\d+,\d{1,2}").any():
            continue  # 2,495 may be 2495
        if usual.empty or 10 * int((known == usual[0]).sum()) < 9 * len(filled):
            continue
        same = known.index[known == usual[0]]
        values = texts.copy()
        values[same] = parts.loc[same, 0].str.replace(",", ".", regex=False)
        table = table.assign(**{name: _numbers(values)})
        units.setdefault(str(name), str(parts[1].dropna().mode()[0]).strip())
    return table, replace(found, units={**_beside(table), **units})


def _beside(table: pd.DataFrame) -> dict[str, str]:
    """Units in columns of their own behind the numbers, in a table without names: ``1.234,M,20.1,C``."""
    units = {}
    for name, behind in pairwise(table.columns):
        if not _NAMELESS.fullmatch(str(behind)):
            continue
        if not pd.api.types.is_numeric_dtype(table[name]) or pd.api.types.is_numeric_dtype(table[behind]):
            continue
        texts = table[behind].dropna().astype(str).str.strip().unique()
        if len(texts) == 1 and symbol_of(texts[0]):
            units[str(name)] = str(texts[0])
    return units


def _numbers(values: pd.Series[Any]) -> pd.Series[Any]:
    plain = values.where(~values.isin(NO_NUMBER), None)
    numbers = pd.to_numeric(plain, errors="coerce")
    return numbers if numbers.notna().sum() == plain.notna().sum() else values
