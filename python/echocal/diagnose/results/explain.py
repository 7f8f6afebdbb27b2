"""A diagnosis in sentences."""

from echocal.concise import decimal
from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.parts import Cause, Gain, NextMeasurement
from echocal.diagnose.findings.sentences import enumerated, parameter_text, quantity_text, shifted_text
from echocal.diagnose.noises.registry import listed_only
from echocal.diagnose.results.outcome import Outcome
from echocal.diagnose.results.smooth import remainder_text, smooth_text

__all__ = [
    "EVEN",
    "class_texts",
    "explain",
    "further_notes",
    "good_enough_text",
    "lead",
    "minor_text",
    "mm_text",
    "parameter_text",
    "place_text",
    "probability_text",
    "proposal_text",
    "rivals_of",
    "without_a_cause",
]

_SHOWN = 6  # causes named in one proposal
EVEN = 0.5  # a member of a class that is less probable alone is no headline
_ONE_OF = "one of "
_OUTSIDE = "an effect outside the catalogue"
_NO_SHIFT = "no cause that shifts the readings"
_ACTS_ON = {"gross": "whole columns of the table", "row": "single rows", "noise": "the noise"}


def explain(diagnosis: Outcome) -> str:
    """Sentences, a line for each fact, that a user can check in the data."""
    lines = [f"{lead(diagnosis)}.", _rows(diagnosis)]
    for cause in diagnosis.causes:
        lines += _cause(cause)
    if diagnosis.unexplained is not None:
        lines.append(f"Not explained: {diagnosis.unexplained.description}.")
    lines += [f"{text[0].upper()}{text[1:]}." for text in without_a_cause(diagnosis)]
    lines += _gain(diagnosis.gain)
    lines += [f"Note: {note}." for note in further_notes(diagnosis)]
    lines += [f"Next: {proposal_text(proposal)}." for proposal in diagnosis.next_measurements]
    return "\n".join(lines)


def lead(diagnosis: Outcome) -> str:
    """The verdict in one to three sentences, without the last period."""
    if diagnosis.good_enough:
        return f"The base is good enough: {good_enough_text(diagnosis)}"
    if diagnosis.verdict == "nothing":
        slow = any(c.id in listed_only() and c.indistinguishable_from for c in diagnosis.causes)
        either = f". Either the noise is autocorrelated, or {_OUTSIDE} changes as slowly as such noise"
        return f"No effect is detected{either if slow else ''}"
    if diagnosis.verdict == "unknown" and diagnosis.remainder is not None:
        return "The data show an effect, but no cause and no smooth function of one column is probable"
    if diagnosis.verdict == "unknown":
        return ". ".join([f"The data show {_OUTSIDE}", *_in_the_model(diagnosis)])
    if diagnosis.verdict == "ambiguous":
        return _left_open(diagnosis)
    named = [c for c in diagnosis.causes if c.probability >= diagnosis.settings.claims.named and not c.doubt]
    named = [c for c in named if c.id not in listed_only() and c.matters]
    effects = [_class(cause) for cause in named if cause.kind == "effect" and cause.in_model]
    shifting = f"the cause{'s' * (len(effects) > 1)} {enumerated(effects)}" if effects else _NO_SHIFT
    if len(effects) == 1 and effects[0].startswith(_ONE_OF):
        (shifting,) = effects
    said, also = [f"The data name {shifting}"], "also " if effects else ""
    for kind, what in _ACTS_ON.items():
        if ids := [cause.id for cause in named if cause.kind == kind]:
            acts = "act" if len(ids) > 1 else "acts"
            said.append(f"They {also}name {enumerated(ids)}, which {acts} on {what}")
            also = "also "
    if not effects:
        said += _in_the_model(diagnosis)
    return ". ".join([*said, *([f"They also show {_OUTSIDE}"] if diagnosis.unexplained else [])])


def _in_the_model(diagnosis: Outcome) -> list[str]:
    """A sentence on effects that the model has, though none is named."""
    modeled = [cause for cause in diagnosis.causes if cause.kind == "effect" and cause.in_model]
    if not modeled:
        return []
    least = diagnosis.settings.claims.named
    each = [f"{_class(c)} ({_short_of_a_name(c, least)})" for c in modeled]
    return [f"The model has {enumerated(each)}, which may act"]


def _short_of_a_name(cause: Cause, least: float) -> str:
    """Why an effect of the model has no name."""
    probability = f"probability {cause.probability:.2f}"
    why = "in doubt" if cause.probability >= least else f"a name needs {least:g}"
    return f"{probability}, {why}"


