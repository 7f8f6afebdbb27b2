"""Tables with very many columns: memory and time have a bound, and what is there is found."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal

Table = dict[str, np.ndarray]

COLUMNS = 200
MEMORY = 1_400_000  # KiB; 100 columns took 9,200,000 before, and five minutes
SECONDS = 300  # ten are usual now


def shaped(kind: str, values: np.ndarray) -> np.ndarray:
    """A curve of a column, of a mean square of one."""
    scaled = (values - values.mean()) / values.std()
    match kind:
        case "hump":
            curve = np.exp(-(((scaled - 0.3) / 0.4) ** 2))
        case "bend":
            curve = scaled**2
        case "wave":
            curve = np.sin(3.0 * scaled)
        case _:
            curve = scaled
    return np.asarray((curve - curve.mean()) / curve.std())


def wide(kind: str, beside: str, random: np.random.Generator, rows: int = 480) -> tuple[Table, str]:
    """Readings that follow one of many further columns; others are slow, nearly constant or have gaps."""
    columns = random.normal(size=(COLUMNS, rows))
    columns[::5] = np.cumsum(columns[::5], axis=1)
    columns[1::25] = np.where(np.arange(rows) < 3, columns[1::25], 4.0)
    columns[2::25, 5] = np.nan
    columns[3::25] = 7.0
    chosen = 5 * int(random.integers(COLUMNS // 5)) + 4
    celsius = 20.0 + 8.0 * np.sin(np.arange(rows) * 2 * np.pi / 150)
    distance = random.choice([0.5, 1.0, 2.0, 3.0], rows)
    reading = distance + 2e-3 * shaped(kind, columns[chosen]) + random.normal(0.0, 1e-3, rows)
    slow = np.zeros(rows)
    for row in range(1, rows):
        slow[row] = 0.8 * slow[row - 1] + random.normal(0.0, 1e-3)
    reading += {"memory": slow, "drift": 0.02 * np.arange(rows) / rows}.get(beside, 0.0)
    table = {"reading_m": reading, "temperature_C": celsius, "distance_m": distance}
    table |= {"time_s": 60.0 * np.arange(rows)}
    return table | {f"x{i}": column for i, column in enumerate(columns)}, f"x{chosen}"


@pytest.mark.statistical
@pytest.mark.slow
@pytest.mark.parametrize("beside", ["", "drift", "memory"])
@pytest.mark.parametrize("kind", ["hump", "bend", "wave", "line"])
def test_what_follows_one_of_many_columns_is_found(
    kind: str, beside: str, random: np.random.Generator
) -> None:
    table, name = wide(kind, beside, random)
    diagnosis = echocal.diagnose(table)
    say = diagnosis.explain()
    assert diagnosis.unexplained is not None, say
    assert diagnosis.unexplained.against == name, say
    (note,) = [note for note in diagnosis.notes if "Not searched: " in note]
    count = int(note.partition(" of ")[0])
    assert 8 <= count <= 24
    able = COLUMNS - 3 * COLUMNS // 25  # the others have gaps, or one value, or four
    assert f"{count} of the {able} further columns" in note
    assert "smooth curve" in note
    assert f"{able - count - 8} more" in note
    assert "columns={'NAME': 'ignore'}" in note
    assert name not in note.partition("Not searched: ")[2].partition(". To ")[0].split(", ")


def test_few_columns_are_all_tried(random: np.random.Generator) -> None:
    table, name = wide("hump", "", random)
    few = [f"x{i}" for i in range(4, 100, 10) if f"x{i}" != name]
    known = {key: column for key, column in table.items() if not key.startswith("x")}
    diagnosis = echocal.diagnose(known | {key: table[key] for key in (*few, name)})
    assert not [note for note in diagnosis.notes if "Not searched: " in note]


@pytest.mark.statistical
@pytest.mark.parametrize(("rows", "columns"), [(12, 400), (40, 1000)])
def test_more_columns_than_rows(rows: int, columns: int, random: np.random.Generator) -> None:
    table = {
        "reading_m": 1.0 + random.normal(0.0, 1e-3, rows),
        "temperature_C": random.uniform(5.0, 30.0, rows),
        "distance_m": np.ones(rows),
    }
    table |= {f"x{i}": random.normal(size=rows) * 10.0 ** random.integers(-300, 300) for i in range(columns)}
    diagnosis = echocal.diagnose(table)
    assert [note for note in diagnosis.notes if f"of the {columns} further columns" in note]


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="no /proc elsewhere")
def test_memory_and_time_have_a_bound(tmp_path: Path, random: np.random.Generator) -> None:
    """The command, on 200 further columns, in a process whose largest memory is asked for at its end.

    ``VmHWM`` counts this program alone. ``ru_maxrss`` would not do: it keeps the size of the process that
    started the program, here the test runner.
    """
    table, name = wide("bend", "", random)
    data, said = tmp_path / "wide.csv", tmp_path / "said.json"
    pd.DataFrame(table).to_csv(data, index=False)
    measured = (
        "import atexit, sys\n"
        "from pathlib import Path\n"
        "own = Path('/proc/self/status')\n"
        "largest = lambda: own.read_text().split('VmHWM:')[1].split()[0]\n"
        "atexit.register(lambda: print(largest(), file=sys.stderr))\n"
        "from echocal.cli import main\n"
        "main()"
    )
    command = [sys.executable, "-c", measured, "diagnose", str(data), "--json", str(said), "--details"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=SECONDS)
    assert done.returncode == 0, done.stderr
    assert int(done.stderr.split()[-1]) < MEMORY
    diagnosis = json.loads(said.read_text())
    assert diagnosis["unexplained"]["against"] == name
    assert any("Not searched: " in note for note in diagnosis["notes"])
    assert "Not searched: " in " ".join(done.stdout.split())
