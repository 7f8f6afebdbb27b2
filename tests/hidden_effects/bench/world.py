"""Tables of the virtual bench, each with its pair: the same air, places and noise without the cause."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import echocal
from echocal.correct import correct_table
from echocal.virtual_bench import CAUSES, Simulation, simulate

Column = NDArray[np.float64]

STRATA = ("null", "single", "pair", "unknown", "mistake")
"""Nothing; one cause of the catalogue; two; one that it does not have; a mistake of firmware or logger."""

DETECTORS = ("ideal", "comparator")
PLACEMENTS = ("bench", "quick", "classroom", "far_and_near", "round_robin", "robot")
LOGS = ("outdoor", "warehouse", "daily", "tank", "snow")
"""Designs of the bench by kind: readings in bursts at known places, or hour by hour."""

_REPLICATE = 1


@dataclass(frozen=True)
class Spec:
    """Everything that a table is made from; the same spec is the same table."""

    design: str
    stratum: str
    causes: tuple[str, ...]
    detector: str
    seed: int

    @property
    def sizes(self) -> dict[str, float]:
        """Usual sizes, in the units of the bench."""
        return {
            id_: CAUSES[id_].draw(np.random.default_rng([self.seed, *id_.encode()])) for id_ in self.causes
        }


@dataclass(frozen=True)
class Case:
    """A table and all that is true about it.

    Attributes
    ----------
    spec : Spec
    made : Simulation
        With the causes.
    """

    spec: Spec
    made: Simulation

    @cached_property
    def options(self) -> dict[str, Any]:
        """What a user tells the diagnosis beside the table."""
        return options(self.made)

    @cached_property
    def without(self) -> Simulation:
        """The same campaign without the causes."""
        return bare(self.spec, self.neutral)

    @property
    def neutral(self) -> str:
        """Detector of the pair: a time walk that is itself the cause is not there without it."""
        return "ideal" if "amplitude_walk" in self.spec.causes else self.made.detector

    @cached_property
    def ideal(self) -> Simulation:
        """The same campaign without the causes and without time walk."""
        return self.without if self.neutral == "ideal" else bare(self.spec, "ideal")

    @cached_property
    def again(self) -> Simulation:
        """Another campaign of the same sensor at the same places, with the same causes."""
        spec = self.spec
        return simulate(spec.design, spec.sizes, seed=spec.seed, detector=spec.detector, replicate=_REPLICATE)


def build(spec: Spec) -> Case:
    """Make the case."""
    return Case(spec, bare(spec, spec.detector, spec.sizes))


@lru_cache(maxsize=128)
def _campaign(design: str, seed: int, detector: str, causes: tuple[tuple[str, float], ...]) -> Simulation:
    return simulate(design, dict(causes), seed=seed, detector=detector)


def bare(spec: Spec, detector: str, causes: Mapping[str, float] | None = None) -> Simulation:
    """The campaign of a spec with other causes, or none."""
    return _campaign(spec.design, spec.seed, detector, tuple((causes or {}).items()))


def options(made: Simulation) -> dict[str, Any]:
    """What a user tells beside a table.

    Cramer's law where the echo time and the humidity are recorded: it is the law that uses both, and with
    the linear law of dry air every table would have the humidity as a true cause. A reading that the device
    computed is taken as it is, with the default base: of a mistake in the device's arithmetic the user does
    not know. All readings of the bench in cm come from such mistakes.
    """
    law = "cramer" if {"echo_us", "humidity_percent"} <= set(made.table) else "linear"
    return {"base": law, "constant_distance": True} if made.campaign.unknown_constant else {"base": law}


def indicated(table: pd.DataFrame, model: echocal.Model) -> Column:
    """Distance by a model [m]."""
    with warnings.catch_warnings(action="ignore"):
        outcome = correct_table(table, model, mark_rows=False)
    return np.asarray(outcome.table["corrected_distance_m"], dtype=float)


def error(made: Simulation, model: echocal.Model | None = None) -> Column:
    """Error of indication as the diagnosis sees it [m]: of the base, or of a model.

    Where the user only knows that the distance is constant, its mean is taken away.
    """
    found = indicated(made.table, model or echocal.Model(options(made)["base"]))
    if "distance_m" in made.table:
        return np.asarray(found - made.table["distance_m"].to_numpy(dtype=float))
    return np.asarray(found - np.nanmean(found))


def signal(case: Case) -> Column:
    """What the causes of a case add to the error of indication [m]; NaN where either table has no echo."""
    return error(case.made) - error(case.without)


def signal_of(case: Case, id_: str) -> Column:
    """The same for one of its causes, staged alone."""
    if len(case.spec.causes) == 1:
        return signal(case)
    alone = bare(case.spec, case.spec.detector, {id_: case.spec.sizes[id_]})
    return error(alone) - error(bare(case.spec, alone.detector))
