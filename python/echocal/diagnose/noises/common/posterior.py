"""Noises in the posterior: every likely hypothesis on the mean, beside each noise."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.innovation import innovation
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.inference.posterior import core_prior
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.kinds import FittedNoise, NuisanceNoise
from echocal.diagnose.noises.common.trace import Likelihood, Trace
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings.noises import NoiseSettings

__all__ = ["NoisePosterior", "Traced", "infer_noises", "sampled"]

Ids = tuple[str, ...]

_NOTHING = 1.0 + 1e-9  # of the smallest variance
_SEGMENTS, _SEGMENT_ROWS = 5, 1000  # pieces of a long table that the likelihoods use, and their rows
_SETS_ALIKE = 40  # further sets with noises of another set: more than a class has members
_SAME_EVIDENCE = 0.5  # log evidence; odds of 1.6 decide nothing


@dataclass
class NoisePosterior:
    """What the noises are beside each set of causes.

    Attributes
    ----------
    fits : list of HypothesisFit
        The hypotheses with their evidence under every noise, most probable first.
    fitted : dict
        Per evaluated set of causes: probability of each fitted noise given the set.
    nuisances : dict
        Per set of causes: probability of each nuisance noise given the set.
    likelihoods : dict
        Per evaluated set of causes: the fitted likelihoods.
    """

    fits: list[HypothesisFit]
    fitted: dict[Ids, dict[str, float]] = field(default_factory=dict)
    nuisances: dict[Ids, dict[str, float]] = field(default_factory=dict)
    likelihoods: dict[Ids, dict[str, Likelihood]] = field(default_factory=dict)

    def fitted_of(self, ids: Ids) -> Mapping[str, float]:
        """Probabilities of the fitted noises beside a set; those of the likeliest set where not evaluated."""
        return self.fitted.get(ids) or next(iter(self.fitted.values()), {})

    def nuisance_of(self, ids: Ids) -> Mapping[str, float]:
        """Probabilities of the nuisance noises beside a set."""
        return self.nuisances.get(ids, {})

    def possible(self, least: float) -> tuple[FittedNoise, ...]:
        """Fitted noises that are not improbable beside every evaluated set."""
        sets = self.fitted.values()
        return tuple(n for n in registry.fitted() if any(one.get(n.facts.id, 0.0) >= least for one in sets))

    def probability(self, id_: str) -> float:
        """Probability of a fitted noise, over all sets."""
        log = np.array([one.log_posterior for one in self.fits])
        part = np.array([self.fitted_of(one.hypothesis.ids).get(id_, 0.0) for one in self.fits])
        weight = np.exp(log - log.max())
        return float(weight @ part / weight.sum())

    def fit_of(self, id_: str) -> Likelihood | None:
        """Fit of a noise beside the likeliest set that has one."""
        return next(
            (likelihoods[id_] for likelihoods in self.likelihoods.values() if id_ in likelihoods), None
        )


def infer_noises(
    case: Case,
    fits: list[HypothesisFit],
    reduced: Stack,
    tried: Collection[FittedNoise],
) -> NoisePosterior:
    """Fit the likeliest sets of causes, and none, beside each noise.

    Parameters
    ----------
    case : Case
    fits : list of HypothesisFit
        Hypotheses on the mean under normal noise with the nuisance noises.
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.
    tried : collection of FittedNoise
        Noises that compete.
    """
    settings = case.settings.noises
    fits = _with_nothing(case, fits, reduced)
    best: dict[Ids, HypothesisFit] = {}
    for one in fits:
        best.setdefault(one.hypothesis.ids, one)
    chosen = list(best)[: settings.sets]
    chosen += [ids for ids in [()] if ids not in chosen]
    gains: dict[Ids, float] = {}
    shares = NoisePosterior([])
    traced = Traced.of(case, sampled(case.row_folds, settings))
    for ids in chosen:
        trace = traced.left_by(best[ids], reduced.likeliest(best[ids])[0])
        gains[ids], shares.fitted[ids], shares.likelihoods[ids] = _beside(trace, tried, settings)
    gains |= _gains_alike(traced, best, gains, settings)
    least = min(gains.values())
    shares.fits = sorted(
        (w.raised(gains.get(w.hypothesis.ids, least)) for w in fits),
        key=lambda w: -w.log_posterior,
    )
    order = list(dict.fromkeys(w.hypothesis.ids for w in shares.fits))
    shares.fitted = {ids: shares.fitted[ids] for ids in order if ids in shares.fitted}
    shares.likelihoods = {ids: shares.likelihoods[ids] for ids in order if ids in shares.likelihoods}
    there = [noise for noise in registry.nuisances() if not (noise.of_stations and case.at_levels)]
    nuisances = [_NuisancePrior.of(noise, case, reduced, settings) for noise in there]
    mixed = [noise.facts.id for noise in registry.fitted() if not noise.removes_nuisance]
    fitted = [shares.fitted_of(ids) for ids in order]  # of these, some compete with the nuisance noises
    competing = np.array([sum(one.get(id_, 0.0) for id_ in mixed) for one in fitted])
    shares.nuisances = dict(
        zip(order, _nuisances([best[i] for i in order], nuisances, competing), strict=True)
    )
    _doubt(shares, nuisances)
    return shares


def _gains_alike(
    traced: "Traced", best: Mapping[Ids, HypothesisFit], gains: Mapping[Ids, float], settings: NoiseSettings
) -> dict[Ids, float]:
    """Log evidence that the noises add beside further sets: that of the set with the nearest residual.

    A noise depends on a set through its residual alone, and sets that the data cannot separate leave the
    same one.
    """
    most, reach = max(gains.values()), settings.negligible_odds
    if most - min(gains.values()) < _SAME_EVIDENCE:
        return {}
    first = max(best[ids].log_posterior for ids in gains)
    least = max(best[ids].log_posterior + gain for ids, gain in gains.items()) - most - reach
    wanted = [ids for ids in best if ids not in gains and best[ids].log_posterior > least]
    probable = [gain for ids, gain in gains.items() if best[ids].log_posterior > first - reach]
    if (
        max(probable) - min(probable) < _SAME_EVIDENCE
    ):  # what fits about as well as these leaves about the same
        near = [ids for ids in wanted if best[ids].log_posterior > first - reach]
        return dict.fromkeys(near, min(probable))
    known = {ids: traced.case.left(best[ids], traced.units) for ids in gains}
    found = {}
    for ids in wanted[:_SETS_ALIKE]:
        left = traced.case.left(best[ids], traced.units)
        nearest = min(known, key=lambda other: float(np.sum((left - known[other]) ** 2)))
        found[ids] = gains[nearest]
    return found


def _with_nothing(case: Case, fits: list[HypothesisFit], reduced: Stack) -> list[HypothesisFit]:
    """Nothing but noise competes, however unlikely it is while the noise is normal."""
    if any(not w.hypothesis.variants for w in fits):
        return fits
    prior = core_prior(case.settings.priors).no_cause(bool(case.found.terms))
    return [*fits, fit_hypothesis(Hypothesis((), prior), reduced)]


def sampled(folds: Folds, settings: NoiseSettings) -> NDArray[np.int64]:
    """Rows, or units, that fits may see, in segments where there are many."""
    rows = np.flatnonzero(folds.fitted)
    count, length = _SEGMENTS, _SEGMENT_ROWS
    if len(rows) <= count * length:
        return rows
    firsts = np.linspace(0, len(rows) - length, count).astype(np.int64)
    return np.concatenate([rows[first : first + length] for first in firsts])


def _beside(
    trace: Trace, tried: Collection[FittedNoise], settings: NoiseSettings
) -> tuple[float, dict[str, float], dict[str, Likelihood]]:
    """What the noises add to the log evidence of a hypothesis, their shares, and their likelihoods.

    docs/method.md, Eq. 19.
    """
    either = {noise.facts.id: noise.fit(trace, settings) for noise in tried}
    likelihoods = {id_: fit for id_, fit in either.items() if fit is not None}
    prior = {noise.facts.id: settings.prior(noise.facts) for noise in tried}
    logs = {"": float(np.log1p(-sum(prior.values())))}
    logs |= {id_: float(np.log(prior[id_])) + fitted.log - trace.plain for id_, fitted in likelihoods.items()}
    total = float(np.logaddexp.reduce(list(logs.values())))
    return total, {id_: float(np.exp(log - total)) for id_, log in logs.items() if id_}, likelihoods


@dataclass(frozen=True)
class Traced:
    """Rows whose residuals are traced, and what is the same beside each hypothesis.

    Where units have several rows, only what a row is off its unit is traced: what the rows of a unit share
    counts once, and a noise of rows would count it in each.
    """

    case: Case
    units: NDArray[np.int64]
    unit: NDArray[np.int64]
    scatter: NDArray[np.float64]
    order: Order
    speed: NDArray[np.float64]
    segment: NDArray[np.int64]

    @classmethod
    def of(cls, case: Case, rows: NDArray[np.int64]) -> "Traced":
        """Rows of a case that are to be traced."""
        table = case.table
        conditions = {name: column[rows] for name, column in table.rows.conditions.items()}
        speed = case.base.indication(np.full(len(rows), 2.0), conditions)
        units, unit = np.unique(table.unit[rows], return_inverse=True)
        order, scatter = case.sums.order.at(units), table.deviation[rows]
        return cls(case, units, unit, scatter, order, speed, _segments(case, units)[unit])

    def left_by(self, fit: HypothesisFit, noise: Noise) -> Trace:
        """What a hypothesis leaves of the rows."""
        joined = self.case.table.members is not None
        left = self.scatter if joined else self.left_of_units(fit, noise)
        return Trace(
            left=left,
            innovation=left if joined else innovation(left, self.order, noise),
            distance=self.order.distance[self.unit],
            speed=self.speed,
            segment=self.segment,
            rounding=self.case.table.rounding,
            free_mean=joined or self.case.sums.flat_level or bool(fit.hypothesis.variants),
        )

    def left_of_units(self, fit: HypothesisFit, noise: Noise) -> NDArray[np.float64]:
        """What a hypothesis leaves of the units [m]."""
        left, groups = self.case.left(fit, self.units), self.order.groups
        if noise.slow_air:
            whole = self.case.left(fit, np.arange(len(self.case.table)))
            left -= self.case.slow_air_in(whole, self.case.folds.fit, noise)[self.units]
        if self.case.sums.flat_level:  # each segment has a level of its own
            left -= (np.bincount(groups, left) / np.maximum(np.bincount(groups), 1))[groups]
        return left


def _segments(case: Case, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number the runs of rows whose target did not move."""
    new = np.zeros(len(rows), dtype=bool)
    new[1:] = np.diff(case.table.groups[rows]) != 0
    if case.table.reference is not None:
        new[1:] |= np.diff(case.table.reference[rows]) != 0
    return np.cumsum(new)


