"""Validation of the claims on cross-validated or held-out rows."""

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
    cannot_judge,
    fixed_speed_rms,
    floor,
    measure,
    summarize,
    worse,
)
from echocal.diagnose.validation.shifted import shifted
from echocal.model import Model

__all__ = ["Validation", "validate"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Validation:
    """The claims after the validation.

    Attributes
    ----------
    kept : tuple of Claim
    refuted : tuple of Refuted
    fit : HypothesisFit
        Hypothesis of the kept causes, fitted to all rows except held-out ones.
    model : Model
        Base extended by the kept causes. It assumes the median of the recorded air.
    gain : Gain
    fitted : callable
        ``fitted(blocks)`` is the same model, fitted on these blocks alone.
    unjudged : tuple of str
        Kept causes that the folds cannot validate.
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    fit: HypothesisFit
    model: Model
    gain: Gain
    fitted: Callable[[Mask], Model]
    unjudged: tuple[str, ...] = ()

    def further_level_step(self, table: Table) -> int | None:
        """Source row of a claimed step of an unknown level, if no segment begins there yet.

        A step of an unknown level is not an error of the sensor, so a new segment begins there.
        """
        if table.reference is not None or all(claim.cause != "step_change" for claim in self.kept):
            return None
        time = self.model.effects["step_change"]["time"]
        later = np.flatnonzero(table.conditions["elapsed_time"] > time)
        return None if not len(later) or table.row[later[0]] in table.steps else int(table.row[later[0]])


def validate(case: Case, selection: Selection) -> Validation:
    """Drop causes that make the error of the folds larger, and measure the gain of the others.

    A cause may fit by chance, or instead of another cause; rows that its size is not fitted to show
    this. First each cause is compared beside the others, then the whole model with the base. The
    validation removes claims and never adds one.
    """
    noise = selection.noise
    trials = _Trials(case, noise)
    before = measure(case.table, case.folds, lambda _: case.base.model())
    rest = _against_the_base(trials, _one_by_one(trials, selection.best.hypothesis, selection.claims), before)
    fit = _fit(case, rest.hypothesis, case.folds.fit, noise)
    fixed = any(c.cause == "fixed_speed" for c in rest.kept) or case.base.device_speed is not None
    gain = summarize(
        None if fixed else fixed_speed_rms(case.table, case.folds, _speed(case)),
        _ladder(trials, rest, before),
        before,
        rest.after,
        floor(case.sums, case.folds.judged, fit.variance, case.settings.noise_models.ridge_width),
        case.folds,
        case.seed,
        case.settings.validation,
    )
    gain = replace(gain, shifted=shifted(case, rest.hypothesis, [c.cause for c in rest.kept], noise))
    model = _extended(case, fit, rest.kept, gain)
    fitted = trials.fitted(rest.hypothesis, rest.kept)
    return Validation(rest.kept, rest.refuted, fit, model, gain, fitted, rest.unjudged)


@dataclass(frozen=True)
class _Rest:
    """The claims that are kept so far, the hypothesis that they are fitted in, and their error."""

    hypothesis: Hypothesis
    kept: tuple[Claim, ...]
    after: HeldOut
    refuted: tuple[Refuted, ...]
    unjudged: tuple[str, ...]


def _one_by_one(trials: "_Trials", hypothesis: Hypothesis, claimed: Sequence[Claim]) -> _Rest:
    """Drop causes without which the error of the folds is smaller, the least probable cause first."""
    kept, refuted, unjudged = tuple(claimed), [], []
    after = trials.of(hypothesis, kept)
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = tuple(c for c in kept if c is not claim)
        lesser = without(hypothesis, claim.cause)
        alone = trials.of(lesser, fewer)
        if trials.cannot_judge(after, alone, trials.case.signal(claim.variant, claim.mean)):
            unjudged.append(claim.cause)
        elif worse(after, alone):
            refuted.append(Refuted(claim.cause, claim.probability, after.rms, alone.rms, claim.rivals))
            hypothesis, kept, after = lesser, fewer, alone
    return _Rest(hypothesis, kept, after, tuple(refuted), tuple(unjudged))


def _against_the_base(trials: "_Trials", rest: _Rest, before: HeldOut) -> _Rest:
    """Drop all causes if the whole model is no better than the base.

    Two causes that compensate each other are both kept one by one, because the error with either
    alone may be larger. A cause that the folds cannot validate is kept: the small change that it
    makes in their errors is due to chance.
    """
    if not rest.kept or not rest.after.rms >= before.rms:
        return rest
    unjudged = tuple(claim for claim in rest.kept if claim.cause in rest.unjudged)
    hypothesis = rest.hypothesis
    for claim in rest.kept:
        hypothesis = hypothesis if claim in unjudged else without(hypothesis, claim.cause)
    signal = sum(trials.case.signal(claim.variant, claim.mean) for claim in unjudged)
    if unjudged and not trials.cannot_judge(trials.of(hypothesis, unjudged), before, np.asarray(signal)):
        for claim in unjudged:  # without the other causes, the folds can validate them
            hypothesis = without(hypothesis, claim.cause)
        unjudged = ()
    dropped = [claim for claim in rest.kept if claim not in unjudged]
    ids = tuple(claim.cause for claim in dropped)
    refuted = tuple(
        Refuted(c.cause, c.probability, rest.after.rms, before.rms, c.rivals, together=ids) for c in dropped
    )
    kept = tuple(claim.cause for claim in unjudged)
    return _Rest(hypothesis, unjudged, before, (*rest.refuted, *refuted), kept)


def _extended(case: Case, fit: HypothesisFit, kept: Sequence[Claim], gain: Gain) -> Model:
    """Base and kept causes; where the air is not measured, the model assumes the recorded medians."""
    base = replace(case.base, air={**case.base.air, **case.table.air()})
    effects = effects_of(fit, [c.cause for c in kept])
    names = base.model(effects).parameter_names
    return base.model(
        effects,
        covariance=covariance_of(fit, names) if names else None,
        provenance={"made_by": "echocal diagnose", "rows": len(case.table), "gain": asdict(gain)},
    )


def _ladder(trials: "_Trials", rest: _Rest, before: HeldOut) -> Ladder:
    """Error as the causes are added, the largest first."""

    def size(claim: Claim) -> float:
        signal = trials.case.signal(claim.variant, claim.mean)
        mean = 0.0 if trials.case.table.reference is not None else signal.mean()  # the level includes it
        return float(np.mean((signal - mean) ** 2))

    joined = sorted(rest.kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = joined[:count]
        part = rest.hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        after = before if rest.after is before else trials.of(part, some)
        steps.append((tuple(c.cause for c in some), after.rms))
    return tuple(steps)


@dataclass
class _Trials:
    """Errors of models on the folds; each model is fitted once."""

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

    def cannot_judge(self, one: HeldOut, other: HeldOut, signal: NDArray[np.float64]) -> bool:
        """Whether the folds cannot validate causes with this signal."""
        return cannot_judge(one, other, signal, self.case.settings.validation.informative_share)

    def fitted(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> Callable[[Mask], Model]:
        """The model with the kept causes, as a function of the blocks that it is fitted on."""
        causes = [claim.cause for claim in kept]

        def fitted(blocks: Mask) -> Model:
            fit = _fit(self.case, hypothesis, blocks, self.noise)
            return self.case.base.model(effects_of(fit, causes))

        return fitted


def _fit(case: Case, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> HypothesisFit:
    """Fit with the most likely noise, which is enough for a point estimate."""
    whitened = case.sums.whiten(noise, blocks, hypothesis.columns)
    return fit_hypothesis(hypothesis, Stack.of([whitened], case.sums.degrees(blocks)))


def _speed(case: Case) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    one = np.ones(len(case.table))
    return 2.0 * case.base.indication(one, case.table.conditions)
