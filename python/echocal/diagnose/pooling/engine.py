"""`echocal.diagnose_many`: the arguments, and what they mean."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from echocal.diagnose.pipeline import examined
from echocal.diagnose.pooling.parts import SkippedTable
from echocal.diagnose.pooling.pool import pooled
from echocal.diagnose.pooling.result import PooledDiagnosis
from echocal.diagnose.pooling.source import sources_of
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.preprocess.reading import read
from echocal.diagnose.progress import Steps
from echocal.diagnose.request import Request
from echocal.diagnose.settings import Settings
from echocal.errors import DataError
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.given import READ_OPTIONS, refuse_keywords

__all__ = ["diagnose_many"]

PoolProgress = Callable[[str, int, int], object]
"""Called with the name of the table, the number of tables done, and the number of all tables."""

_FEWEST = 2


def diagnose_many(
    tables: Any,
    *,
    by: str | Sequence[str] | None = None,
    base: str | float | Model = "linear",
    reference_distance: float | None = None,
    constant_distance: bool = False,
    columns: Mapping[str, str] | str | Path | None = None,
    reading_speed: str | float | None = None,
    missing: Collection[Any] | Mapping[str, Any] = (),
    since: str | None = None,
    until: str | None = None,
    seed: int = 0,
    settings: Settings | Mapping[str, Mapping[str, Any]] | None = None,
    progress: PoolProgress | None = None,
    **table: Any,
) -> PooledDiagnosis:
    """Name what a base simulation gets wrong about several tables together.

    The tables are of one instrument, or of several instruments of one kind. Each is diagnosed alone. Then the
    sets of causes that all of them share are compared (docs/method/several-tables.md, section 10): a shared
    cause has one prior probability for all tables, and a size in each table that varies around a common
    mean. The gain is measured on tables left out in turn.

    Parameters
    ----------
    tables : mapping of str to table, sequence of tables, or one table
        Tables as for `echocal.diagnose`. One table with `by`.
    by : str or sequence of str, optional
        Column of one table whose labels divide its rows: ``"sensor_id"``. Several names are rangers beside
        each other: ``["left", "right"]`` or ``"left,right"``.
    base, reference_distance, constant_distance, columns, reading_speed, missing, since, until, seed, settings
        As for `echocal.diagnose`; the same for every table.
    progress : callable, optional
        Called as each table begins, with its name, the number of tables done and of all tables.
    **table
        Further arguments of `echocal.read_observations`.

    Returns
    -------
    PooledDiagnosis

    Raises
    ------
    DataError
        If fewer than two tables can be diagnosed. Of the others, those that cannot be are listed in
        ``PooledDiagnosis.skipped``.
    UsageError
        If a request contradicts itself or a table.

    Examples
    --------
    Three devices that ignore the temperature, in one table:

    >>> import numpy as np
    >>> import echocal
    >>> unit = np.repeat(["A", "B", "C"], 60)
    >>> temperature = np.tile(np.linspace(0.0, 40.0, 60), 3)
    >>> noise = np.random.default_rng(1).normal(0.0, 1e-3, 180)
    >>> reading = 1.5 * 343.0 / (331.4 + 0.6 * temperature) + noise
    >>> fleet = {"sensor_id": unit, "reading_m": reading, "temperature_C": temperature}
    >>> found = echocal.diagnose_many(fleet, by="sensor_id", reference_distance=1.5)
    >>> found.verdict, found.causes[0].id, found.causes[0].recurs_in
    ('named', 'fixed_speed', ('A', 'B', 'C'))
    """
    start = time.perf_counter()
    refuse_keywords(diagnose_many, table, READ_OPTIONS)
    request = Request.of(
        base,
        seed,
        settings,
        reference_distance=reference_distance,
        constant_distance=constant_distance,
        since=since,
        until=until,
    )
    how: dict[str, Any] = {"columns": columns, "reading_speed": reading_speed, "missing": missing, **table}
    sources = sources_of(tables, by, how)
    found, skipped = _each(sources.tables, sources.how, request, progress)
    if sources.unlabeled:
        why = f"column '{sources.by}' is empty in these rows"
        skipped.append(SkippedTable("(no label)", sources.unlabeled, why))
    if len(found) < _FEWEST:
        raise DataError(_too_few(len(found), skipped))
    if progress is not None:
        progress("comparing tables", len(sources.tables), len(sources.tables))
    result = pooled(found, tuple(skipped), request.settings, seed)
    return replace(result, seconds=time.perf_counter() - start)


def _each(
    tables: Mapping[str, Any], how: Mapping[str, Any], request: Request, progress: PoolProgress | None
) -> tuple[list[TableInference], list[SkippedTable]]:
    """Diagnose each table; those that are too small or cannot be read are listed."""
    found, skipped = [], []
    for done, (name, source) in enumerate(tables.items()):
        if progress is not None:
            progress(name, done, len(tables))
        begun = time.perf_counter()
        own = dict(how)
        if not isinstance(source, Observations):
            own["reading_speed"] = own.get("reading_speed") or request.base.reading_speed
        try:
            result = examined(read(source, own), request, Steps(None))
        except DataError as error:
            skipped.append(SkippedTable(name, _rows(source), str(error)))
            continue
        seconds = time.perf_counter() - begun
        found.append(TableInference.of(name, result, replace(result.diagnosis, seconds=seconds)))
    return found, skipped


def _rows(source: Any) -> int | None:
    return None if isinstance(source, str | Path | Mapping) or not hasattr(source, "__len__") else len(source)


def _too_few(count: int, skipped: list[SkippedTable]) -> str:
    each = "; ".join(f"{one.name}: {one.reason}" for one in skipped[:5])
    more = f"; and {len(skipped) - 5} others" if len(skipped) > 5 else ""
    said = f" ({each}{more})" if each else ""
    return (
        f"a pool needs at least {_FEWEST} tables that can be diagnosed; it has "
        f"{count or 'none'}{said}; echocal.diagnose diagnoses one table"
    )