def good_enough_text(diagnosis: Outcome) -> str:
    """That what was found is too small to matter, by how much, and what would matter."""
    effects = [cause for cause in diagnosis.causes if cause.kind == "effect"]
    sizes = [cause.contribution_m or 0.0 for cause in effects if cause.in_model]
    most = sum(sizes) or max([c.contribution_m or 0.0 for c in effects], default=0.0)
    what = enumerated([cause.id for cause in effects]) if effects else "what the data show"
    together = " together" if len(sizes) > 1 else ""
    return (
        f"{what}{together} {'change' if len(effects) > 1 else 'changes'} no reading "
        f"by more than {mm_text(most)}, and less than {decimal(diagnosis.matters_mm)} mm does not matter "
        f"({diagnosis.matters_because})"
    )


def mm_text(meters: float) -> str:
    """``0.04 mm``: a length that a person compares with another one."""
    return f"{decimal(1e3 * meters, 2)} mm"


def minor_text(cause: Cause) -> str:
    """An effect that is too small to matter, in one line."""
    size = mm_text(cause.contribution_m or 0.0)
    return (
        f"{cause.id} changes no reading by more than {size}: it does not matter ({probability_text(cause)})"
    )


def without_a_cause(diagnosis: Outcome) -> list[str]:
    """What is known of an effect that nothing explains, and the correction that is offered meanwhile."""
    left = diagnosis.remainder
    texts = [] if left is None else [remainder_text(left)]
    smooth = diagnosis.smooth
    if smooth is not None and (smooth.offered or diagnosis.verdict == "unknown"):
        texts.append(smooth_text(smooth))
    return texts


def class_texts(diagnosis: Outcome) -> list[str]:
    """Each claimed effect with the question that each of its probabilities answers."""
    claimed = [cause for cause in diagnosis.causes if cause.kind == "effect" and cause.in_model]
    return [_questions(cause) for cause in claimed]


def _questions(cause: Cause) -> str:
    count = 1 + len(cause.indistinguishable_from)
    if count == 1:
        return f"does {cause.id} act? {cause.probability:.2f}"
    alone = "" if cause.probability_alone is None else f"; {cause.id} itself? {cause.probability_alone:.2f}"
    return f"does one of {count} causes act that these data cannot separate? {cause.probability:.2f}{alone}"


def _left_open(diagnosis: Outcome) -> str:
    """What an ambiguous verdict leaves open."""
    least = diagnosis.settings.claims.named
    open_ = [cause for cause in diagnosis.causes if cause.probability < least or cause.kind == "effect"]
    if open_ and not diagnosis.refuted and all(cause.kind != "effect" for cause in open_):
        each = [f"{c.id} on {_ACTS_ON[c.kind]} (probability {c.probability:.2f})" for c in open_]
        return f"The data may show {enumerated(each)}; a name needs {least:g}"
    return f"The data show an effect. {_effect_left_open(diagnosis)}"


def _effect_left_open(diagnosis: Outcome) -> str:
    if any(cause.doubt for cause in diagnosis.causes):
        model = _in_the_model(diagnosis)
        return model[0] if model else "Causes fit it, but their gain may be chance, so the model is the base"
    if diagnosis.refuted and not any(cause.in_model for cause in diagnosis.causes):
        rows = "" if diagnosis.gain is None else f"the {diagnosis.gain.judged_rows} "
        return f"Causes fit it, but {rows}refute each of them, so no cause is claimed"
    return "Several causes can explain it, and the data do not separate them"


def place_text(cause: Cause) -> str:
    """Words before an effect that the model does not have; else nothing."""
    if cause.in_model or cause.kind != "effect":
        return ""
    return "possible: " if cause.doubt else "possible instead: "


def rivals_of(cause: Cause) -> list[str]:
    """What these data cannot separate from a cause, as people say it."""
    return [_OUTSIDE if id_ == UNKNOWN else id_ for id_ in cause.indistinguishable_from]


def probability_text(cause: Cause) -> str:
    """Probability of a cause; where the data cannot separate it from others, of its class and of itself."""
    count = 1 + len(cause.indistinguishable_from)
    if count == 1:
        return f"probability {cause.probability:.3f}"
    itself = "" if cause.probability_alone is None else f"; {cause.id} alone {cause.probability_alone:.3f}"
    return f"one of {count} causes: probability {cause.probability:.3f} together{itself}"


def _class(cause: Cause) -> str:
    rivals = rivals_of(cause)
    if not rivals:
        return cause.id
    if len(rivals) > 1 and cause.probability_alone is not None and cause.probability_alone < EVEN:
        return f"{_ONE_OF}{1 + len(rivals)} similar causes ({cause.id} in the model)"
    return f"{cause.id} (or {rivals[0] if len(rivals) == 1 else f'one of {len(rivals)} similar causes'})"


