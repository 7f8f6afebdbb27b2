"""A diagnosis in plain sentences."""

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.parts import Cause, Gain, NextMeasurement
from echocal.diagnose.findings.sentences import enumerated, parameter_text, quantity_text, shifted_text
from echocal.diagnose.noises.registry import listed_only
from echocal.diagnose.results.outcome import Outcome

__all__ = ["explain", "further_notes", "lead", "parameter_text", "proposal_text"]

_SHOWN = 6  # causes named in one proposal


def explain(diagnosis: Outcome) -> str:
    """Plain sentences, one a line, that a user can check in the data."""
    lines = [f"{lead(diagnosis)}.", _rows(diagnosis)]
    for cause in diagnosis.causes:
        lines += _cause(cause)
    if diagnosis.unexplained is not None:
        lines.append(f"Not explained: {diagnosis.unexplained.description}.")
    lines += _gain(diagnosis.gain)
    lines += [f"Note: {note}." for note in further_notes(diagnosis)]
    lines += [f"Next: {proposal_text(proposal)}." for proposal in diagnosis.next_measurements]
    return "\n".join(lines)


def lead(diagnosis: Outcome) -> str:
    """One sentence on the verdict, without its period."""
    if diagnosis.verdict == "nothing":
        slow = any(c.id in listed_only() and c.indistinguishable_from for c in diagnosis.causes)
        which = " that remembers for long, or something unknown that changes as slowly" if slow else ""
        return f"Nothing is found beyond noise{which}"
    if diagnosis.verdict == "unknown":
        return "Something is there that no cause of the catalogue explains"
    if diagnosis.verdict == "ambiguous":
        return f"Something is wrong, and {_left_open(diagnosis)}"
    named = [c for c in diagnosis.causes if c.probability >= diagnosis.settings.claims.named and not c.doubt]
    named = [c for c in named if c.id not in listed_only()]
    effects = [_class(cause) for cause in named if cause.kind == "effect" and cause.in_model]
    faults = [cause.id for cause in named if cause.kind == "gross"]
    others = [cause.id for cause in named if cause.kind not in {"effect", "gross"}]
    elsewhere = (("in the table itself", faults), ("in single rows or in the scatter", others))
    said = [(place, enumerated(ids)) for place, ids in elsewhere if ids]
    if effects:
        text = "; and ".join(
            [f"The data name {enumerated(effects)}", *(f"{place} {ids}" for place, ids in said)]
        )
    else:
        text = (
            f"The data name, {'; and '.join(f'{place}, {ids}' for place, ids in said)}; no cause of a shift"
        )
    return f"{text}; beside it something that no cause explains" if diagnosis.unexplained else text


def _left_open(diagnosis: Outcome) -> str:
    if diagnosis.refuted and not any(cause.in_model for cause in diagnosis.causes):
        return "every cause that fits is refuted by rows never fitted: no cause of a shift is claimed"
    return "the data leave open which of several causes it is"


def rivals_of(cause: Cause) -> list[str]:
    """What these data cannot tell a cause from, as people say it."""
    return ["something unknown" if id_ == UNKNOWN else id_ for id_ in cause.indistinguishable_from]


def _class(cause: Cause) -> str:
    rivals = rivals_of(cause)
    if not rivals:
        return cause.id
    return f"{cause.id} (or {rivals[0] if len(rivals) == 1 else f'one of {len(rivals)} that look the same'})"


def _rows(diagnosis: Outcome) -> str:
    rows = diagnosis.rows
    text = f"{rows['used']} of {rows['total']} rows are used"
    reasons = "; ".join(f"{count} ({reason})" for reason, count in rows["unusable"].items())
    return f"{text}; left out: {reasons}." if reasons else f"{text}."


