"""Noises in the posterior: every likely hypothesis on the mean, beside each noise."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import UNKNOWN
from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.inference.innovation import innovation
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.posterior import PRIOR
from echocal.diagnose.noises import (
    correlated_noise,
    cycle_slip,
    noise_growth,
    polling_jitter,
    reference_error,
)
from echocal.diagnose.noises.trace import Likelihood, Trace

__all__ = ["GUARDS", "SHAPES", "NoiseShares", "weigh_noises"]

Ids = tuple[str, ...]
Matrix = NDArray[np.floating[Any]]


class Shape(Protocol):
    """A module of a noise with a likelihood of its own."""

    FACTS: CauseFacts

    def fit(self, trace: Trace) -> Likelihood | None:
        """Fit it to what a hypothesis leaves."""


class Guard(Protocol):
    """A module of a noise that the engine guards against."""

    FACTS: CauseFacts

    def of(self, noise: Noise, /) -> bool:
        """Whether a noise of the guards is this cause."""

    def parameters(
        self, noises: tuple[Noise, ...], share: Matrix, variance: float, /
    ) -> dict[str, tuple[float, float]]:
        """Mean and spread of its parameters, given the probability of each noise."""


SHAPES: tuple[Shape, ...] = (noise_growth, cycle_slip, polling_jitter)
"""Noises that exclude each other: each is a whole likelihood of what the causes leave."""

GUARDS: tuple[Guard, ...] = (correlated_noise, reference_error)
"""Noises that every hypothesis reckons with anyhow."""

_SETS = 4  # most probable sets of causes that noises are tried beside
_WINDOWS, _WINDOW = 5, 1000  # rows that the likelihoods look at, in stretches
_STEPPED = {  # noises that steps of a column make by themselves
    "reading_quantization": {"cycle_slip", "polling_jitter"},
    "timer_quantization": {"cycle_slip", "polling_jitter"},
    "temperature_quantization": {"noise_growth"},
}


@dataclass
class NoiseShares:
    """What the noises are beside each set of causes.

    Attributes
    ----------
    weighed : list of Weighed
        The hypotheses with their evidence under every noise, most probable first.
    shapes : dict
        Per evaluated set of causes: probability of each of `SHAPES` given the set.
    guards : dict
        Per set of causes: probability of each of `GUARDS` given the set.
    fits : dict
        Per evaluated set of causes: the fitted likelihoods.
    """

    weighed: list[Weighed]
    shapes: dict[Ids, dict[str, float]] = field(default_factory=dict)
    guards: dict[Ids, dict[str, float]] = field(default_factory=dict)
    fits: dict[Ids, dict[str, Likelihood]] = field(default_factory=dict)

    def shape_of(self, ids: Ids) -> Mapping[str, float]:
        """Probabilities of `SHAPES` beside a set; those of the likeliest set where not evaluated."""
        return self.shapes.get(ids) or next(iter(self.shapes.values()), {})

    def guard_of(self, ids: Ids) -> Mapping[str, float]:
        """Probabilities of `GUARDS` beside a set."""
        return self.guards.get(ids, {})

    def fit_of(self, id_: str) -> Likelihood | None:
        """Fit of a noise beside the likeliest set that has one."""
        return next((fits[id_] for fits in self.fits.values() if id_ in fits), None)


def weigh_noises(case: Case, weighed: list[Weighed], carried: Stack, steps: Collection[str]) -> NoiseShares:
    """Weigh the likeliest sets of causes, and none, beside each noise.

    Parameters
    ----------
    case : Case
    weighed : list of Weighed
        Hypotheses on the mean under normal noise with its guards.
    carried : Stack
        The guards that were carried along.
    steps : collection of str
        Quantizations found before; what they imitate is not looked for.

    Returns
    -------
    NoiseShares
    """
    weighed = _with_nothing(case, weighed, carried)
    best: dict[Ids, Weighed] = {}
    for one in weighed:
        best.setdefault(one.hypothesis.ids, one)
    chosen = list(best)[:_SETS] + [ids for ids in [()] if ids not in list(best)[:_SETS]]
    skipped = set().union(*(_STEPPED.get(step, set()) for step in steps))
    shapes = [shape for shape in SHAPES if shape.FACTS.id not in skipped]
    gains: dict[Ids, float] = {}
    shares = NoiseShares([])
    rows = _looked_at(case)
    for ids in chosen:
        gains[ids], shares.shapes[ids], shares.fits[ids] = _beside(case, best[ids], carried, rows, shapes)
    least = min(gains.values())
    shares.weighed = sorted(
        (w.raised(gains.get(w.hypothesis.ids, least)) for w in weighed),
        key=lambda w: -w.log_posterior,
    )
    order = list(dict.fromkeys(w.hypothesis.ids for w in shares.weighed))
    shares.shapes = {ids: shares.shapes[ids] for ids in order if ids in shares.shapes}
    shares.fits = {ids: shares.fits[ids] for ids in order if ids in shares.fits}
    stakes = [_Stake.of(guard, case, carried) for guard in GUARDS]
    for ids in order:
        shares.guards[ids] = _guards(best[ids], stakes, shares.shape_of(ids))
    _doubt(shares, stakes)
    return shares


def _with_nothing(case: Case, weighed: list[Weighed], carried: Stack) -> list[Weighed]:
    """Nothing but noise competes, however unlikely it is while the noise is normal."""
    if any(not w.hypothesis.variants for w in weighed):
        return weighed
    shapes = any(v.cause == UNKNOWN for v in case.found.variants)
    prior = PRIOR["nothing"] * ((1 - PRIOR[UNKNOWN]) if shapes else 1.0)
    return [*weighed, weigh(Hypothesis((), prior), carried)]


def _looked_at(case: Case) -> NDArray[np.int64]:
    """Rows that fits may see, in stretches where there are many."""
    rows = np.flatnonzero(case.folds.fit[case.folds.blocks])
    if len(rows) <= _WINDOWS * _WINDOW:
        return rows
    firsts = np.linspace(0, len(rows) - _WINDOW, _WINDOWS).astype(np.int64)
    return np.concatenate([rows[first : first + _WINDOW] for first in firsts])


def _beside(
    case: Case,
    weighed: Weighed,
    carried: Stack,
    rows: NDArray[np.int64],
    shapes: Collection[Shape],
) -> tuple[float, dict[str, float], dict[str, Likelihood]]:
    """What the noises add to the log evidence of a hypothesis, their shares, and their fits."""
    trace = _trace(case, weighed, carried.likeliest(weighed)[0], rows)
    fits = {shape.FACTS.id: fitted for shape in shapes if (fitted := shape.fit(trace)) is not None}
    prior = {shape.FACTS.id: shape.FACTS.prior for shape in shapes}
    logs = {"": float(np.log1p(-sum(prior.values())))}
    logs |= {id_: float(np.log(prior[id_])) + fitted.log - trace.plain for id_, fitted in fits.items()}
    total = float(np.logaddexp.reduce(list(logs.values())))
    return total, {id_: float(np.exp(log - total)) for id_, log in logs.items() if id_}, fits


def _trace(case: Case, weighed: Weighed, noise: Noise, rows: NDArray[np.int64]) -> Trace:
    left = case.left(weighed, rows)
    order = case.sums.order.at(rows)
    groups = order.groups
    flat = case.sums.flat_level
    if flat:  # each stretch has a level of its own
        left -= (np.bincount(groups, left) / np.maximum(np.bincount(groups), 1))[groups]
    conditions = {name: column[rows] for name, column in case.table.conditions.items()}
    return Trace(
        left=left,
        innovation=innovation(left, order, noise),
        distance=order.distance,
        speed=case.base.indication(np.full(len(rows), 2.0), conditions),
        stretch=_stretches(case, rows),
        free_mean=flat or bool(weighed.hypothesis.variants),
    )


def _stretches(case: Case, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number the runs of rows whose target did not move."""
    new = np.zeros(len(rows), dtype=bool)
    new[1:] = np.diff(case.table.groups[rows]) != 0
    if case.table.reference is not None:
        new[1:] |= np.diff(case.table.reference[rows]) != 0
    return np.cumsum(new)


