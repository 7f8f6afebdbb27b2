"""What a person should know beside the verdict."""

from collections.abc import Sequence

import numpy as np

from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.findings.sentences import enumerated
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack
from echocal.diagnose.inference.shortlist import MEASURE
from echocal.diagnose.inference.visible import INVISIBLE
from echocal.diagnose.results.level_steps import LevelStep
from echocal.diagnose.selection.claims import free_size, without
from echocal.diagnose.selection.tension import reconciled
from echocal.diagnose.validation.refute import Validation
from echocal.observations import Observations
from echocal.registry import find_effect

__all__ = ["notes"]

_SHOWN = 8  # columns, or steps of the level, that are listed


def notes(
    case: Case,
    observations: Observations,
    validation: Validation,
    stack: Stack,
    steps: Sequence[LevelStep],
) -> tuple[str, ...]:
    """Tension with theory, claims taken back, steps, and what could not be seen."""
    said = list(observations.notes)
    said += [_tension(case, cause, validation, stack) for cause in case.found.size_tangents]
    said += _temperature(validation)
    hidden = [cause for cause, reason in case.found.skipped.items() if reason == INVISIBLE]
    if hidden:
        said.append(f"whatever their size, these causes {INVISIBLE}: {', '.join(hidden)}")
    said += list(dict.fromkeys(_refuted(refuted) for refuted in validation.refuted))
    for cause in validation.unjudged:
        said.append(
            f"{cause} shows in too few stands or stretches to be learned from the others: the gain on rows "
            "never fitted says nothing about it"
        )
    said += [*_both(case, observations), *_aside(case)]
    if passing := ", ".join(validation.model.campaign_effects):
        said.append(
            f"{passing} belongs to this campaign: for another, leave it out (Model.transferable, echocal "
            "correct --transferable)"
        )
    if steps:
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
    tried = sum(name in case.table.extra for name in case.found.terms)
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


def _tension(case: Case, cause: str, validation: Validation, stack: Stack) -> str:
    """Whether a correction that theory is sure of has the size that theory gives it."""
    if find_effect(cause).supplies is None:  # a habit of devices, not a law of nature
        return ""
    claimed = cause in [c.cause for c in validation.kept]
    known = case.found.size_tangents[cause][1]
    beside = without(validation.fit.hypothesis, cause)
    plain, plain_u = free_size(cause, case.found, Hypothesis((), 1.0), stack.plain())  # the first look
    size, uncertainty = free_size(cause, case.found, beside, stack)
    if max(plain_u, uncertainty) > 0.5 * abs(known):
        return (
            ""
            if claimed
            else f"these rows cannot show {cause} (its size left free: {size:.2f} +/- {uncertainty:.2f})"
        )
    odd = max(abs(plain - known) / plain_u, abs(size - known) / uncertainty) > case.settings.claims.tension
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


def _temperature(validation: Validation) -> list[str]:
    """What the base's law already does for the readings."""
    fixed, before = validation.gain.rms_fixed_speed_m, validation.gain.rms_before_m
    if fixed is None or before > 0.5 * fixed:
        return []
    return [
        f"temperature is at work, and the base's law accounts for it: {1e3 * fixed:.2f} mm with one fixed "
        f"speed, {1e3 * before:.2f} mm with the base"
    ]
