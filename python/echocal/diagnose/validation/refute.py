"""Claims on held-out rows."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Gain, Ladder, Refuted
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.selection.claims import Claim, covariance_of, effects_of, without
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.gain import (
    HeldOut,
    fixed_speed_rms,
    floor,
    measure,
    summarize,
    uninformative,
    worse,
)
from echocal.diagnose.validation.shifted import shifted
from echocal.model import Model

__all__ = ["Validation", "validate"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Validation:
    """The claims after the held-out rows.

    Attributes
    ----------
    kept : tuple of Claim
    refuted : tuple of Refuted
    fit : HypothesisFit
        Hypothesis of the kept causes, fitted on all rows that a fit may see.
    model : Model
        Base extended by the kept causes, with the median of the recorded air.
    gain : Gain
    fitted : callable
        ``fitted(blocks)`` is the same model, fitted on these blocks alone.
    unjudged : tuple of str
        Kept causes that no held-out row could judge.
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    fit: HypothesisFit
    model: Model
    gain: Gain
    fitted: Callable[[Mask], Model]
    unjudged: tuple[str, ...] = ()

    def further_level_step(self, table: Table) -> int | None:
        """Source row at which an unknown level jumps, where a step is claimed and no segment begins.

        A step of a level that nobody knows is no error of the sensor: the segment ends there.
        """
        if table.reference is not None or all(claim.cause != "step_change" for claim in self.kept):
            return None
        time = self.model.effects["step_change"]["time"]
        later = np.flatnonzero(table.conditions["elapsed_time"] > time)
        return None if not len(later) or table.row[later[0]] in table.steps else int(table.row[later[0]])


def validate(case: Case, selection: Selection) -> Validation:
    """Drop causes that make rows never fitted worse; measure what remains.

    A cause may fit rows by chance or stand in for something else; rows that it was not fitted to
    tell. They are asked about each cause beside the others, then about the whole beside the bare
    base. This can only take claims back, never add one.
    """
    noise = selection.noise
    trials = _Trials(case, noise)
    before = measure(case.table, case.folds, lambda _: case.base.model())
    left = _against_the_base(trials, _one_by_one(trials, selection.best.hypothesis, selection.claims), before)
    fit = _fit(case, left.hypothesis, case.folds.fit, noise)
    fixed = any(c.cause == "fixed_speed" for c in left.kept) or case.base.device_speed is not None
    gain = summarize(
        None if fixed else fixed_speed_rms(case.table, case.folds, _speed(case)),
        _ladder(trials, left, before),
        before,
        left.after,
        floor(case.sums, case.folds.judged, fit.variance),
        case.folds,
        case.seed,
        case.settings.validation,
    )
    gain = replace(gain, shifted=shifted(case, left.hypothesis, [c.cause for c in left.kept], noise))
    model = _extended(case, fit, left.kept, gain)
    fitted = trials.fitted(left.hypothesis, left.kept)
    return Validation(left.kept, left.refuted, fit, model, gain, fitted, left.unjudged)


@dataclass(frozen=True)
class _Left:
    """What is left of the claims, the hypothesis that they are fitted in, and the error with them."""

    hypothesis: Hypothesis
    kept: tuple[Claim, ...]
    after: HeldOut
    refuted: tuple[Refuted, ...]
    unjudged: tuple[str, ...]


def _one_by_one(trials: "_Trials", hypothesis: Hypothesis, claimed: Sequence[Claim]) -> _Left:
    """Drop, the least probable first, causes without which rows never fitted are less far off."""
    kept, refuted, unjudged = tuple(claimed), [], []
    after = trials.of(hypothesis, kept)
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = tuple(c for c in kept if c is not claim)
        lesser = without(hypothesis, claim.cause)
        spared = trials.of(lesser, fewer)
        if trials.uninformative(after, spared, trials.case.signal(claim.variant, claim.mean)):
            unjudged.append(claim.cause)
        elif worse(after, spared):
            refuted.append(Refuted(claim.cause, claim.probability, after.rms, spared.rms, claim.rivals))
            hypothesis, kept, after = lesser, fewer, spared
    return _Left(hypothesis, kept, after, tuple(refuted), tuple(unjudged))