def _cause(cause: Cause) -> list[str]:
    sizes = ", ".join(
        parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in cause.parameters
    )
    alone = "" if cause.in_model or cause.kind != "effect" else "Or else "
    rivals = rivals_of(cause)
    others = rivals[0] if len(rivals) == 1 else f"one of {len(rivals)} others"
    shared = f" that it is this one or {others}" if rivals else ""
    lines = [
        f"{alone}{cause.id}, {sizes} (probability {cause.probability:.3f}{shared}): "
        f"{find_cause(cause.id).sentence}",
        f"  You can check it: {cause.because}.",
    ]
    if cause.doubt:
        lines.append(f"  But {cause.doubt}.")
    if rivals:
        lines.append(f"  These data cannot tell it from {', '.join(rivals)}.")
    return lines


def _gain(gain: Gain | None) -> list[str]:
    if gain is None:
        return []
    (_, before), *rungs = gain.ladder
    rows = f"On {gain.held_out_rows} rows that no parameter was fitted to ({gain.scheme}) the error is"
    floor = f"{1e3 * gain.rms_floor_m:.2f} mm"
    if not rungs:
        able = "" if gain.fraction_of_reachable is None else f" (all recorded columns together reach {floor})"
        return [f"{rows} {1e3 * before:.2f} mm with the base{able}; no effect extends it."]
    steps = "; ".join(f"{1e3 * rms:.2f} mm with {' + '.join(ids)}" for ids, rms in rungs)
    low, high = (1e3 * end for end in gain.interval_95)
    shown = " (no gain that these rows could show)" if low <= 0.0 else ""
    lines = [
        f"{rows} {1e3 * before:.2f} mm with the base; {steps}.",
        f"The extended model gains {low:.2f} to {high:.2f} mm over the base (95 %){shown}.",
    ]
    if gain.fraction_of_reachable is not None:
        lines.append(
            f"That is {100 * gain.fraction_of_reachable:.0f} % of what every recorded column together could "
            f"remove (floor {floor})."
        )
    return lines + [f"Under other conditions: {shifted_text(one)}." for one in gain.shifted]


def further_notes(diagnosis: Outcome) -> list[str]:
    """Notes that neither a cause nor the count of rows tells already."""
    told = {cause.doubt for cause in diagnosis.causes}
    told |= {f"{cause.id}: {cause.because}" for cause in diagnosis.causes}
    return [note for note in diagnosis.notes if note not in told and "rows cannot be used" not in note]


def proposal_text(proposal: NextMeasurement) -> str:
    """What to measure, and what for, as a phrase."""
    pair = _pair(proposal.separates)
    side = proposal.conditions.get("side_measurement")
    if side is not None:
        return f"{pair}: {side}"
    varied = {name: values for name, values in proposal.conditions.items() if name != "rows"}
    rows = proposal.conditions["rows"]
    places = [
        ", ".join(_at(name, values[place]) for name, values in varied.items()) for place in range(len(rows))
    ]
    where = "; ".join(f"{count} at {place}" for count, place in zip(rows, places, strict=True))
    where = f" at {places[0]}" if len(places) == 1 else f", {where}"
    return (
        f"{pair}: measure {sum(rows)} rows{where} (the first name is right with a probability of "
        f"about {proposal.probability_now:.2f} now, and of {proposal.expected_probability:.2f} then)"
    )


def _pair(separates: tuple[str, ...]) -> str:
    causes = [name for name in separates if name != "nothing"]
    names = causes[:_SHOWN]
    if len(causes) > _SHOWN:
        names.append(f"{len(causes) - _SHOWN} others")
    if len(names) == 1:
        return f"to tell whether {names[0]} is at work"
    apart = f"to tell {names[0]} from {names[1]}" if len(names) == 2 else f"to tell {enumerated(names)} apart"
    return apart if len(causes) == len(separates) else f"{apart}, and from nothing"


def _at(name: str, value: float) -> str:
    text = quantity_text(name, value)
    return text if name in {"distance", "temperature"} else f"{name.replace('_', ' ')} {text}"
