"""What a person should know beside the verdict."""

from functools import reduce

import numpy as np

from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.findings.sentences import enumerated, first_against_others, tendency
from echocal.diagnose.inference.case import INVISIBLE, Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack
from echocal.diagnose.inference.shortlist import MEASURE
from echocal.diagnose.results.level_steps import steps_of
from echocal.diagnose.selection.claims import Claim, free_size, without
from echocal.diagnose.selection.tension import reconciled
from echocal.diagnose.validation.refute import Judgment
from echocal.observations import Observations
from echocal.registry import find_effect

__all__ = ["because", "notes"]

_SHOWN = 8  # columns, or steps of the level, that are listed
_TENSION = 3.0  # standard uncertainties between a size found and the size that theory fixes


def because(case: Case, claim: Claim, judgment: Judgment) -> str:
    """One sentence on a cause that a user can check in the data."""
    signal = case.signal(claim.variant, claim.mean)
    beside = [c for c in judgment.kept if c is not claim] if claim in judgment.kept else []
    left = reduce(np.subtract, (case.signal(c.variant, c.mean) for c in beside), case.residual)
    if "position_in_group" in find_effect(claim.cause).reads:
        return first_against_others(left, signal, case.table.conditions["position_in_group"])
    return tendency(left, signal, case.recorded)


def notes(case: Case, observations: Observations, judgment: Judgment, stack: Stack) -> tuple[str, ...]:
    """Tension with theory, claims taken back, steps, and what could not be seen."""
    said = list(observations.notes)
    said += [_tension(case, cause, judgment, stack) for cause in case.found.size_tangents]
    said += _temperature(judgment)
    hidden = [cause for cause, reason in case.found.skipped.items() if reason == INVISIBLE]
    if hidden:
        said.append(f"whatever their size, these causes {INVISIBLE}: {', '.join(hidden)}")
    said += list(dict.fromkeys(_refuted(refuted) for refuted in judgment.refuted))
    for cause in judgment.unheard:
        said.append(
            f"{cause} shows in too few stands or stretches to be learned from the others: the gain on rows "
            "never fitted says nothing about it"
        )
    said += [*_both(case, observations), *_aside(case)]
    if passing := ", ".join(judgment.model.campaign_effects):
        said.append(
            f"{passing} belongs to this campaign: for another, leave it out (Model.transferable, echocal "
            "correct --transferable)"
        )
    if len(case.table.steps):
        steps = steps_of(case.table, observations)
        at = "; ".join(str(step) for step in steps[:_SHOWN])
        more = f"; and {len(steps) - _SHOWN} more" if len(steps) > _SHOWN else ""
        said.append(
            f"the level jumps ({at}{more}): each stretch has its own level, and a jump is not "
            "blamed on the air"
        )
    given = observations.reference_distance
    if case.table.reference is None and given is not None and np.nanmax(given) > np.nanmin(given):
        said.append(
            f"the reference distances, {np.nanmin(given):g} to {np.nanmax(given):g} m, were not used: "
            "the distance was said to be constant; where it was not, leave --constant-distance out"
        )
    if case.table.reference is not None and np.ptp(case.table.reference) == 0:
        said.append(
            "there is one distance only: an error of the reference distance looks like zero_error, and "
            "nothing in these data guards against it"
        )
    return tuple(text for text in said if text)


def _both(case: Case, observations: Observations) -> list[str]:
    """Which of readings and echo times the diagnosis is of, where both are recorded."""
    if not case.table.echoes or observations.reading is None:
        return []
    echo = observations.source_names.get("echo_time", "echo_s")
    return [
        "readings and echo times are both recorded: the diagnosis is of the echo times, which the device's "
        f'own arithmetic has not touched; to diagnose the readings: --column "{echo}=ignore"'
    ]


def _aside(case: Case) -> list[str]:
    """Which further columns nothing unknown was sought against."""
    aside = case.found.aside
    if not aside:
        return []
    tried = sum(name in case.table.extra for name in case.found.shapes)
    more = f" and {len(aside) - _SHOWN} more" if len(aside) > _SHOWN else ""
    return [
        f"an unknown effect was searched for against {tried} of the {tried + len(aside)} further columns "
        f"that vary and have no gaps, chosen by {MEASURE}. The others were left aside: "
        f"{', '.join(aside[:_SHOWN])}{more}. To search against one of these, take other columns out: "
        '--column "NAME=ignore"'
    ]


def _refuted(refuted: Refuted) -> str:
    """Why a cause that fits is not claimed; the same of all that were refuted together."""
    before, after = 1e3 * refuted.rms_without_m, 1e3 * refuted.rms_with_m
    if refuted.together:
        fit = "fits" if len(refuted.together) == 1 else "together fit"
        return (
            f"{enumerated(refuted.together)} {fit} the rows of the fit, but the extended model is no better "
            f"than the base on rows never fitted ({before:.2f} mm with the base, {after:.2f} mm with the "
            "extended model): not claimed"
        )
    return (
        f"{refuted.id} fits the rows it was fitted to (probability {refuted.probability:.2f}) but makes "
        f"rows never fitted worse ({before:.2f} mm without it, {after:.2f} mm with it): not claimed"
    )


def _tension(case: Case, cause: str, judgment: Judgment, stack: Stack) -> str:
    """Whether a correction that theory is sure of has the size that theory gives it."""
    if find_effect(cause).supplies is None:  # a habit of devices, not a law of nature
        return ""
    claimed = cause in [c.cause for c in judgment.kept]
    known = case.found.size_tangents[cause][1]
    beside = without(judgment.weighed.hypothesis, cause)
    plain, plain_u = free_size(cause, case.found, Hypothesis((), 1.0), stack.plain())  # the first look
    size, uncertainty = free_size(cause, case.found, beside, stack)
    if max(plain_u, uncertainty) > 0.5 * abs(known):
        return (
            ""
            if claimed
            else f"these rows cannot show {cause} (its size left free: {size:.2f} +/- {uncertainty:.2f})"
        )
    odd = max(abs(plain - known) / plain_u, abs(size - known) / uncertainty) > _TENSION
    if claimed and not odd:
        return ""
    found = (
        f"left free, the size of {cause} is {plain:.2f} +/- {plain_u:.2f} by plain least squares and "
        f"{size:.2f} +/- {uncertainty:.2f} with noise that remembers; theory says {known:g}"
        f"{reconciled(case, cause, beside, stack, known, size, uncertainty)}"
    )
    if claimed:
        return (
            f"{found}: it is claimed with {known:g}, but something that goes with it is at work too, or the "
            "recorded values are not those of the sound path"
        )
    return (
        f"{cause} is not claimed; {found}: something of the opposite sign may hide it, or the recorded "
        "values are not those of the sound path"
    )


def _temperature(judgment: Judgment) -> list[str]:
    """What the base's law already does for the readings."""
    fixed, before = judgment.gain.rms_fixed_speed_m, judgment.gain.rms_before_m
    if fixed is None or before > 0.5 * fixed:
        return []
    return [
        f"temperature is at work, and the base's law accounts for it: {1e3 * fixed:.2f} mm with one fixed "
        f"speed, {1e3 * before:.2f} mm with the base"
    ]
