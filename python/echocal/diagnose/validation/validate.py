"""Validation of the claims, and the gain of those that are kept."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Gain, Ladder, Refuted
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.selection.claims import (
    Claim,
    columns_of,
    covariance_of,
    effects_of,
    parameters,
    without,
)
from echocal.diagnose.selection.plausibility import beyond_a_bound
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.selection.steadiness import varied
from echocal.diagnose.validation.gain import HeldOut, errors, floor, on_common_rows, summarize
from echocal.diagnose.validation.judges import Judge
from echocal.diagnose.validation.one_session import of_one_session
from echocal.diagnose.validation.refute import Rest, against_the_base
from echocal.diagnose.validation.residual_uncertainty import residual_uncertainty
from echocal.diagnose.validation.score import Score
from echocal.diagnose.validation.shifted import shifted
from echocal.diagnose.validation.trials import Trials, fit_with
from echocal.diagnose.validation.untried_air import differs_in_untried_air
from echocal.model import Model

__all__ = ["Validation", "Withheld", "validate"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Withheld:
    """Claims whose gain may be chance, or that of one session.

    Attributes
    ----------
    claims : tuple of Claim
    gain : Gain
        Of the model that has them.
    session : str
        A sentence where they may be those of one session.
    """

    claims: tuple[Claim, ...]
    gain: Gain
    session: str = ""


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
    overruled : bool
        Whether claims that the folds do not refute were dropped with the model.
    withheld : Withheld or None
        Claims of which the model has some or none, because their gain together is not proven.
    """

    kept: tuple[Claim, ...]
    refuted: tuple[Refuted, ...]
    fit: HypothesisFit
    model: Model
    gain: Gain
    fitted: Callable[[Mask], Model]
    unjudged: tuple[str, ...] = ()
    overruled: bool = False
    withheld: Withheld | None = None

    @property
    def claims(self) -> tuple[Claim, ...]:
        """Claims that no row refutes, in the model or withheld from it."""
        return self.kept if self.withheld is None else self.withheld.claims

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


def validate(case: Case, selection: Selection, rest: Rest, judge: Judge, stack: Stack) -> Validation:
    """Compare the model with the base on rows that its choice has not seen, and measure its gain.

    A model whose error is not smaller than that of the base is never written: the model is the base. Its
    causes are refuted, unless the interval of the log score is above zero: then slow noise decides the
    error, and they are possible. If the error is smaller, but the interval of the gain or of the log score is
    not above zero, its causes are possible, and the model is the base. The same holds for a size that is
    unusual, unless distances are known, and for one that is implausible, unless the model holds at distances
    and in air that it is not fitted to, and its size is within the bounds of the cause; and for a model that
    may be that of one short session.

    Parameters
    ----------
    case : Case
    selection : Selection
    rest : Rest
        Its claims that the folds do not refute.
    judge : Judge
        The rows.
    stack : Stack
        Products under the noises that some hypothesis makes probable.
    """
    trials = Trials(case, selection.noise)
    before = judge.base()
    claimed = rest.kept
    rest = judge.judged(trials, rest)
    score = judge.score(rest.after, before, selection.noise) if rest.kept else None
    if score is not None and not _smaller(rest.after, before):
        low, _ = score.interval(case.settings.validation)
        rest = rest if low > 0.0 else against_the_base(trials, rest, before, score.total)
    gain, withheld = _gain(trials, judge, rest, before, selection, score), None
    if rest.kept and not (gain.earned and _sizes_hold(trials, rest, selection, gain)):
        withheld = Withheld(rest.kept, gain)
        rest, gain = _plausible_part(trials, judge, rest, before, selection)
    elif rest.kept and (session := of_one_session(case, _model(trials, rest, selection, gain))):
        withheld = Withheld(rest.kept, gain, session)
        rest, gain = _base_alone(trials, judge, rest, before, selection)
    fit = _fit(trials, rest, selection)
    overruled = len(rest.kept) < len(claimed) and withheld is None
    return Validation(
        rest.kept,
        rest.refuted,
        fit,
        _measured(
            trials, judge, rest, _extended(case, _uncertain(fit, rest, selection, stack), rest.kept, gain)
        ),
        gain,
        trials.fitted(rest.hypothesis, rest.kept),
        rest.unjudged,
        overruled,
        withheld,
    )