def _against_the_base(trials: "_Trials", left: _Left, before: HeldOut) -> _Left:
    """Take all back if the whole is no better than the bare base on rows never fitted.

    Causes that undo each other pass the look at each beside the others: either alone may be still
    worse than both. A cause that none of these rows can judge is no matter of theirs and stays;
    what it changes in them by chance is not counted.
    """
    if not left.kept or not left.after.rms >= before.rms:
        return left
    quiet = tuple(claim for claim in left.kept if claim.cause in left.unjudged)
    hypothesis = left.hypothesis
    for claim in left.kept:
        hypothesis = hypothesis if claim in quiet else without(hypothesis, claim.cause)
    signal = sum(trials.case.signal(claim.variant, claim.mean) for claim in quiet)
    if quiet and not trials.uninformative(trials.of(hypothesis, quiet), before, np.asarray(signal)):
        for claim in quiet:  # only beside the others was nothing to be heard of them
            hypothesis = without(hypothesis, claim.cause)
        quiet = ()
    gone = [claim for claim in left.kept if claim not in quiet]
    ids = tuple(claim.cause for claim in gone)
    refuted = tuple(
        Refuted(c.cause, c.probability, left.after.rms, before.rms, c.rivals, together=ids) for c in gone
    )
    unjudged = tuple(claim.cause for claim in quiet)
    return _Left(hypothesis, quiet, before, (*left.refuted, *refuted), unjudged)


def _extended(case: Case, fit: HypothesisFit, kept: Sequence[Claim], gain: Gain) -> Model:
    """Base and kept causes; where nobody measures the air, it assumes the air that was seen."""
    base = replace(case.base, air={**case.base.air, **case.table.air()})
    effects = effects_of(fit, [c.cause for c in kept])
    names = base.model(effects).parameter_names
    return base.model(
        effects,
        covariance=covariance_of(fit, names) if names else None,
        provenance={"made_by": "echocal diagnose", "rows": len(case.table), "gain": asdict(gain)},
    )


def _ladder(trials: "_Trials", left: _Left, before: HeldOut) -> Ladder:
    """Error as the causes join, the largest first."""

    def size(claim: Claim) -> float:
        signal = trials.case.signal(claim.variant, claim.mean)
        mean = 0.0 if trials.case.table.reference is not None else signal.mean()  # a level has it
        return float(np.mean((signal - mean) ** 2))

    joined = sorted(left.kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = joined[:count]
        part = left.hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        after = before if left.after is before else trials.of(part, some)
        steps.append((tuple(c.cause for c in some), after.rms))
    return tuple(steps)


@dataclass
class _Trials:
    """Errors on held-out rows; what comes up again is not fitted again."""

    case: Case
    noise: Noise
    known: dict[tuple[frozenset[str], frozenset[str]], HeldOut] = field(default_factory=dict)

    def of(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> HeldOut:
        """Errors with the kept causes, fitted beside all of a hypothesis, part of the best one."""
        key = frozenset(hypothesis.causes), frozenset(claim.cause for claim in kept)
        if key not in self.known:
            fitted = self.fitted(hypothesis, kept)
            self.known[key] = measure(self.case.table, self.case.folds, fitted)
        return self.known[key]

    def uninformative(self, one: HeldOut, other: HeldOut, signal: NDArray[np.float64]) -> bool:
        """Whether held-out rows cannot judge what adds this signal."""
        return uninformative(one, other, signal, self.case.settings.validation.informative_share)

    def fitted(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> Callable[[Mask], Model]:
        """The model with the kept causes, as a function of the blocks that it is fitted on."""
        causes = [claim.cause for claim in kept]

        def fitted(blocks: Mask) -> Model:
            fit = _fit(self.case, hypothesis, blocks, self.noise)
            return self.case.base.model(effects_of(fit, causes))

        return fitted


def _fit(case: Case, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> HypothesisFit:
    """Fit under one noise: for a point estimate the others do not matter."""
    whitened = case.sums.whiten(noise, blocks, hypothesis.columns)
    return fit_hypothesis(hypothesis, Stack.of([whitened], case.sums.degrees(blocks)))


def _speed(case: Case) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    one = np.ones(len(case.table))
    return 2.0 * case.base.indication(one, case.table.conditions)
