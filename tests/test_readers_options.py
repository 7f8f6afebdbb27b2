"""What `inspect -o` writes is what `diagnose --options` takes, or the same question stays open."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from realistic_logs import drawn
from realistic_logs_more import LOGS
from test_readers_logs import Run, shell
from test_readers_unforeseen import GUESSED, REFUSED, SURE

__all__ = ["shell"]

CASES = Path(__file__).parent / "cases"


def _px4(random: np.random.Generator) -> list[str]:
    """Topic distance_sensor of a flight log, as ulog2csv writes it; times are microseconds since boot."""
    head = (
        "timestamp,device_id,min_distance,max_distance,current_distance,h_fov,v_fov,q[0],signal_quality,type"
    )
    at = 84_000_000 + np.cumsum(random.integers(66_000, 67_400, 120))
    reading = 1.5 + random.normal(0.0, 0.004, 120)
    return [
        head,
        *(
            f"{t},9506825,0.2,7.65,{d:.3f},0,0,1,{random.choice([-1, 100])},1"
            for t, d in zip(at, reading, strict=True)
        ),
    ]


def _counted(random: np.random.Generator) -> list[str]:
    rows = zip(
        np.arange(60) * 1000 + 5, random.normal(201.0, 0.2, 60), random.normal(18.0, 2.0, 60), strict=True
    )
    return ["Elapsed,Sonar,Temp", *(f"{t},{d:.1f},{c:.1f}" for t, d, c in rows)]


def _several_of_all(random: np.random.Generator) -> list[str]:
    head = (
        "Timestamp,Distance 1 (cm),Distance 2 (cm),Temp in (°C),Temp out (°C),Humidity (%),Batt (V),quality"
    )
    return [head, *(
        f"2024-05-14 {n // 60:02d}:{n % 60:02d}:00,"
        f"{random.normal(180, 0.5):.1f},{random.normal(90, 0.5):.1f},"
        f"{random.normal(21, 1):.1f},{random.normal(14, 3):.1f},{random.normal(50, 3):.0f},3.{n % 10},{n % 3}"
        for n in range(80)
    )]  # fmt: skip


FRESH = {"PX4": _px4, "a count of time": _counted, "several of all": _several_of_all}


def _lines(kind: str, random: np.random.Generator) -> bytes:
    if kind in FRESH:
        return ("\n".join(FRESH[kind](random)) + "\n").encode()
    if (CASES / kind).is_file():
        return (CASES / kind).read_bytes()
    if kind in LOGS:
        return LOGS[kind](drawn(random)).content
    made = SURE.get(kind) or GUESSED.get(kind) or REFUSED[kind][0]
    return ("\n".join(made(drawn(random))) + "\n").encode()


KINDS = (*FRESH, *sorted(own.name for own in CASES.iterdir()), *LOGS, *SURE, *GUESSED, *REFUSED)


@pytest.mark.parametrize("kind", KINDS)
def test_what_inspect_writes_is_taken(kind: str, shell: Run, random: np.random.Generator) -> None:
    ending = {"excel": ".xlsx", "zipped": ".csv.gz"}.get(kind, ".txt")
    log = f"log{ending}"
    Path(log).write_bytes(_lines(kind, random))
    encoding = ("--encoding", "utf-16") if kind == "utf16" else ()
    code, out, err = shell("inspect", log, "-o", "log.toml", "--json", "-", *encoding)
    if code == 3:  # no table of any kind: nothing is written
        assert not Path("log.toml").exists()
        return
    assert code == 0, err
    found = json.loads(out)
    written = tomllib.loads(Path("log.toml").read_text(encoding="utf-8"))["column"]
    # no proposal is one that cannot be taken
    assert not [name for name in written if f"column '{name}'" in found["refusal"]], found["refusal"]
    stated = ("--reading-speed", "343", "--at", "temperature=18+-5")
    code, out, err = shell("inspect", log, "--options", "log.toml", "--json", "-")
    assert code == 0, err
    again = json.loads(out)
    assert (again["usable"], again["refusal"]) == (found["usable"], found["refusal"])
    held = {column["proposal"]["request"].partition("_")[0] for column in found["columns"]}
    flags = stated[:2] if "temperature" in held else stated
    code, _, err = shell("diagnose", log, "--options", "log.toml", "--constant-distance", *flags, "-q")
    if code:  # the question that inspect has shown, or a table too small to be diagnosed
        same = bool(found["refusal"]) and found["refusal"].split(";")[0] in err
        assert same or "usable rows" in err or "no row can judge" in err, (err, found["refusal"])
