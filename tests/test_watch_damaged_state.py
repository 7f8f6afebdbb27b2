"""The state of `echocal watch`: a flipped bit is refused, or changes nothing."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from watched import csv, log

from echocal.errors import DataError, UsageError
from echocal.watch.state import State

FLIPS = 150


def kept(path: Path) -> list[object]:
    """All that a state says."""
    state = State(path)
    try:
        return [
            state._base.execute(f"select * from {table}").fetchall() for table in ("facts", "sensors")
        ] + [state._base.execute(f"select * from {table}").fetchall() for table in ("positions", "rows")]
    finally:
        state.close()


def test_no_flipped_bit_is_taken_for_what_was_written(
    run: Callable[..., tuple[int, str]], tmp_path: Path, random: np.random.Generator
) -> None:
    (tmp_path / "log.csv").write_text(csv(log(random, 60)))
    words = ("log.csv", "--law", "linear", "--once", "--state", "s.db", "--learn", "50")
    code, told = run("watch", *words, "--reference-distance", "2")
    assert code == 0, told
    path = tmp_path / "s.db"
    whole, said = path.read_bytes(), kept(path)
    refused = 0
    for place, bit in zip(
        random.integers(len(whole), size=FLIPS), random.integers(8, size=FLIPS), strict=True
    ):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << bit
        path.write_bytes(damaged)
        try:
            found = kept(path)
        except (DataError, UsageError):
            refused += 1
            continue
        assert found == said, f"bit {bit} of byte {place}"
    assert refused > 0


@pytest.mark.parametrize("table", ["facts", "sensors", "positions"])
def test_a_value_in_the_place_of_another_is_refused(table: str, tmp_path: Path) -> None:
    state = State(tmp_path / "s.db")
    for name in ("a", "b"):
        state._put(table, name, '"value"')
    key = {"facts": "name", "sensors": "id", "positions": "source"}[table]
    state._base.execute(f"update {table} set value = (select value from {table} where {key} = 'a')")
    state.commit()
    state.close()
    with pytest.raises(DataError, match=f"'b' in {table} has another checksum.*begin with another state"):
        State(tmp_path / "s.db")
