"""The possible sets of causes, each with its model."""

from collections.abc import Iterable, Mapping, Sequence, Set

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.posterior import preferred
from echocal.diagnose.selection.claims import Claim, Ranking, extended, without
from echocal.diagnose.validation.gain import errors
from echocal.diagnose.validation.validate import Validation
from echocal.model import Model

__all__ = ["members"]

Ids = tuple[str, ...]

_SHARE = 0.99  # probability of all members together
_MOST = 10
_LEAST = 1e-4  # probability given to a rival that only its implausible size makes improbable


def members(
    case: Case, ranking: Ranking, claimed: Sequence[Claim], validation: Validation, stack: Stack
) -> tuple[Member, ...]:
    """Return the possible sets of causes, most probable first.

    An unexplained term is in no model, because it predicts nothing outside its range. Sets that
    differ only in such a term are one member. Refuted causes are in no model either. A set that
    explains the rows only together with a term or a refuted cause is no member.
    """
    refuted = {id_ for r in validation.refuted for id_ in (r.id, *r.indistinguishable_from)}
    refuted -= {claim.cause for claim in validation.claims}
    left_out = {UNKNOWN, *refuted}
    shares: dict[Ids, float] = {}
    alone: dict[Ids, float] = {}
    for ids, p in ranking.sets:
        named = _named(ids, left_out)
        shares[named] = shares.get(named, 0.0) + p
        alone[named] = alone.get(named, 0.0) + p * (UNKNOWN not in ids)
    forms: dict[Ids, list[HypothesisFit]] = {}
    for fit in ranking.fits:
        forms.setdefault(_named(fit.hypothesis.causes, left_out), []).append(fit)
    best = {named: _best(forms[named], left_out, stack) for named in _chosen(shares, claimed)}
    models = _models(case, best, stack, doubtful=bool(refuted))
    weights = np.array([max(shares.get(named, 0.0), _LEAST) for named in models])
    return tuple(
        Member(named, weight, models[named], max(alone.get(named, 0.0), _LEAST))
        for named, weight in zip(models, (weights / weights.sum()).tolist(), strict=True)
    )


def _named(ids: Iterable[str], left_out: Set[str]) -> Ids:
    return tuple(sorted(id_ for id_ in ids if id_ not in left_out))


def _chosen(shares: Mapping[Ids, float], claimed: Sequence[Claim]) -> list[Ids]:
    """Sets with most of the probability, and those that the data cannot separate from the best."""
    ordered = sorted(shares, key=lambda named: -shares[named])
    chosen, held = [], 0.0
    for named in ordered[:_MOST]:
        if held >= _SHARE:
            break
        chosen.append(named)
        held += shares[named]
    for named in _mimics(ordered[0], claimed):
        if named in shares and named not in chosen and len(chosen) < _MOST:
            chosen.append(named)
    return chosen


def _mimics(best: Ids, claimed: Sequence[Claim]) -> list[Ids]:
    """The most probable set with one cause replaced by a rival of it."""
    return [
        tuple(sorted(rival if id_ == claim.cause else id_ for id_ in best))
        for claim in claimed
        for rival in claim.rivals
    ]


def _best(same: Sequence[HypothesisFit], left_out: Set[str], stack: Stack) -> HypothesisFit:
    """The best hypothesis of a set; fitted again if it contains causes that are left out."""
    best = preferred([w for w in same if w.hypothesis.causes == same[0].hypothesis.causes])
    hypothesis = best.hypothesis
    for cause in left_out - {UNKNOWN}:
        hypothesis = without(hypothesis, cause)
    return best if hypothesis.causes == best.hypothesis.causes else fit_hypothesis(hypothesis, stack)


def _models(
    case: Case, best: Mapping[Ids, HypothesisFit], stack: Stack, *, doubtful: bool
) -> dict[Ids, Model]:
    """Model of each set of causes, except those whose error on the fitted rows exceeds the base's.

    Beside an unexplained term, the sizes of causes may compensate the term, which no model has.
    Such sizes are replaced by those of a fit without the term. Where causes are refuted, each model
    is checked again, because its causes were fitted beside the refuted ones.
    """
    models: dict[Ids, Model] = {}
    base: float | None = None
    for named, fit in best.items():
        model, has_term = extended(case.base_in_air, fit), UNKNOWN in fit.hypothesis.causes
        if has_term or doubtful:
            base = _mean_square(case, case.base.plain) if base is None else base
            if has_term and _mean_square(case, model) > base:
                model = extended(case.base_in_air, fit_hypothesis(without(fit.hypothesis, UNKNOWN), stack))
            if _mean_square(case, model) > base:
                continue
        models[named] = model
    return models or {(): extended(case.base_in_air, fit_hypothesis(Hypothesis((), 1.0), stack))}


def _mean_square(case: Case, model: Model) -> float:
    """Mean square error of the rows that are not held out [m^2]."""
    fit: NDArray[np.bool_] = case.folds.fit[case.folds.blocks]
    return float(np.nanmean(errors(case.table, model, fit)[fit] ** 2))
