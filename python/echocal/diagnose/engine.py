"""`echocal.diagnose`: the arguments, and what they mean."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from echocal.diagnose.pipeline import run
from echocal.diagnose.preprocess.plateaus import distances_of, placed
from echocal.diagnose.preprocess.presumed import presume
from echocal.diagnose.preprocess.reading import Reading, read
from echocal.diagnose.progress import Progress, Steps
from echocal.diagnose.request import Request
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.results.presumed import without_presumed
from echocal.diagnose.results.stated import with_stated
from echocal.diagnose.settings import Settings
from echocal.errors import UsageError
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.given import READ_OPTIONS, refuse_keywords
from echocal.observations.misspelled import naming

__all__ = ["diagnose"]


def diagnose(
    observations: Any,
    *,
    base: str | float | Model = "linear",
    reference_distance: float | None = None,
    constant_distance: bool = False,
    placements: Sequence[float] | str | None = None,
    columns: Mapping[str, str] | str | Path | None = None,
    reading_speed: str | float | None = None,
    missing: Collection[Any] | Mapping[str, Any] = (),
    since: str | None = None,
    until: str | None = None,
    hold_out_after: str | float | None = None,
    can_vary: Mapping[str, Sequence[float]] | None = None,
    matters_mm: float | None = None,
    seed: int = 0,
    settings: Settings | Mapping[str, Mapping[str, Any]] | None = None,
    progress: Progress | None = None,
    **table: Any,
) -> Diagnosis:
    """Name what a base simulation gets wrong about a table of echoes.

    Hypotheses are compared by their posterior probabilities: no effect, each effect that the table
    can show, each pair of effects, the best larger sets, and unexplained terms, which are smooth
    functions without a cause (docs/method.md). Every hypothesis includes autocorrelated noise and
    an error per station. The gain is measured on cross-validated or held-out rows.

    Parameters
    ----------
    observations : Observations, path, DataFrame, or mapping of str to array_like
        Everything but `Observations` is read with `echocal.read_observations`.
    base : str, float or Model
        The base simulation: a law (``"linear"``), an expression, a fixed speed (``"343"``: the
        reading itself is the predicted distance), or a model.
    reference_distance : float, optional
        Distance of the target in every row [m], where the table has no column for it.
    constant_distance : bool
        The target did not move, but its distance is not known. The level is then estimated, for
        each segment between two steps of the level.
    placements : sequence of float or str, optional
        Distances [m], or ``"0.5,1.2,2.5"``, of a raw log in which the target was placed several times, in
        their order: each plateau of the readings gets one of them. Rows between two plateaus are left out.
    columns, missing
        Passed to `echocal.read_observations`.
    reading_speed : str or float, optional
        Speed of sound that the device converts with; default: that of the base.
    since, until : str, optional
        Use only rows from and up to these times, ISO 8601; a date means its whole day.
    hold_out_after : str or float, optional
        Rows from this time on are held out: causes are selected and fitted without them. ISO 8601,
        or seconds since the first row. Default: a cross-validation.
    can_vary : mapping of str to (float, float), optional
        Conditions that can be varied for the next measurements, with their ranges:
        ``{"distance": (0.2, 4.0), "temperature": (5.0, 40.0)}`` in m and degC. The names are those
        of recorded conditions.
    matters_mm : float, optional
        The difference of a reading from which on it matters to you [mm]. An effect that adds less to every
        reading is told in one line; where all do, the verdict is told as "good enough". It changes no
        probability and no model. Default: what the resolution of the readings or the datasheet of an
        HC-SR04 makes of it; `Diagnosis.matters_mm` and `Diagnosis.matters_because` say what.
    seed : int
        Seed of the resampling for the interval of the gain, not negative.
    settings : Settings or mapping, optional
        Other values of the numbers that decide a verdict, by group and name, as a diagnosis records
        them: ``{"claims": {"named": 0.95}}``. `echocal.diagnose.settings` lists all.
    progress : callable, optional
        Called as each stage begins, with its name, the number of stages done and the number of all
        stages.
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
    A device that ignores the temperature, 1.5 m from a wall:

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
    refuse_keywords(diagnose, table, READ_OPTIONS)
    request = Request.of(
        base,
        seed,
        settings,
        reference_distance=reference_distance,
        constant_distance=constant_distance,
        since=since,
        until=until,
        hold_out_after=hold_out_after,
        can_vary=can_vary,
        matters_mm=matters_mm,
    )
    work = Steps(progress)
    work.begin("reading")
    how: dict[str, Any] = {"columns": columns, "reading_speed": reading_speed, "missing": missing, **table}
    if not isinstance(observations, Observations):
        how["reading_speed"] = request.base.reading_speed if reading_speed is None else reading_speed
    reading = read(observations, how)
    if placements is not None:
        if reference_distance is not None or constant_distance:
            raise UsageError("give placements, a reference distance, or constant_distance: only one of them")
        own = placed(reading.observations, distances_of(placements))
        reading = replace(reading, observations=own)
    simulated, rest = presume(request.base, reading.observations)
    read_columns = [*rest.source_names.values(), *rest.extra]
    with naming(read_columns):
        diagnosis = run(replace(reading, observations=rest), replace(request, base=simulated), work)
    diagnosis = without_presumed(diagnosis, simulated.presumed)
    if reading.observations.stated:
        diagnosis = with_stated(
            diagnosis,
            reading.observations,
            {one.quantity: id_ for id_, one in simulated.presumed.items()},
            lambda other: run(Reading(other), request, Steps(None)),
        )
    return replace(diagnosis, seconds=time.perf_counter() - start)