def _rows(diagnosis: Outcome) -> str:
    rows = diagnosis.rows
    text = f"{rows['used']} of {rows['total']} rows are used."
    reasons = "; ".join(f"{count} ({reason})" for reason, count in rows["unusable"].items())
    return f"{text} Rows left out: {reasons}." if reasons else text


def _cause(cause: Cause) -> list[str]:
    sizes = ", ".join(
        parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in cause.parameters
    )
    rivals = rivals_of(cause)
    what = f"{place_text(cause).capitalize()}{cause.id}, {sizes} ({probability_text(cause)})"
    if not cause.matters:
        return [f"{place_text(cause).capitalize()}{minor_text(cause)}."]
    lines = [
        f"{what}: {find_cause(cause.id).sentence}",
        f"  You can check it: {cause.because}.",
    ]
    if cause.doubt:
        lines.append(f"  Doubt: {cause.doubt}.")
    if rivals:
        lines.append(f"  These data cannot separate it from {', '.join(rivals)}.")
    return lines


def _gain(gain: Gain | None) -> list[str]:
    if gain is None:
        return []
    if not gain.held_out_rows:
        return [
            "No row can judge a model: each row that a fold holds out has a level that no other row shows. "
            "So no gain is measured, and no cause is named."
        ]
    (_, before), *rungs = gain.ladder
    rows = f"On {gain.held_out_rows} {gain.judged_rows} ({gain.scheme}), the RMS error is"
    floor = f"{1e3 * gain.rms_floor_m:.2f} mm"
    if not rungs:
        lines = [f"{rows} {1e3 * before:.2f} mm with the base. No effect extends the base."]
        able = gain.fraction_of_reachable is not None
        return lines + [f"All recorded columns together could reach {floor}."] * able
    steps = "; ".join(f"{1e3 * rms:.2f} mm with {' + '.join(ids)}" for ids, rms in rungs)
    low, high = (1e3 * end for end in gain.interval_95)
    shown = " The interval contains 0, so these rows show no gain." if low <= 0.0 else ""
    least, most = (100 * end for end in gain.variance_removed_interval_95)
    lines = [
        f"{rows} {1e3 * before:.2f} mm with the base; {steps}.",
        f"{_choice(gain)} {1e3 * gain.rms_after_m:.2f} mm: the extended model removes "
        f"{100 * gain.variance_removed:.0f} % of the mean square error ({least:.0f} to {most:.0f} %) and "
        f"gains {low:.2f} to {high:.2f} mm over the base (95 % intervals).{shown}",
    ]
    if gain.fraction_of_reachable is not None:
        lines += [
            f"All recorded columns together could reach {floor}. The extended model removes "
            f"{100 * gain.fraction_of_reachable:.0f} % of the mean square error that they could remove."
        ]
    return lines + [f"Under other conditions: {shifted_text(one)}." for one in gain.shifted]


def _choice(gain: Gain) -> str:
    """What the error of the extended model is of."""
    if gain.judged_rows == "held-out rows":
        return "With all of them, it is"
    if gain.rms_after_m == gain.ladder[-1][1]:
        return "The choice of the folds is no worse; with these causes it is"
    return "If each fold also chooses the causes without these rows, it is"


def further_notes(diagnosis: Outcome) -> list[str]:
    """Notes that repeat neither a cause nor the count of rows."""
    stated = {cause.doubt for cause in diagnosis.causes}
    stated |= {f"{cause.id}: {cause.because}" for cause in diagnosis.causes}
    return [note for note in diagnosis.notes if note not in stated and "rows cannot be used" not in note]


def proposal_text(proposal: NextMeasurement) -> str:
    """What to measure and for which purpose, as a phrase."""
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
    where = f" at {places[0]}" if len(places) == 1 else f" ({where})"
    return (
        f"{pair}: measure {sum(rows)} rows{where}. The most probable set of effects has a probability of "
        f"{proposal.probability_now:.2f} now; {proposal.expected_probability:.2f} is expected afterwards"
    )


def _pair(separates: tuple[str, ...]) -> str:
    causes = [name for name in separates if name != "nothing"]
    names = causes[:_SHOWN]
    if len(causes) > _SHOWN:
        names.append(f"{len(causes) - _SHOWN} others")
    if len(names) == 1:
        return f"to test for {names[0]}"
    if len(causes) < len(separates):
        return f"to separate {enumerated([*names, 'no effect'])}"
    two = len(names) == 2
    return f"to separate {names[0]} from {names[1]}" if two else f"to separate {enumerated(names)}"


def _at(name: str, value: float) -> str:
    text = quantity_text(name, value)
    return text if name in {"distance", "temperature"} else f"{name.replace('_', ' ')} {text}"
