"""Notes: what a user should know besides the verdict."""

from collections.abc import Sequence

import numpy as np

from echocal.concise import concise
from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.findings.sentences import enumerated
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.inference.shortlist import MEASURE
from echocal.diagnose.inference.visible import INVISIBLE
from echocal.diagnose.preprocess.moving import without_movement
from echocal.diagnose.results.doubts import doubts_about
from echocal.diagnose.results.level_steps import LevelStep
from echocal.diagnose.selection.claims import free_size
from echocal.diagnose.validation.validate import Validation
from echocal.keywords import command_line, keyword
from echocal.observations import Observations
from echocal.quantities import QUANTITIES
from echocal.registry import find_effect

__all__ = ["hidden_causes", "notes"]

_TENSION = 3.0  # standard uncertainties between the fitted and the theoretical size
_SHOWN = 8  # columns, or steps of the level, that are listed


def notes(
    case: Case,
    observations: Observations,
    validation: Validation,
    stack: Stack,
    steps: Sequence[LevelStep],
) -> tuple[str, ...]:
    """Tension with theory, refuted claims, level steps, and what these data cannot show."""
    said = [_moved(case.moving), *observations.notes, *case.remarks]
    said += [_tension(case, cause, validation, stack) for cause in case.found.size_tangents]
    said += _temperature(validation)
    if hidden := hidden_causes(case):
        said.append(f"these data cannot show the following causes, whatever their size: {', '.join(hidden)}")
    rows = validation.gain.judged_rows
    said += list(dict.fromkeys(_refuted(refuted, rows) for refuted in validation.refuted))
    said += [_joined(claim.cause, observations) for claim in validation.claims]
    said += [doubt for claim in validation.claims for doubt in doubts_about(case, claim)]
    said += [*_both(case, observations), *_unread(case), *_aside(case)]
    if passing := ", ".join(validation.model.campaign_effects):
        said.append(
            f"the model includes {passing} for this campaign only. For other campaigns, leave it out "
            f"(Model.transferable, {command_line('correct', transferable=True)})"
        )
    said.append(_reference_join(observations, validation))
    if steps:
        at = "; ".join(str(step) for step in steps[:_SHOWN])
        more = f"; and {len(steps) - _SHOWN} more" if len(steps) > _SHOWN else ""
        said.append(
            f"the level changes in steps ({at}{more}). Each segment between two steps has its own level, so "
            "no step counts as an effect of the air"
        )
    given = observations.reference_distance
    if case.table.reference is None and given is not None and np.nanmax(given) > np.nanmin(given):
        said.append(
            f"the reference distances ({np.nanmin(given):g} to {np.nanmax(given):g} m) are not used, because "
            f"{keyword('constant_distance')} is given. If the distance is not constant, omit this option"
        )
    if case.table.reference is not None and np.ptp(case.table.reference) == 0:
        said.append(
            "all rows have the same reference distance. An error of this distance looks like zero_error, and "
            "these data cannot separate the two"
        )
    return tuple(text for text in said if text)


def hidden_causes(case: Case) -> tuple[str, ...]:
    """Causes that these rows cannot show, whatever their size."""
    return tuple(cause for cause, reason in case.found.skipped.items() if reason == INVISIBLE)


def _moved(how: str) -> str:
    """What a movement of the target takes away, and the ways out."""
    return how and (
        f"{how}. No cause of an error can be told from a movement: {without_movement()}, or leave out the "
        f"rows in which the target moves ({keyword('since')}, {keyword('until')})"
    )


def _reference_join(observations: Observations, validation: Validation) -> str:
    """What the join of a reference from another log does to the errors of the readings."""
    u, left = observations.reference_join_uncertainty, validation.gain.rms_after_m
    if not u or left is None or "reference_distance" not in observations.joined:
        return ""
    part = min(1.0, (u / left) ** 2)
    clocks = "two clocks that differ look like an error wherever the reference changes with time"
    return (
        f"the reference is {observations.joined['reference_distance']}: its standard uncertainty of "
        f"{1e3 * u:.2g} mm makes up to {100 * part:.0f} % of the variance of the errors ({1e3 * left:.2g} mm "
        f"RMS), which are no errors of the sensor; {clocks}"
    )


