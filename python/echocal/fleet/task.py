"""One task: the diagnoses of some sensors. Plain data in, plain data out; any ``map`` can run it.

A task writes the model and the diagnosis of each sensor, then its record. Each file has a temporary name
until it is complete, so a task can be run twice, at the same time too, or be killed at any moment. The same
task makes the same verdicts. A task that outlives its run, on a worker of a cluster, writes nothing.
"""

import gzip
import hashlib
import json
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal._interrupt import stop_if_told
from echocal.correct.task import refuse_other_version
from echocal.diagnose.pipeline import Examined, examined
from echocal.diagnose.preprocess.reading import read
from echocal.diagnose.progress import Steps
from echocal.diagnose.request import Request
from echocal.errors import EchocalError, unexpected
from echocal.fleet.gather import Log, logs
from echocal.fleet.index import Sensor
from echocal.fleet.store import Store, put
from echocal.fleet.verdicts import FAILED, failure, record
from echocal.model import document
from echocal.model.plain import from_plain
from echocal.observations.layout import Layout
from echocal.observations.options import ReadOptions

SCHEMA = "echocal.fleet_task/1"

_SENSORS = 16
"""Sensors of a task at most: what a killed worker loses is seconds."""

BYTES_A_ROW = 400
"""What a row takes while a group of sensors is read and one of them is diagnosed; judgement."""


def run_task(task: Mapping[str, Any]) -> dict[str, Any]:
    """Diagnose the sensors of a task.

    Task (see `tasks_of`) and result are plain data. A mistake in the data of a sensor never raises; it is in
    the record of the sensor.
    """
    begun = time.perf_counter()
    refuse_other_version(task, SCHEMA)
    job = task["job"]
    store = Store(Path(job["store"]))
    store.check(job.get("run"))
    reading = ReadOptions(**job["reading"])
    bucket = (Path(job["store"]), task["bucket"]) if "bucket" in task else None
    found = logs(
        task["sensors"],
        job["by"],
        job["kind"],
        reading.requests,
        Layout(**job["layout"]),
        reading.time_zone,
        bucket,
    )
    records = [_record(sensor, log, job) for sensor, log in found]
    store.check(job.get("run"))
    put(store.path(task["number"]), gzip.compress(json.dumps(records).encode(), 1, mtime=0))
    return {
        "number": task["number"],
        "sensors": len(records),
        "failed": sum(one["verdict"] == FAILED for one in records),
        "seconds": time.perf_counter() - begun,
    }


def _record(sensor: Mapping[str, Any], log: Log, job: Mapping[str, Any]) -> dict[str, Any]:
    begun = time.perf_counter()
    own: dict[str, Any] = {
        "sensor": sensor["key"],
        "kind": sensor["kind"],
        "files": len(sensor["files"]),
        "file": sensor["file"],
        "repeated": log.repeated,
        "model": None,
        "model_hash": None,
        "sha256": {},
    }
    done = None
    if log.error:
        found = failure(log.error)
    else:
        try:
            done = _diagnosed(log, job)
            found = record(done)
        except (EchocalError, MemoryError) as error:
            found = failure(str(error) or type(error).__name__)
        except BaseException as error:  # of one sensor: the others go on, and the table tells
            stop_if_told()
            found = failure(unexpected(error))
    found["notes"] = [*log.notes, *found["notes"]]
    seconds = time.perf_counter() - begun
    if done is not None:
        own |= _written(done, sensor, job, seconds)  # what cannot be written ends the run
    return {**found, **own, "seconds": seconds}


def _diagnosed(log: Log, job: Mapping[str, Any]) -> Examined:
    request = _request(json.dumps(job["request"], sort_keys=True))
    how = {"reading_speed": request.base.reading_speed, **job["reading"]}
    with warnings.catch_warnings(action="ignore"):  # the record has the notes
        return examined(read(log.columns, how), request, Steps(None))


@lru_cache(maxsize=4)
def _request(text: str) -> Request:
    plain = json.loads(text)
    base = plain.pop("base")
    base = from_plain(base, "the base") if isinstance(base, dict) else base
    return Request.of(base, plain.pop("seed"), plain.pop("settings"), **plain)


def _written(
    done: Examined, sensor: Mapping[str, Any], job: Mapping[str, Any], seconds: float
) -> dict[str, Any]:
    """Write the model and the diagnosis where they are asked for."""
    diagnosis = done.diagnosis
    model = diagnosis.model
    content = document.content(model)
    hash_ = document.digest(content)
    named: dict[str, Any] = {"model_hash": hash_}
    made: dict[str, str] = {}
    Store(Path(job["store"])).check(job.get("run"))
    if job["models"] is not None:
        known = {**model.provenance, "made_by": "echocal diagnose", "sensor": sensor["key"]}
        made["models"] = put(
            Path(job["models"]) / sensor["file"], _text({**content, "hash": hash_, "data": known})
        )
        named["model"] = sensor["file"]
    if job["results"] is not None:
        whole = replace(diagnosis, seconds=seconds).to_dict()
        made["results"] = put(Path(job["results"]) / sensor["file"], _text(whole))
    return {**named, "sha256": made}


def _text(data: Mapping[str, Any]) -> bytes:
    return (json.dumps(data, indent=1, allow_nan=False) + "\n").encode()


def tasks_of(
    sensors: Sequence[Sensor], names: Mapping[str, str], by: str | None, job: Mapping[str, Any], memory: int
) -> list[dict[str, Any]]:
    """Tasks as plain data. The same sensors and the same job make the same tasks.

    `names` are the files of the sensors, `job` is what all tasks share, and `memory` the bytes that one
    process may use for rows.
    """
    places: dict[Path, int] = {}
    for sensor in sensors:
        for file, _ in sensor.files:
            places.setdefault(file.file, len(places))
    most = max(memory // BYTES_A_ROW, 1)
    groups: list[list[Sensor]] = [[]]
    rows = 0
    for sensor in sensors:
        if groups[-1] and (len(groups[-1]) == _SENSORS or rows + sensor.rows > most):
            groups.append([])
            rows = 0
        groups[-1].append(sensor)
        rows += sensor.rows
    return [
        {
            "schema": SCHEMA,
            "version": __version__,
            "number": number,
            "sensors": [
                {
                    "key": s.key,
                    "kind": s.kind,
                    "file": names[s.key],
                    "files": [
                        [str(file.file), by in file.partition, places[file.file]] for file, _ in s.files
                    ],
                }
                for s in group
            ],
            "job": dict(job),
        }
        for number, group in enumerate(groups)
    ]


def digest(data: Any) -> str:
    """SHA-256 of plain data."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
