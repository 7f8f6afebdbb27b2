"""Validation of the claims, and the gain of those that are kept."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Gain, Ladder, Refuted
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.selection.claims import (
    Claim,
    extended,
    parameters,
    without,
)
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.gain import HeldOut, errors, floor, on_common_rows, summarize
from echocal.diagnose.validation.judges import Judge
from echocal.diagnose.validation.residual_uncertainty import residual_uncertainty
from echocal.diagnose.validation.score import Score
from echocal.diagnose.validation.shifted import shifted
from echocal.diagnose.validation.trials import Rest, Trials, fit_with
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
    withheld : tuple of Claim
        Claims that the model does not have, because their gain is not proven.
    doubts : mapping of str to str
        Why claims are not named, whatever their probability is.
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    fit: HypothesisFit
    model: Model
    gain: Gain
    fitted: Callable[[Mask], Model]
    withheld: tuple[Claim, ...] = ()
    doubts: Mapping[str, str] = field(default_factory=dict)

    @property
    def claims(self) -> tuple[Claim, ...]:
        """Claims that no row refutes, in the model or withheld from it."""
        return self.kept + self.withheld

    def further_level_step(self, table: Table) -> int | None:
        """Source row of a claimed step of an unknown level, if no segment begins there yet.

        A step of an unknown level is not an error of the sensor, so a new segment begins there.
        """
        steps = [claim for claim in self.claims if claim.cause == "step_change"]
        if table.reference is not None or not steps:
            return None
        time = parameters(steps[0].variant, steps[0].mean)["time"]
        later = np.flatnonzero(table.conditions["elapsed_time"] > time)
        return None if not len(later) or table.row[later[0]] in table.steps else int(table.row[later[0]])


def validate(case: Case, selection: Selection, judge: Judge, stack: Stack) -> Validation:
    """Compare the model with the base on rows that its choice has not seen, and measure its gain.

    A model whose error is not smaller than that of the base is never written: the model is the base. Its
    causes are refuted, unless the interval of the log score is above zero: then slow noise decides the
    error, and they are possible. If the error is smaller, but the interval of the gain or of the log score is
    not above zero, its causes are possible, and the model is the base.

    Parameters
    ----------
    case : Case
    selection : Selection
    judge : Judge
        The rows.
    stack : Stack
        Products under the noises that some hypothesis makes probable.
    """
    trials = Trials(case, selection.noise)
    before = judge.base()
    rest = judge.judged(trials, Rest(selection.best.hypothesis, tuple(selection.claims), before))
    score = judge.score(rest.after, before, selection.noise) if rest.kept else None
    gain = _gain(trials, judge, rest, before, selection, score)
    refuted: tuple[Refuted, ...] = ()
    withheld: tuple[Claim, ...] = ()
    doubts: dict[str, str] = {}
    if rest.kept and not gain.earned:
        low, _ = (score or Score(np.zeros(0))).interval()
        if _larger(rest.after, before) and not low > 0.0:
            refuted = _refuted(rest, before, gain.log_score)
        else:
            withheld, doubts = rest.kept, {claim.cause: _unearned(gain) for claim in rest.kept}
        rest = _base_alone(rest, before)
        gain = _gain(trials, judge, rest, before, selection)
    fit = _fit(trials, rest, selection)
    kept = [claim.cause for claim in rest.kept]
    origin = {"made_by": "echocal diagnose", "rows": len(case.table.rows), "gain": asdict(gain)}
    model = extended(case.base_in_air, _uncertain(fit, rest, stack), kept, provenance=origin)
    return Validation(
        rest.kept,
        refuted,
        fit,
        _measured(trials, judge, rest, model),
        gain,
        trials.fitted(rest.hypothesis, rest.kept),
        withheld,
        doubts,
    )


def _refuted(rest: Rest, before: HeldOut, log_score: float | None) -> tuple[Refuted, ...]:
    """All claims: the whole model is no better than the base."""
    after, base = on_common_rows(rest.after, before)
    ids = tuple(claim.cause for claim in rest.kept)
    return tuple(
        Refuted(c.cause, c.probability, after.rms, base.rms, c.rivals, ids, log_score) for c in rest.kept
    )


def _unearned(gain: Gain) -> str:
    """Why no cause is in the model: its gain may be chance."""
    low, high = (1e3 * end for end in gain.interval_95)
    if low == high == 0.0:
        return (
            f"without the rows that judge it, no cause is chosen, so {gain.judged_rows} show no gain over "
            "the base. The model leaves it out, and it is not named"
        )
    rows = f"on {gain.judged_rows}, which its choice has not seen, a model with it"
    if gain.rms_after_m >= gain.rms_before_m:
        return (
            f"{rows} has an error of {1e3 * gain.rms_after_m:.2f} mm, the base {1e3 * gain.rms_before_m:.2f} "
            "mm. Under the noise these rows are more probable with it, so it is not refuted. But the error "
            "is not smaller, so the model leaves it out, and it is not named"
        )
    first, last = gain.log_score_interval_95 or (gain.log_score or 0.0,) * 2
    return (
        f"{rows} gains {low:.2f} to {high:.2f} mm over the base, and the log density of these rows under "
        f"the noise changes by {first:.1f} to {last:.1f} (95 % intervals). Not both intervals are above 0, "
        "so the model leaves it out, and it is not named"
    )


def _larger(one: HeldOut, other: HeldOut) -> bool:
    """Whether the error is larger, on the rows that both can judge; equal errors say nothing."""
    after, before = on_common_rows(one, other)
    return bool(after.rms > before.rms)


def _base_alone(rest: Rest, before: HeldOut) -> Rest:
    """No claim; the error is that of the base."""
    hypothesis = rest.hypothesis
    for claim in rest.kept:
        hypothesis = without(hypothesis, claim.cause)
    return replace(rest, hypothesis=hypothesis, kept=(), after=before)


def _fit(trials: Trials, rest: Rest, selection: Selection) -> HypothesisFit:
    """The hypothesis of the claims, fitted to all rows except held-out ones."""
    case = trials.case
    return fit_with(case, rest.hypothesis, case.folds.fit, selection.noise)


def _uncertain(fit: HypothesisFit, rest: Rest, stack: Stack) -> HypothesisFit:
    """The same sizes with their mean square deviations under every noise, each by its probability."""
    over_noises = fit_hypothesis(rest.hypothesis, stack)
    apart = over_noises.mean - fit.mean
    return fit._replace(covariance=over_noises.covariance + np.outer(apart, apart))


def _measured(trials: Trials, judge: Judge, rest: Rest, model: Model) -> Model:
    """The model with its residual uncertainty, from rows that its sizes are not fitted to, if any."""
    case, held = trials.case, judge.held
    errors_of = judge.sized(trials, rest) if rest.kept else judge.base()
    rows = case.table.rows
    table, scheme = (rows, case.folds.scheme) if held is None else (held.rows, judge.scheme)
    found = residual_uncertainty(table, model, errors_of, scheme)
    if found is None:
        fitted = HeldOut(errors(rows, model, np.ones(len(rows), dtype=bool)))
        found = residual_uncertainty(rows, model, fitted, "fitted rows")
    return model.with_residual_uncertainty(found)


def _gain(
    trials: Trials,
    judge: Judge,
    rest: Rest,
    before: HeldOut,
    selection: Selection,
    score: Score | None = None,
) -> Gain:
    """The gain of the base with some claims."""
    case = trials.case
    fixed = any(c.cause == "fixed_speed" for c in rest.kept) or case.base.device_speed is not None
    variance = _fit(trials, rest, selection).variance
    gain = summarize(
        None if fixed else judge.fixed_speed(),
        _ladder(trials, judge, rest, before),
        before,
        rest.after if rest.kept else before,
        floor(case, variance),
        judge.scheme,
        case.table.unit if judge.held is None else judge.held.unit,
        selection.noise.rho,
        case.seed,
    )
    if score is not None and rest.kept:
        visits = case.table.members is not None
        interval = None if visits else score.interval()
        gain = replace(gain, log_score=score.total, log_score_interval_95=interval)
    ids = [claim.cause for claim in rest.kept]
    return replace(gain, shifted=shifted(case, rest.hypothesis, ids, selection.noise))


def _ladder(trials: Trials, judge: Judge, rest: Rest, before: HeldOut) -> Ladder:
    """Error as the causes are added, the largest first; their sizes are fitted without the judging rows."""

    def size(claim: Claim) -> float:
        signal = trials.case.signal(claim.variant, claim.mean)
        mean = 0.0 if trials.case.table.reference is not None else signal.mean()  # the level includes it
        return float(np.mean((signal - mean) ** 2))

    joined = sorted(rest.kept, key=size, reverse=True)
    steps: list[tuple[tuple[str, ...], float]] = [((), before.rms)]
    for count in range(1, len(joined) + 1):
        some = tuple(joined[:count])
        part = rest.hypothesis
        for claim in joined[count:]:
            part = without(part, claim.cause)
        after = (
            before if rest.after is before else judge.sized(trials, replace(rest, hypothesis=part, kept=some))
        )
        steps.append((tuple(c.cause for c in some), after.rms))
    return tuple(steps)