@dataclass(frozen=True)
class _Stake:
    """A guard, its probability before the data, and which of the noises carried along it is."""

    facts: CauseFacts
    before: float
    concerned: NDArray[np.bool_]

    @classmethod
    def of(cls, guard: Guard, case: Case, carried: Stack) -> "_Stake":
        before = sum(noise.prior for noise in case.usual_noises if guard.of(noise))
        return cls(guard.FACTS, before, np.array([guard.of(noise) for noise in carried.noises]))


def _doubt(shares: NoiseShares, stakes: Collection[_Stake]) -> None:
    """Lower the guards' probabilities to what a sceptic gives the name.

    To be on the safe side the means are weighed as if every other table had such noise. A name is
    believed only if it stands without that: the mean causes under plain noise are its rivals.
    """
    log = np.array([w.log_posterior for w in shares.weighed])
    total = np.exp(log - log.max())
    for stake in stakes:
        id_, before, concerned = stake.facts.id, stake.before, stake.concerned
        if not concerned.any() or before >= 1.0:
            continue
        part = np.array([w.noise[concerned].sum() for w in shares.weighed])
        with_it = float(total @ part) / before * stake.facts.prior
        without = float(total @ (1 - part)) / (1 - before) * (1 - stake.facts.prior)
        believed = with_it / max(with_it + without, 1e-300)
        given = np.array([shares.guard_of(w.hypothesis.ids).get(id_, 0.0) for w in shares.weighed])
        usual = float(total @ given) / float(total.sum())
        factor = min(believed / max(usual, 1e-12), 1.0)
        for found in shares.guards.values():
            if id_ in found:
                found[id_] *= factor


def _guards(weighed: Weighed, stakes: Collection[_Stake], shapes: Mapping[str, float]) -> dict[str, float]:
    """Probability that noise with memory, or an error per stand, is there and not only guarded against."""
    mixed = shapes.get("cycle_slip", 0.0) + shapes.get("polling_jitter", 0.0)  # weighed without the guards
    found = {}
    for stake in stakes:
        before, prior = stake.before, stake.facts.prior
        if before in (0.0, 1.0):
            continue
        share = float(weighed.noise[stake.concerned].sum())
        odds = share * (1 - before) / max((1 - share) * before, 1e-12)
        odds *= prior / (1 - prior)
        found[stake.facts.id] = odds / (1 + odds) * (1 - min(mixed, 1.0))
    return found
