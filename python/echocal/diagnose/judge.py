"""Claims before the rows that no fit saw."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.claims import Claim, covariance_of, effects_of, without
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.gain import HeldOut, fixed_speed_rms, floor, measure, summarize, worse
from echocal.diagnose.noise import Noise
from echocal.diagnose.result import Gain, Ladder, Refuted
from echocal.diagnose.study import Study
from echocal.model import Model

__all__ = ["Judgment", "judge"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Judgment:
    """What the held-out rows leave of the claims.

    Attributes
    ----------
    kept : tuple of Claim
    refuted : tuple of Refuted
    weighed : Weighed
        Hypothesis of the kept causes, fitted on all rows that a fit may see.
    model : Model
        Base extended by the kept causes.
    gain : Gain
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    weighed: Weighed
    model: Model
    gain: Gain


def judge(study: Study, best: Weighed, claimed: Sequence[Claim], noise: Noise) -> Judgment:
    """Drop, one by one, causes that make rows never fitted worse; measure what remains.

    A cause may fit rows by chance or stand in for something else; rows that it was not fitted to
    tell. This can only take claims back, never add one.
    """
    hypothesis, kept, refuted = best.hypothesis, list(claimed), []
    before = measure(study.table, study.folds, lambda _: study.base.model())
    after = _held_out(study, hypothesis, kept, noise)
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = [c for c in kept if c is not claim]
        lesser = without(hypothesis, claim.cause)
        spared = _held_out(study, lesser, fewer, noise)
        if worse(after, spared):
            refuted.append(Refuted(claim.cause, claim.probability, after.rms, spared.rms, claim.rivals))
            hypothesis, kept, after = lesser, fewer, spared
    weighed = _fit(study, hypothesis, study.folds.fit, noise)
    fixed = any(c.cause == "fixed_speed" for c in kept) or study.base.device_speed is not None
    gain = summarize(
        None if fixed else fixed_speed_rms(study.table, study.folds, _speed(study)),
        _ladder(study, hypothesis, kept, noise, before),
        before,
        after,
        floor(study.sums, study.folds.judged, weighed.variance),
        study.folds,
        study.seed,
    )
    effects = effects_of(weighed, [c.cause for c in kept])
    names = study.base.model(effects).parameter_names
    model = study.base.model(
        effects,
        covariance=covariance_of(weighed, names) if names else None,
        provenance={"made_by": "echocal diagnose", "rows": len(study.table), "gain": asdict(gain)},
    )
    return Judgment(tuple(kept), tuple(refuted), weighed, model, gain)


def _ladder(
    study: Study, hypothesis: Hypothesis, kept: Sequence[Claim], noise: Noise, before: HeldOut
) -> Ladder:
    """Error as the causes join, the largest first."""

    def size(claim: Claim) -> float:
        return float(np.std(study.signal(claim.variant, claim.mean)))

    joined = sorted(kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = joined[:count]
        part = hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        steps.append((tuple(c.cause for c in some), _held_out(study, part, some, noise).rms))
    return tuple(steps)


def _held_out(study: Study, hypothesis: Hypothesis, kept: Sequence[Claim], noise: Noise) -> HeldOut:
    return measure(study.table, study.folds, _fitter(study, hypothesis, [c.cause for c in kept], noise))


def _fitter(
    study: Study, hypothesis: Hypothesis, causes: Sequence[str], noise: Noise
) -> Callable[[Mask], Model]:
    def fitted(blocks: Mask) -> Model:
        return study.base.model(effects_of(_fit(study, hypothesis, blocks, noise), causes))

    return fitted


def _fit(study: Study, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> Weighed:
    """Fit under one noise: for a point estimate the others do not matter."""
    whitened = study.sums.whiten(noise, blocks)
    return weigh(hypothesis, Stack.of([whitened], study.sums.degrees(blocks)))


def _speed(study: Study) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    one = np.ones(len(study.table))
    return 2.0 * study.base.indication(one, study.table.conditions)
