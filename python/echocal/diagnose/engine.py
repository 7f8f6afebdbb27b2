"""From a table to a diagnosis."""

from __future__ import annotations

import time
import warnings
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from echocal.diagnose.experiment_design.ranges import checked_ranges
from echocal.diagnose.faults import find_faults
from echocal.diagnose.inference.case import examine
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.scene import prepare, refuse_distance
from echocal.diagnose.preprocess.window import between, held_out
from echocal.diagnose.progress import Progress, Steps
from echocal.diagnose.results.level_steps import further_step
from echocal.diagnose.results.result import Diagnosis
from echocal.diagnose.verdict import conclude
from echocal.errors import DataError, DomainWarning, EchocalError, UsageError
from echocal.model import Model
from echocal.observations import Observations, read_observations
from echocal.observations.plan import EVERYTHING

__all__ = ["diagnose"]

_MOST_STEPS = 6  # that the evidence finds beside those that anybody sees


def diagnose(
    observations: Any,
    *,
    base: str | float | Model = "linear",
    reference_distance: float | None = None,
    constant_distance: bool = False,
    columns: Mapping[str, str] | str | Path | None = None,
    reading_speed: str | float | None = None,
    missing: Collection[Any] | Mapping[str, Any] = (),
    since: str | None = None,
    until: str | None = None,
    hold_out_after: str | float | None = None,
    can_vary: Mapping[str, Sequence[float]] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    **table: Any,
) -> Diagnosis:
    """Name what a base simulation gets wrong about a table of echoes.

    Every effect that the table could show, every pair and the best triples compete with
    "nothing" and with smooth shapes that have no cause, by the evidence of their columns. Noise
    with memory and an error per stand are reckoned with before anything is named. The gain is
    measured on rows that no parameter was fitted to.

    Parameters
    ----------
    observations : Observations, path, DataFrame, or mapping of str to array_like
        What is no `Observations` yet goes through `echocal.read_observations`.
    base : str, float or Model
        The base simulation: a law (``"linear"``), an expression, a fixed speed (``"343"``: a
        reading is taken for the distance), or a model.
    reference_distance : float, optional
        Distance of the target in every row [m], where the table has no column for it.
    constant_distance : bool
        The target never moved but its distance is not known: the level is found, stretch by
        stretch.
    columns, missing
        Passed to `echocal.read_observations`.
    reading_speed : str or float, optional
        Speed that the device made its readings with; default: the base.
    since, until : str, optional
        Use only rows from and up to these times, ISO 8601; a date means its whole day.
    hold_out_after : str or float, optional
        Rows from this time on are held out from everything: ISO 8601, or seconds since the first
        row. Default: folds take turns.
    can_vary : mapping of str to (float, float), optional
        What can be varied for the next measurements, and how far: ``{"distance": (0.2, 4.0),
        "temperature": (5.0, 40.0)}`` in m and degC; names are those of recorded conditions.
    seed : int
        Seed of the resampling behind the interval of the gain, not negative.
    progress : callable, optional
        Called as each stage begins, with what it does, the number of stages done and their number.
    **table
        Further arguments of `echocal.read_observations`: ``trust``, ``time_zone``, ...

    Returns
    -------
    Diagnosis

    Raises
    ------
    DataError
        If the table cannot be read or has too few usable rows.
    UsageError
        If a request contradicts itself or the table.

    Examples
    --------
    A device that forgets the temperature, a meter and a half from a wall:

    >>> import numpy as np
    >>> import echocal
    >>> temperature = np.linspace(0.0, 40.0, 60)
    >>> noise = np.random.default_rng(1).normal(0.0, 1e-3, 60)
    >>> reading = 1.5 * 343.0 / (331.4 + 0.6 * temperature) + noise
    >>> table = {"reading_m": reading, "temperature_C": temperature}
    >>> diagnosis = echocal.diagnose(table, reference_distance=1.5)
    >>> diagnosis.verdict, diagnosis.causes[0].id
    ('named', 'fixed_speed')
    """
    start = time.perf_counter()
    simulated = Base.of(base)
    refuse_distance(reference_distance)
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        message = f"seed is {seed!r}; give an integer of 0 or more"
        raise UsageError(message)
    strange: DataError | None = None
    work = Steps(progress)
    work.begin("reading")
    if isinstance(observations, Observations):
        _refuse_late({"columns": columns, "reading_speed": reading_speed, "missing": missing, **table})
    else:
        law = reading_speed or (
            simulated.law if simulated.device_speed is None else str(simulated.device_speed)
        )
        table = {"columns": columns, "reading_speed": law, "missing": missing, **table}
        observations, strange = _read(observations, table)
    observations = between(observations, since, until)
    with warnings.catch_warnings(action="ignore", category=DomainWarning):  # the final model's is a note
        work.begin("looking for faults")
        faults = find_faults(observations, simulated, reference_distance, constant_distance)
        explained = any(f.facts.kind == "gross" for f in faults.accepted)
        if strange is not None and not (explained and faults.observations.usable.any()):
            raise strange
        observations = faults.observations
        ranges = None if can_vary is None else checked_ranges(can_vary, list(observations.conditions))
        steps: list[int] = []
        while True:
            work.begin("building columns")
            ready = prepare(observations, simulated, reference_distance, constant_distance, steps)
            folds = Folds.of(ready, *held_out(observations, ready, hold_out_after))
            case = examine(ready, simulated, folds, int(seed))
            diagnosis = conclude(case, observations, faults, ranges, start, work)
            row = further_step(ready, diagnosis)
            if row is None or len(steps) == _MOST_STEPS:
                work.end()
                return diagnosis
            steps.append(row)
            work.level_steps = len(steps)


def _read(source: Any, table: Mapping[str, Any]) -> tuple[Observations, DataError | None]:
    """Read a table; one that is refused for its values is read as it stands, with the refusal.

    A column in another unit is a cause like others: where a fault explains it, it is named.
    """
    try:
        return read_observations(source, **table), None
    except DataError as refusal:
        try:
            with warnings.catch_warnings(action="ignore"):  # the refusal says it all
                return read_observations(source, **{**table, "trust": (EVERYTHING,)}), refusal
        except EchocalError:
            raise refusal from None


def _refuse_late(given: Mapping[str, Any]) -> None:
    """Refuse what only concerns the reading of a table that is read already."""
    late = next((name for name, value in given.items() if value), None)
    if late:
        message = f"{late} concerns the reading of a table; pass it to read_observations, which made these"
        raise UsageError(message)