def _both(case: Case, observations: Observations) -> list[str]:
    """Whether the diagnosis uses readings or echo times, where both are recorded."""
    if not case.table.echoes or observations.reading is None:
        return []
    echo = observations.source_names.get("echo_time", "echo_s")
    return [
        "the table has readings and echo times. The diagnosis uses the echo times, because the arithmetic of "
        f"the device does not change them. To diagnose the readings: {keyword('columns', {echo: 'ignore'})}"
    ]


def _joined(cause: str, observations: Observations) -> str:
    """That a cause acts on the course of a quantity that was recorded at other times than the rows."""
    derived = (QUANTITIES[name].derived_from or "" for name in find_effect(cause).reads)
    moving = {word for text in derived if text.startswith("time and ") for word in [text[len("time and ") :]]}
    joined = [name for name in observations.joined if name in moving]
    if not joined:
        return ""
    column = observations.source_names[joined[0]]
    return (
        f"{cause} acts on the course of '{column}', which has other times than the rows and is "
        f"{observations.joined[joined[0]]}. Two clocks that differ look the same as this cause: compare them"
    )


def _unread(case: Case) -> list[str]:
    """Which further thermometers no cause was tried with, and why."""
    unread = case.found.unread
    if not unread:
        return []
    some = [f"{name} ({reason})" for name, reason in list(unread.items())[:_SHOWN]]
    more = f" and {len(unread) - _SHOWN} more" if len(unread) > _SHOWN else ""
    return [f"no cause was tried with these further thermometers: {', '.join(some)}{more}"]


def _aside(case: Case) -> list[str]:
    """Which further columns were not searched for an effect outside the catalogue."""
    aside = case.found.aside
    if not aside:
        return []
    tried = sum(name in case.table.extra for name in case.found.terms)
    more = f" and {len(aside) - _SHOWN} more" if len(aside) > _SHOWN else ""
    return [
        f"{tried} of the {tried + len(aside)} further columns that vary and have no gaps were searched for "
        f"an effect outside the catalogue. They were chosen by {MEASURE}. Not searched: "
        f"{', '.join(aside[:_SHOWN])}{more}. To search one of these, ignore another column: "
        f"{keyword('columns', {'NAME': 'ignore'})}"
    ]


def _refuted(refuted: Refuted, rows: str) -> str:
    """Why a cause that fits is not claimed; one text for causes that were refuted together."""
    before, after = 1e3 * refuted.rms_without_m, 1e3 * refuted.rms_with_m
    score = "" if refuted.log_score is None else f"; log density {refuted.log_score:+.1f}"
    is_not = "fits, but is" if len(refuted.together) == 1 else "fit together, but are"
    return (
        f"{enumerated(refuted.together)} {is_not} not claimed: the extended model is no better than the "
        f"base on {rows} ({before:.2f} mm with the base, {after:.2f} mm with the extended model{score})"
    )


def _tension(case: Case, cause: str, validation: Validation, stack: Stack) -> str:
    """Compare the size that the rows give with the size that theory fixes."""
    if find_effect(cause).supplies is None:  # a property of devices, not a law of nature
        return ""
    claimed = cause in [c.cause for c in validation.claims]
    known = case.found.size_tangents[cause][1]
    size, uncertainty = free_size(cause, case.found, validation.fit.hypothesis, stack)
    found = concise(size, uncertainty)
    if uncertainty > 0.5 * abs(known):
        return "" if claimed else f"these rows cannot show {cause}: its size, if fitted, is {found}"
    if claimed and abs(size - known) <= _TENSION * uncertainty:
        return ""
    return (
        f"{cause}, whose theoretical size is {known:g}, is {'' if claimed else 'not '}claimed. Its fitted "
        f"size is {found}. Another effect may act in the same rows, or the recorded values are not those on "
        "the sound path"
    )


def _temperature(validation: Validation) -> list[str]:
    """What the law of the base explains already."""
    fixed, before = validation.gain.rms_fixed_speed_m, validation.gain.rms_before_m
    if fixed is None or before > 0.5 * fixed:
        return []
    return [
        "the temperature changes the echo times, and the law of the base explains this change: the RMS error "
        f"is {1e3 * fixed:.2f} mm with one fixed speed and {1e3 * before:.2f} mm with the base"
    ]
