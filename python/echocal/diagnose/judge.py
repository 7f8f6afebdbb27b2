"""Claims before the rows that no fit saw."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim, covariance_of, effects_of, without
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.gain import HeldOut, fixed_speed_rms, floor, measure, summarize, worse
from echocal.diagnose.noise import Noise
from echocal.diagnose.result import Gain, Ladder, Refuted
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
        Base extended by the kept causes, with the median of the recorded air.
    gain : Gain
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    weighed: Weighed
    model: Model
    gain: Gain


def judge(case: Case, best: Weighed, claimed: Sequence[Claim], noise: Noise) -> Judgment:
    """Drop, one by one, causes that make rows never fitted worse; measure what remains.

    A cause may fit rows by chance or stand in for something else; rows that it was not fitted to
    tell. This can only take claims back, never add one.
    """
    hypothesis, kept, refuted = best.hypothesis, list(claimed), []
    before = measure(case.table, case.folds, lambda _: case.base.model())
    after = _held_out(case, hypothesis, kept, noise)
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = [c for c in kept if c is not claim]
        lesser = without(hypothesis, claim.cause)
        spared = _held_out(case, lesser, fewer, noise)
        if worse(after, spared):
            refuted.append(Refuted(claim.cause, claim.probability, after.rms, spared.rms, claim.rivals))
            hypothesis, kept, after = lesser, fewer, spared
    weighed = _fit(case, hypothesis, case.folds.fit, noise)
    fixed = any(c.cause == "fixed_speed" for c in kept) or case.base.device_speed is not None
    gain = summarize(
        None if fixed else fixed_speed_rms(case.table, case.folds, _speed(case)),
        _ladder(case, hypothesis, kept, noise, before),
        before,
        after,
        floor(case.sums, case.folds.judged, weighed.variance),
        case.folds,
        case.seed,
    )
    model = _extended(case, weighed, kept, gain)
    return Judgment(tuple(kept), tuple(refuted), weighed, model, gain)


def _extended(case: Case, weighed: Weighed, kept: Sequence[Claim], gain: Gain) -> Model:
    """Base and kept causes; where nobody measures the air, it assumes the air that was seen."""
    base = replace(case.base, air={**case.base.air, **case.table.air()})
    effects = effects_of(weighed, [c.cause for c in kept])
    names = base.model(effects).parameter_names
    return base.model(
        effects,
        covariance=covariance_of(weighed, names) if names else None,
        provenance={"made_by": "echocal diagnose", "rows": len(case.table), "gain": asdict(gain)},
    )


def _ladder(
    case: Case, hypothesis: Hypothesis, kept: Sequence[Claim], noise: Noise, before: HeldOut
) -> Ladder:
    """Error as the causes join, the largest first."""

    def size(claim: Claim) -> float:
        return float(np.std(case.signal(claim.variant, claim.mean)))

    joined = sorted(kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = joined[:count]
        part = hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        steps.append((tuple(c.cause for c in some), _held_out(case, part, some, noise).rms))
    return tuple(steps)


def _held_out(case: Case, hypothesis: Hypothesis, kept: Sequence[Claim], noise: Noise) -> HeldOut:
    return measure(case.table, case.folds, _fitter(case, hypothesis, [c.cause for c in kept], noise))


def _fitter(
    case: Case, hypothesis: Hypothesis, causes: Sequence[str], noise: Noise
) -> Callable[[Mask], Model]:
    def fitted(blocks: Mask) -> Model:
        return case.base.model(effects_of(_fit(case, hypothesis, blocks, noise), causes))

    return fitted


def _fit(case: Case, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> Weighed:
    """Fit under one noise: for a point estimate the others do not matter."""
    whitened = case.sums.whiten(noise, blocks)
    return weigh(hypothesis, Stack.of([whitened], case.sums.degrees(blocks)))


def _speed(case: Case) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    one = np.ones(len(case.table))
    return 2.0 * case.base.indication(one, case.table.conditions)
