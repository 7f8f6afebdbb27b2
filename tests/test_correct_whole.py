"""What a file may be is decided on the whole file: the same bits for any memory, and any row groups."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.errors import DataError

MODEL = echocal.Model("linear", {"fixed_delay": {"delay": 30e-6}})
ROWS = 3000

DAMAGED = {
    "many in a few blocks": {place: f"far{place}" for place in range(1000, 1250)},
    "too many": {place: f"far{place}" for place in range(1000, 1400)},
    "one code, far apart": {10: "far", 2900: "far"},
    "one code, and another": {10: "far", 11: "far", 2900: "near"},
    "one": {1500: "far"},
    "a decimal comma": {1500: "11680,5"},
}
REFUSED = {"too many": "400 of 3000", "one code, far apart": "2 of 3000", "a decimal comma": "1 of 3000"}


def outcome(source: str, out: str, room: str, name: str, size: int, patch: pytest.MonkeyPatch) -> object:
    """The bytes of the output with blocks of one size, or the error."""
    patch.setattr(import_module(room), name, (size, size))
    Path(out).unlink(missing_ok=True)
    try:
        echocal.correct_files(source, out, MODEL, processes=1)
    except DataError as error:
        return str(error)
    return Path(out).read_bytes()


@pytest.mark.parametrize("case", DAMAGED)
def test_texts_among_numbers(
    case: str, random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    echoes = [f"{value:.1f}" for value in random.uniform(11_000, 11_900, ROWS)]
    for place, text in DAMAGED[case].items():
        echoes[place] = text
    body = "".join(f"{echo};20.5\n" for echo in echoes)
    Path("log.csv").write_text(f"echo_us;temperature_C\n{body}")
    room = "echocal.correct.text.file"
    found = [outcome("log.csv", "o.csv", room, "_BLOCK", size, monkeypatch) for size in (300, 4000, 1 << 23)]
    assert found[0] == found[1] == found[2]
    assert isinstance(found[0], str) == (case in REFUSED)
    if case in REFUSED:
        assert f"text in {REFUSED[case]} rows, first at row {min(DAMAGED[case]) + 1}" in str(found[0])

    table = pa.table({"echo_us": echoes, "temperature_C": [20.5] * ROWS})
    told = []
    for group, size in ((ROWS, 1 << 18), (ROWS, 100), (250, 100), (250, 1 << 18)):
        pq.write_table(table, "log.parquet", row_group_size=group)
        made = outcome(
            "log.parquet", "o.parquet", "echocal.correct.parquet.file", "_PIECE", size, monkeypatch
        )
        told.append(made if isinstance(made, str) else pq.read_table("o.parquet").to_pydict())
    assert all(isinstance(one, str) == (case in REFUSED) for one in told)
    assert all(one == told[0] for one in told)
