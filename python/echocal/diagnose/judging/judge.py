"""Claims before the rows that no fit saw."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.evidence.case import Case
from echocal.diagnose.evidence.noise import Noise
from echocal.diagnose.evidence.weigh import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.judging.gain import HeldOut, fixed_speed_rms, floor, measure, silent, summarize, worse
from echocal.diagnose.judging.shifted import shifted
from echocal.diagnose.naming.claims import Claim, covariance_of, effects_of, without
from echocal.diagnose.terms.parts import Gain, Ladder, Refuted
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
    unheard : tuple of str
        Kept causes that no held-out row could speak for or against.
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    weighed: Weighed
    model: Model
    gain: Gain
    unheard: tuple[str, ...] = ()


def judge(case: Case, best: Weighed, claimed: Sequence[Claim], noise: Noise) -> Judgment:
    """Drop, one by one, causes that make rows never fitted worse; measure what remains.

    A cause may fit rows by chance or stand in for something else; rows that it was not fitted to
    tell. This can only take claims back, never add one.
    """
    hypothesis, kept, refuted = best.hypothesis, list(claimed), []
    before = measure(case.table, case.folds, lambda _: case.base.model())
    trials = _Trials(case, noise)
    after = trials.of(hypothesis, kept)
    unheard = []
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = [c for c in kept if c is not claim]
        lesser = without(hypothesis, claim.cause)
        spared = trials.of(lesser, fewer)
        if silent(after, spared, case.signal(claim.variant, claim.mean)):
            unheard.append(claim.cause)
        elif worse(after, spared):
            refuted.append(Refuted(claim.cause, claim.probability, after.rms, spared.rms, claim.rivals))
            hypothesis, kept, after = lesser, fewer, spared
    weighed = _fit(case, hypothesis, case.folds.fit, noise)
    fixed = any(c.cause == "fixed_speed" for c in kept) or case.base.device_speed is not None
    gain = summarize(
        None if fixed else fixed_speed_rms(case.table, case.folds, _speed(case)),
        _ladder(trials, hypothesis, kept, before),
        before,
        after,
        floor(case.sums, case.folds.judged, weighed.variance),
        case.folds,
        case.seed,
    )
    gain = replace(gain, shifted=shifted(case, hypothesis, [c.cause for c in kept], noise))
    model = _extended(case, weighed, kept, gain)
    return Judgment(tuple(kept), tuple(refuted), weighed, model, gain, tuple(unheard))


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


def _ladder(trials: "_Trials", hypothesis: Hypothesis, kept: Sequence[Claim], before: HeldOut) -> Ladder:
    """Error as the causes join, the largest first."""

    def size(claim: Claim) -> float:
        signal = trials.case.signal(claim.variant, claim.mean)
        mean = 0.0 if trials.case.table.reference is not None else signal.mean()  # a level has it
        return float(np.mean((signal - mean) ** 2))

    joined = sorted(kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = joined[:count]
        part = hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        steps.append((tuple(c.cause for c in some), trials.of(part, some).rms))
    return tuple(steps)


@dataclass
class _Trials:
    """Errors on held-out rows; what comes up again is not fitted again."""

    case: Case
    noise: Noise
    known: dict[tuple[frozenset[str], frozenset[str]], HeldOut] = field(default_factory=dict)

    def of(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> HeldOut:
        """Errors with the kept causes, fitted beside all of a hypothesis, part of the best one."""
        causes = [claim.cause for claim in kept]
        key = frozenset(hypothesis.causes), frozenset(causes)
        if key not in self.known:

            def fitted(blocks: Mask) -> Model:
                fit = _fit(self.case, hypothesis, blocks, self.noise)
                return self.case.base.model(effects_of(fit, causes))

            self.known[key] = measure(self.case.table, self.case.folds, fitted)
        return self.known[key]


def _fit(case: Case, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> Weighed:
    """Fit under one noise: for a point estimate the others do not matter."""
    whitened = case.sums.whiten(noise, blocks, hypothesis.columns)
    return weigh(hypothesis, Stack.of([whitened], case.sums.degrees(blocks)))


def _speed(case: Case) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    one = np.ones(len(case.table))
    return 2.0 * case.base.indication(one, case.table.conditions)
