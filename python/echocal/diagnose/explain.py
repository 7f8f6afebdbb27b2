"""A diagnosis in plain sentences."""

from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.result import Cause, Diagnosis, NextMeasurement
from echocal.diagnose.sentences import parameter_text, quantity_text

__all__ = ["explain", "parameter_text", "proposal_text"]

_LEAD = {
    "named": "The data name a cause.",
    "ambiguous": "Something is wrong, and the data leave open which of several causes it is.",
    "unknown": "Something is there that no cause of the catalogue explains.",
    "nothing": "Nothing is found beyond noise.",
}

_SHOWN = 6  # causes named in one proposal


def explain(diagnosis: Diagnosis) -> str:
    """Plain sentences, one a line, that a user can check in the data."""
    lines = [_LEAD[diagnosis.verdict], _rows(diagnosis)]
    for cause in diagnosis.causes:
        lines += _cause(cause)
    if diagnosis.unexplained is not None:
        lines.append(f"Not explained: {diagnosis.unexplained.description}.")
    lines += _gain(diagnosis)
    lines += [f"Note: {note}." for note in diagnosis.notes]
    lines += [f"Next: {proposal_text(proposal)}." for proposal in diagnosis.next_measurements]
    return "\n".join(lines)


def _rows(diagnosis: Diagnosis) -> str:
    rows = diagnosis.rows
    text = f"{rows['used']} of {rows['total']} rows are used"
    reasons = "; ".join(f"{count}: {reason}" for reason, count in rows["unusable"].items())
    return f"{text}; left out, {reasons}." if reasons else f"{text}."


def _cause(cause: Cause) -> list[str]:
    sizes = ", ".join(
        parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in cause.parameters
    )
    told = cause.in_model or cause.kind != "effect"
    lines = [
        f"{'' if told else 'Or else '}{cause.id} (probability {cause.probability:.3f}; {sizes}): "
        f"{find_cause(cause.id).sentence}",
        f"  You can check it: {cause.because}.",
    ]
    if cause.doubt:
        lines.append(f"  But {cause.doubt}: it is not named.")
    if cause.indistinguishable_from:
        lines.append(f"  These data cannot tell it from {', '.join(cause.indistinguishable_from)}.")
    return lines


def _gain(diagnosis: Diagnosis) -> list[str]:
    gain = diagnosis.gain
    if gain is None:
        return []
    low, high = (1e3 * end for end in gain.interval_95)
    rungs = [f"{1e3 * rms:.2f} mm with {_joined(ids)}" for ids, rms in gain.ladder]
    lines = [
        f"On {gain.held_out_rows} rows that no parameter was fitted to ({gain.scheme}) the error is "
        f"{', '.join(rungs)}."
    ]
    if diagnosis.causes:
        lines.append(f"The extended model gains {low:.2f} to {high:.2f} mm over the base (95 %).")
    if gain.fraction_of_reachable is not None:
        lines.append(
            f"That is {100 * gain.fraction_of_reachable:.0f} % of what every recorded column together could "
            f"remove (floor {1e3 * gain.rms_floor_m:.2f} mm)."
        )
    return lines


def proposal_text(proposal: NextMeasurement) -> str:
    """What to measure, and what for, as a phrase."""
    pair = _pair(proposal.separates)
    side = proposal.conditions.get("side_measurement")
    if side is not None:
        return f"{pair}: {side}"
    varied = {name: values for name, values in proposal.conditions.items() if name != "rows"}
    where = "; ".join(
        f"{rows} at " + ", ".join(_at(name, values[place]) for name, values in varied.items())
        for place, rows in enumerate(proposal.conditions["rows"])
    )
    return (
        f"{pair}: measure {sum(proposal.conditions['rows'])} rows, {where} (the right one has a "
        f"probability of about {proposal.probability_now:.2f} now, and would then have "
        f"{proposal.expected_probability:.2f})"
    )


def _pair(separates: tuple[str, ...]) -> str:
    shown = separates[:_SHOWN]
    if len(shown) == 1:
        return f"to tell whether {shown[0]} is at work"
    rest = [f"{len(separates) - _SHOWN} others"] if len(separates) > _SHOWN else []
    *first, last = [*shown, *rest]
    return (
        f"to tell {', '.join(first)} from {last}"
        if len(shown) == 2
        else f"to tell {', '.join(first)} and {last} apart"
    )


def _at(name: str, value: float) -> str:
    text = quantity_text(name, value)
    return text if name in {"distance", "temperature"} else f"{name.replace('_', ' ')} {text}"


def _joined(ids: tuple[str, ...]) -> str:
    return " + ".join(ids) if ids else "the base"