@dataclass(frozen=True)
class _NuisancePrior:
    """A nuisance noise: its prior as a cause, and the prior in the fits.

    Attributes
    ----------
    prior : float
        Probability that a table has it.
    assumed : float
        Prior probability in the fits. It is higher, to avoid false alarms.
    concerned : ndarray of bool
        Noise models of the reduced stack that are this noise.
    """

    id: str
    prior: float
    assumed: float
    concerned: NDArray[np.bool_]

    @classmethod
    def of(
        cls, noise: NuisanceNoise, case: Case, reduced: Stack, settings: NoiseSettings
    ) -> "_NuisancePrior":
        assumed = sum(each.prior for each in case.usual_noises if noise.concerns(each))
        concerned = np.array([noise.concerns(each) for each in reduced.noises])
        return cls(noise.facts.id, settings.prior(noise.facts), assumed, concerned)

    def shares(self, fits: Sequence[HypothesisFit]) -> NDArray[np.float64]:
        """Probability beside each set; as before the data where it leaves less than any noise does."""
        found = np.array([fit.noise for fit in fits])[:, self.concerned].sum(axis=1)
        left = np.array([fit.variance for fit in fits])
        return np.where(left > _NOTHING * VARIANCE_FLOOR**2, found, self.assumed)


def _doubt(shares: NoisePosterior, nuisances: Collection[_NuisancePrior]) -> None:
    """Lower the probabilities of nuisance noises to what their priors as causes allow.

    docs/method/noises.md, below Eq. 26.

    To avoid false alarms, the fits assume such noise in every other table. It is reported only if it
    is probable without that assumption: effects under white noise are its rivals.
    """
    log = np.array([w.log_posterior for w in shares.fits])
    total = np.exp(log - log.max())
    for nuisance in nuisances:
        id_, before, concerned = nuisance.id, nuisance.assumed, nuisance.concerned
        if not concerned.any() or before >= 1.0:
            continue
        part = nuisance.shares(shares.fits)
        with_it = float(total @ part) / before * nuisance.prior
        without = float(total @ (1 - part)) / (1 - before) * (1 - nuisance.prior)
        as_a_cause = with_it / max(with_it + without, 1e-300)
        given = np.array([shares.nuisance_of(w.hypothesis.ids).get(id_, 0.0) for w in shares.fits])
        usual = float(total @ given) / float(total.sum())
        factor = min(as_a_cause / max(usual, 1e-12), 1.0)
        for found in shares.nuisances.values():
            if id_ in found:
                found[id_] *= factor


def _nuisances(
    fits: Sequence[HypothesisFit], nuisances: Collection[_NuisancePrior], mixed: NDArray[np.float64]
) -> list[dict[str, float]]:
    """Probability of each nuisance noise as a cause, with its smaller prior: docs/method/noises.md, Eq. 26.

    `mixed` is the probability of the fitted noises that compete with them, beside each of `fits`.
    """
    found = {}
    for nuisance in nuisances:
        before, prior = nuisance.assumed, nuisance.prior
        if before in (0.0, 1.0):
            continue
        share = nuisance.shares(fits)
        odds = share * (1 - before) / np.maximum((1 - share) * before, 1e-12)
        odds *= prior / (1 - prior)
        found[nuisance.id] = (odds / (1 + odds) * (1 - np.minimum(mixed, 1.0))).tolist()
    return [dict(zip(found, each, strict=True)) for each in zip(*found.values(), strict=True)] or [
        {} for _ in fits
    ]
