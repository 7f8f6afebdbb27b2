"""Fresh cases: what is planted, how large, in which design, under which noise."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import brentq

from hidden_effects import designs, disturbance
from hidden_effects.causes import CAUSES
from hidden_effects.designs import Rows
from hidden_effects.log import Log
from hidden_effects.unknown import UNKNOWN
from hidden_effects.world import COLUMNS, World

Column = NDArray[np.float64]

STRATA = ("null", "prior", "wild", "power5", "power8", "pair", "unknown", "other", "missing")
"""Nothing; sizes by the catalogue's priors; sizes by an snr that no prior knows; snr sqrt(N) of 5
and of 8; two causes; an effect outside the catalogue; noise, row and gross causes; causes of the
catalogue that the engine does not have."""

_ROWS, _SHAPE, _SIZE, _NOISE, _LOG, _ELSEWHERE = range(6)  # streams of random numbers of a case
_POWER = {"power5": 5.0, "power8": 8.0}


@dataclass(frozen=True)
class Spec:
    """Everything that a case is made from; the same spec is the same case."""

    design: str
    stratum: str
    causes: tuple[str, ...]
    noise: str
    tape: float
    seed: int

    def stream(self, which: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, which])


@dataclass(frozen=True)
class Case:
    """A table with what is hidden in it.

    Attributes
    ----------
    spec : Spec
    rows : Rows
    sizes : mapping of str to float
        In units of the catalogue's usual magnitude; snr where there is none.
    shift : ndarray
        What is wrong with the readings, without noise [m].
    table : DataFrame
    """

    spec: Spec
    rows: Rows
    sizes: Mapping[str, float]
    shift: Column
    table: pd.DataFrame

    @property
    def snr(self) -> float:
        """Root mean square of the effect over the shot noise."""
        return float(np.sqrt(np.mean(self.shift**2)) / disturbance.SHOT)


def planted(rows: Rows, sizes: Mapping[str, float], seed: int) -> World:
    """Nature and device with these mean causes; the same seed gives the same shapes anywhere."""
    world = World(rows)
    for id_, size in sizes.items():
        if CAUSES[id_].kind == "mean":
            CAUSES[id_].plant(world, size, np.random.default_rng([seed, _SHAPE, *id_.encode()]))
    return world


def rms(rows: Rows, id_: str, size: float, seed: int) -> float:
    """Size of one mean cause [m]."""
    return float(np.sqrt(np.mean(planted(rows, {id_: size}, seed).shift() ** 2)))


def by_snr(rows: Rows, id_: str, snr: float, seed: int) -> float:
    """Size at which a cause has this snr, or the largest that nature allows."""
    target = snr * disturbance.SHOT
    high = min(CAUSES[id_].most, 1e3)
    if rms(rows, id_, high, seed) <= target:
        return high
    if rms(rows, id_, np.exp(-9.0), seed) >= target:
        return float(np.exp(-9.0))
    return float(
        np.exp(brentq(lambda x: rms(rows, id_, np.exp(x), seed) - target, -9.0, np.log(high), rtol=1e-3))
    )


def _size(spec: Spec, rows: Rows, id_: str, random: np.random.Generator) -> float:
    cause = CAUSES[id_]
    if cause.size == "fixed":
        return 1.0
    sign = random.choice([-1.0, 1.0]) if cause.size == "signed" else 1.0
    if spec.stratum == "prior" or cause.kind != "mean":
        return sign * min(abs(random.normal()) * random.choice([1 / 3, 1.0, 3.0]), cause.most)
    if spec.stratum in _POWER:
        snr = _POWER[spec.stratum] / np.sqrt(len(rows))
    else:
        snr = np.exp(random.uniform(np.log(1.0 if spec.stratum == "pair" else 0.25), np.log(8.0)))
    return float(sign * by_snr(rows, id_, snr, spec.seed))


def build(spec: Spec) -> Case:
    """Make the case."""
    rows = designs.DESIGNS[spec.design](spec.stream(_ROWS))
    random = spec.stream(_SIZE)
    known = [id_ for id_ in spec.causes if id_ in CAUSES]
    sizes = {id_: _size(spec, rows, id_, random) for id_ in known}
    world = planted(rows, sizes, spec.seed)
    for id_ in set(spec.causes) - set(known):
        shape = UNKNOWN[id_][0](rows, spec.stream(_SHAPE))
        sizes[id_] = float(np.exp(random.uniform(np.log(0.4), np.log(8.0))))
        world.added = world.added + sizes[id_] * disturbance.SHOT * (shape - shape.mean()) / shape.std()
    shift = world.shift()
    noisy = spec.stream(_NOISE)
    reading = world.reading() + disturbance.NOISES[spec.noise](rows, noisy)
    log = Log(world, reading, world.recorded.copy())
    for id_ in known:
        if CAUSES[id_].kind != "mean":
            CAUSES[id_].plant(log, sizes[id_], spec.stream(_LOG))
    needed = set().union(*(CAUSES[id_].shows for id_ in known))
    shown = {name for name in COLUMNS if noisy.random() < 0.3 and rows.design == "c"} | needed
    table = log.table(shown, world.reference + disturbance.tape(rows, noisy, spec.tape))
    return Case(spec, rows, sizes, shift, table)


def again(case: Case, where: str) -> tuple[pd.DataFrame, Column] | None:
    """The same error in a new campaign, noise-free: its table and the true reference [m].

    None for what has no meaning elsewhere (an error of these stands, a creep of this mount).
    """
    causes = [CAUSES.get(id_) for id_ in case.spec.causes]
    if not all(cause is not None and cause.kind == "mean" and cause.repeats for cause in causes):
        return None
    rows = case.rows if where == "same" else designs.elsewhere(case.spec.stream(_ELSEWHERE))
    world = planted(rows, case.sizes, case.spec.seed)
    quiet = Rows(**{**rows.__dict__, "design": case.spec.design})
    world.rows = quiet
    shown = set().union(*(cause.shows for cause in causes if cause is not None))
    return world.table(world.reading(), shown), world.reference