def _smaller(one: HeldOut, other: HeldOut) -> bool:
    """Whether the error is smaller, on the rows that both can judge; without any, nothing speaks against."""
    after, before = on_common_rows(one, other)
    return not after.rms >= before.rms


def _sizes_hold(trials: Trials, rest: Rest, selection: Selection, gain: Gain) -> bool:
    """Whether nothing speaks against the sizes of a model.

    Other things may follow the same conditions and lend a cause a size beyond the usual ones. Two such sizes
    cancel each other where they are fitted, and nowhere else.
    """
    case, kept = trials.case, {claim.cause for claim in rest.kept}
    large = sorted(kept & selection.implausible.keys())
    if large:
        fit = _fit(trials, rest, selection)
        elsewhere = {one.against: one.rms_after_m < one.rms_before_m for one in gain.shifted}
        return (
            "distance" in elsewhere
            and all(elsewhere.values())
            and not beyond_a_bound(large, fit)
            and not differs_in_untried_air(case, case.base.model(effects_of(fit, large)))
        )
    return kept.isdisjoint(selection.unusual) or case.table.reference is not None


def _plausible_part(
    trials: Trials, judge: Judge, rest: Rest, before: HeldOut, selection: Selection
) -> tuple[Rest, Gain]:
    """The claims without those whose sizes may be lent to them, if their gain is proven; else the base."""
    doubted = {*selection.implausible, *(selection.unusual if trials.case.table.reference is None else ())}
    large = [claim for claim in rest.kept if claim.cause in doubted]
    if large and len(large) < len(rest.kept):
        part = _less(rest, large)
        part = judge.judged(trials, replace(part, after=judge.sized(trials, part)))
        if part.kept and _smaller(part.after, before):
            score = judge.score(part.after, before, selection.noise)
            gain = _gain(trials, judge, part, before, selection, score)
            if gain.earned and _sizes_hold(trials, part, selection, gain):
                return part, gain
    return _base_alone(trials, judge, rest, before, selection)


def _base_alone(
    trials: Trials, judge: Judge, rest: Rest, before: HeldOut, selection: Selection
) -> tuple[Rest, Gain]:
    alone = replace(_less(rest, rest.kept), after=before)
    return alone, _gain(trials, judge, alone, before, selection)


def _less(rest: Rest, claims: Sequence[Claim]) -> Rest:
    """The same without some claims; its errors are those of before."""
    hypothesis = rest.hypothesis
    for claim in claims:
        hypothesis = without(hypothesis, claim.cause)
    kept = tuple(claim for claim in rest.kept if claim not in claims)
    return replace(rest, hypothesis=hypothesis, kept=kept)


def _model(trials: Trials, rest: Rest, selection: Selection, gain: Gain) -> Model:
    return _extended(trials.case, _fit(trials, rest, selection), rest.kept, gain)


def _fit(trials: Trials, rest: Rest, selection: Selection) -> HypothesisFit:
    """The hypothesis of the claims, fitted to all rows except held-out ones."""
    case = trials.case
    return varied(fit_with(case, rest.hypothesis, case.folds.fit, selection.noise), selection.between)


def _uncertain(fit: HypothesisFit, rest: Rest, selection: Selection, stack: Stack) -> HypothesisFit:
    """The same sizes with their mean square deviations under every noise, each by its probability."""
    over_noises = varied(fit_hypothesis(rest.hypothesis, stack), selection.between)
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
    case, settings = trials.case, trials.case.settings
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
        settings.validation,
    )
    if score is not None and rest.kept:
        gain = replace(gain, log_score=score.total, log_score_interval_95=score.interval(settings.validation))
    ids = [claim.cause for claim in rest.kept]
    return replace(gain, shifted=shifted(case, rest.hypothesis, ids, selection.noise))


def _extended(case: Case, fit: HypothesisFit, kept: Sequence[Claim], gain: Gain) -> Model:
    """Base and kept causes; where the air is not measured, the model assumes the recorded medians."""
    base = replace(case.base, air={**case.base.air, **case.table.air()})
    effects = effects_of(fit, [c.cause for c in kept])
    names = base.model(effects).parameter_names
    return base.model(
        effects,
        columns=columns_of(fit, [c.cause for c in kept]),
        covariance=covariance_of(fit, names) if names else None,
        provenance={"made_by": "echocal diagnose", "rows": len(case.table.rows), "gain": asdict(gain)},
    )


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
