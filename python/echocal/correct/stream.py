"""Correct a file piece by piece, several pieces at a time, in the order of the rows."""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import pandas as pd

from echocal.correct.corrector import Context, Corrector, Tally
from echocal.correct.rows import Rows

Item = TypeVar("Item")
Made = TypeVar("Made")


def in_order(items: Iterator[Item], work: Callable[[Item], Made], threads: int) -> Iterator[Made]:
    """Work on items with several threads; the results come in order, and few items are held at a time."""
    if threads <= 1:
        yield from map(work, items)
        return
    with ThreadPoolExecutor(threads) as pool:
        waiting: deque[Future[Made]] = deque()
        try:
            for item in items:
                waiting.append(pool.submit(work, item))
                if len(waiting) > threads:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()


def with_neighbors(
    tables: Iterator[pd.DataFrame], around: int, before: pd.DataFrame | None, after: pd.DataFrame | None
) -> Iterator[tuple[pd.DataFrame, int, int, int]]:
    """Tables with so many rows of their neighbors on both sides.

    Yields the table, the rows of neighbors before, its own rows, and the place of the first of all rows,
    counted from the first row of `before`.
    """
    if not around:
        at = 0
        for table in tables:
            yield table, 0, len(table), at
            at += len(table)
        return
    held: deque[pd.DataFrame] = deque()
    left = before
    at = 0 if left is None else len(left)
    ended = False
    while True:
        while not ended and sum(len(table) for table in list(held)[1:]) < around:
            more = next(tables, None)
            if more is None:
                ended = True
                if after is not None and len(after):
                    held.append(after)
            else:
                held.append(more)
        own_left = len(held) - (1 if ended and after is not None and len(after) else 0)
        if own_left <= 0:
            return
        own = held.popleft()
        lead = None if left is None else left.tail(around)
        trail = pd.concat(list(held), ignore_index=True).head(around) if held else None
        joined = pd.concat([part for part in (lead, own, trail) if part is not None], ignore_index=True)
        count = 0 if lead is None else len(lead)
        yield joined, count, len(own), at - count
        left = own.tail(around) if left is None else pd.concat([left, own], ignore_index=True).tail(around)
        at += len(own)


def corrected(
    tables: Iterator[pd.DataFrame],
    corrector: Corrector,
    tally: Tally,
    then: Callable[[Rows, int], Made],
    *,
    context: Context,
    before: pd.DataFrame | None = None,
    after: pd.DataFrame | None = None,
    threads: int = 1,
) -> Iterator[Made]:
    """Correct pieces; `then` is called with the rows and the place of each piece, in the same thread.

    The counts go to `tally` in the order of the rows.
    """

    def work(item: tuple[int, tuple[pd.DataFrame, int, int, int]]) -> tuple[Rows, list, Made]:  # type: ignore[type-arg]
        place, (table, lead, count, begin) = item
        rows, parts = corrector.correct(
            table, context.rows(begin, begin + len(table)), own=(lead, lead + count)
        )
        return rows, parts, then(rows, place)

    pieces = enumerate(with_neighbors(tables, corrector.rows_around, before, after))
    for rows, parts, made in in_order(pieces, work, threads):
        tally.add(rows, parts)
        yield made
