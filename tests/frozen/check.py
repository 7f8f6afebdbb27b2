"""Compare the diagnosis of every table with what was frozen, or freeze it anew.

python tests/frozen/check.py               # all, on two processes
python tests/frozen/check.py --every 10    # a tenth
python tests/frozen/check.py --write       # after a change that is meant, and explained in its commit
"""

import json
import os
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Annotated

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import typer  # noqa: E402
from rich.progress import track  # noqa: E402

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from frozen.record import Record, differences, record  # noqa: E402
from frozen.tables import tables  # noqa: E402

_WIDTH = 300  # characters of a difference

FROZEN = HERE / "diagnoses.json"
SHARED = Path(os.environ.get("ECHOCAL_SHARED", HERE.parents[2] / "shared"))


def diagnosed(name: str) -> Record:
    """What the engine says of one table; an error is an answer too."""
    with warnings.catch_warnings(action="ignore"):
        try:
            return record(tables(SHARED)[name]())
        except Exception as error:
            return {"error": f"{type(error).__name__}: {error}"}


def main(
    every: Annotated[int, typer.Option(help="Take each so many-th table.")] = 1,
    only: Annotated[str, typer.Option(help="Take tables whose name has this.")] = "",
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    write: Annotated[bool, typer.Option("--write", help="Freeze what is found.")] = False,
    show: Annotated[int, typer.Option(help="Differences shown for a table.")] = 5,
) -> None:
    """Diagnose the tables of the corpus and compare."""
    names = [name for name in tables(SHARED) if only in name][::every]
    with ProcessPoolExecutor(processes) as pool:
        answers = track(pool.map(diagnosed, names), "frozen corpus", total=len(names), disable=None)
        found = dict(zip(names, answers, strict=True))
    frozen = json.loads(FROZEN.read_text()) if FROZEN.exists() else {}
    changed = 0
    for name in names:
        lines = list(differences(frozen.get(name), found[name]))
        changed += bool(lines)
        for line in lines[: 0 if write else show]:
            print(f"{name}{line[:_WIDTH]}")
    print(f"{len(names)} tables, {changed} differ")
    if write:
        text = ",\n".join(
            f"{json.dumps(name)}: {json.dumps(said)}" for name, said in {**frozen, **found}.items()
        )
        FROZEN.write_text(f"{{\n{text}\n}}\n", encoding="utf-8")
    elif changed:
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
