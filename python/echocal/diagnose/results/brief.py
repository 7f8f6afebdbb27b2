"""A diagnosis in short: what is wrong, by how much, how sure, what to do next."""

from dataclasses import dataclass

from echocal.concise import decimal
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.parts import Cause, Gain, Unexplained
from echocal.diagnose.findings.sentences import enumerated, parameter_text, spoken
from echocal.diagnose.preprocess.moving import without_movement
from echocal.diagnose.results.explain import EVEN, good_enough_text, proposal_text, rivals_of
from echocal.diagnose.results.outcome import Outcome

__all__ = ["Brief", "brief", "column_fault"]

_SHOWN = 3  # causes in one line
_LEAST = 1e-6  # m: no ultrasonic sensor shows less
_MORE = 4  # digits that are tried to tell the ends of an interval apart
_CONSTANT = "zero_error"
_OF_A_CONSTANT = "No distance is known, so an error that is the same in all rows cannot show."
_CERTAIN = 0.995  # a probability that two digits would round to one


@dataclass(frozen=True)
class Brief:
    """A diagnosis in four lines.

    Attributes
    ----------
    wrong, size, sure, next : str
        What is wrong, by how much, how sure this is, what to do next: a sentence or two each.
    """

    wrong: str
    size: str
    sure: str
    next: str


def brief(diagnosis: Outcome) -> Brief:
    """Say in short what was found.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> from echocal.diagnose.results.brief import brief
    >>> reading = 1.0 + 1e-3 * np.sin(np.arange(60.0) ** 2)
    >>> table = {"reading_m": reading, "temperature_C": np.linspace(5.0, 35.0, 60)}
    >>> brief(echocal.diagnose(table, reference_distance=1.0)).wrong
    'these rows show no systematic error of the base (linear).'
    """
    return Brief(_wrong(diagnosis), _size(diagnosis), _sure(diagnosis), _next(diagnosis))


def _wrong(diagnosis: Outcome) -> str:
    if diagnosis.good_enough:
        return f"{good_enough_text(diagnosis)}."
    spoiled = [_sentence(cause) for cause in _spoiling(diagnosis)]
    if diagnosis.moved:
        return " ".join([f"{diagnosis.moved}.", *map(_sentence, _named(diagnosis)), *spoiled])
    if effects := _named(diagnosis):
        more = [] if diagnosis.unexplained is None else [f"Also {_follows(diagnosis.unexplained)}"]
        return " ".join([*map(_sentence, effects), *spoiled, *more])
    if diagnosis.verdict == "nothing":
        none = f"these rows show no systematic error of the base ({_base(diagnosis)})."
        return f"{none} {_OF_A_CONSTANT}" if _CONSTANT in diagnosis.hidden else none
    if diagnosis.verdict == "named" and spoiled:
        return " ".join(spoiled)
    if diagnosis.verdict == "named":
        scatter = [_sentence(cause) for cause in diagnosis.causes if cause.kind == "noise"]
        return " ".join(["the noise, and no error that shifts the readings.", *scatter])
    return " ".join([*_open(diagnosis), *spoiled])


def _open(diagnosis: Outcome) -> list[str]:
    """What is wrong where no effect is named."""
    if diagnosis.unexplained is not None:
        return [_follows(diagnosis.unexplained)]
    if diagnosis.verdict == "unknown":
        return ["something that echocal has no name for shifts the readings."]
    effects = [cause for cause in diagnosis.causes if cause.kind == "effect"]
    ids = list(dict.fromkeys(id_ for c in effects for id_ in (c.id, *rivals_of(c))))
    ids = ids or [one.id for one in diagnosis.refuted]
    if not ids:
        unknown = ["the readings may have an error; these rows do not tell which."]
        return [] if _spoiling(diagnosis) else unknown
    if len(ids) == 1:
        return [f"perhaps this: {find_cause(ids[0]).sentence.rstrip('.')} ({ids[0]})."]
    more = f" or one of {len(ids) - _SHOWN} others" if len(ids) > _SHOWN else ""
    shown = f"{', '.join(ids[:_SHOWN])}{more}" if more else f"{', '.join(ids[:-1])} or {ids[-1]}"
    return [f"something shifts the readings, and these rows do not tell what: {shown}."]


def _follows(term: Unexplained) -> str:
    against = spoken(term.against)
    return f"something that echocal has no name for shifts the readings; it follows the {against}."


def _sentence(cause: Cause) -> str:
    """What a cause does; where others would look the same, no more than that."""
    rivals = rivals_of(cause)
    sentence = find_cause(cause.id).sentence.rstrip(".")
    if not rivals:
        return f"{sentence} ({cause.id})."
    if len(rivals) > 1 and (cause.probability_alone or 0.0) < EVEN:
        some = f"{cause.id} or {rivals[0]}"
        return f"One of {1 + len(rivals)} causes that look the same in these rows acts, such as {some}."
    alike = rivals[0] if len(rivals) == 1 else f"{len(rivals)} others"
    return f"{sentence} ({cause.id}; in these rows {alike} would look the same)."


def _size(diagnosis: Outcome) -> str:
    gain, sizes = diagnosis.gain, []
    for cause in [*_named(diagnosis), *_spoiling(diagnosis)]:
        fixed = cause.kind == "effect"  # its size is in its name; that of a fault, as a factor, is not
        fitted = [p for p in cause.parameters if p.unit != "1" or p.standard_uncertainty or not fixed]
        known = [p for p in fitted if p.unit != "1"] or fitted
        sizes += [parameter_text(p.name, p.value, p.standard_uncertainty, p.unit) for p in known[:1]]
    error = [_error(gain)] if gain is not None and gain.held_out_rows else []
    return "; ".join([*error, *sizes[:_SHOWN]] or ["no row can judge a correction"]) + "."


def _error(gain: Gain) -> str:
    before = f"RMS error {_rms(gain.rms_before_m)}"
    if len(gain.ladder) == 1:
        return f"{before}; no correction is proven to make it smaller"
    return f"{before}, with the correction {_rms(gain.rms_after_m)}"


def _sure(diagnosis: Outcome) -> str:
    told = _named(diagnosis) or _spoiling(diagnosis)
    if diagnosis.good_enough:
        return f"{_gained(diagnosis.gain)}{_rows(diagnosis)}."
    told = told or [c for c in diagnosis.causes if c.kind == "effect" and c.in_model]
    parts = [f"{_name(cause)} {_probability(cause.probability)}" for cause in told[:_SHOWN]]
    if diagnosis.verdict == "nothing":
        shifting = {cause.id for cause in diagnosis.causes if cause.kind != "effect"}
        none = sum(p for ids, p in diagnosis.posterior if not {*ids} - shifting)
        parts = [f"no effect {_probability(none)}"]
    doubts = [cause.id for cause in diagnosis.causes if cause.doubt and cause.matters and cause.in_model]
    what = "probability that it acts, by the fit alone" if doubts else "probability"
    said = [f"{what}: {', '.join(parts)}"] if parts else []
    said += [f"other rows leave in doubt: {enumerated(doubts)}"] if doubts else []
    return "; ".join([*said, f"{_gained(diagnosis.gain)}{_rows(diagnosis)}"]) + "."


def _gained(gain: Gain | None) -> str:
    if gain is None or not gain.held_out_rows or len(gain.ladder) == 1:
        return ""
    low, high = _interval(*gain.interval_95)
    return f"the correction gains {low} to {high} (95 %) on {gain.held_out_rows} {gain.judged_rows}; "


def _next(diagnosis: Outcome) -> str:
    if diagnosis.verdict == "nothing" and _CONSTANT in diagnosis.hidden:
        return "measure a distance with a ruler, to see an error that is the same in all rows."
    if diagnosis.good_enough or diagnosis.verdict == "nothing":
        return "nothing to correct."
    if diagnosis.moved:
        return f"{without_movement()}."
    if diagnosis.verdict == "named" and column_fault(diagnosis):
        return "mend the program or the table; the diagnosis has put it right for itself only."
    left_out = [cause for cause in _spoiling(diagnosis) if cause.kind == "row"]
    steps = [f"left out rows: {find_cause(cause.id).check}" for cause in left_out[:1]]
    first, *others = [step for step in (_next_of_the_rest(diagnosis), *steps) if step]
    return ". ".join([first, *(f"{step[0].upper()}{step[1:]}" for step in others)]) + "."


def _next_of_the_rest(diagnosis: Outcome) -> str:
    """What the rows that are used ask for; nothing where other rows are all that is wrong."""
    if _named(diagnosis) and diagnosis.model.effects:
        return "correct the readings with this model"
    if diagnosis.next_measurements:
        return proposal_text(diagnosis.next_measurements[0])
    if diagnosis.unexplained is not None:
        return f"look for what changes with the {spoken(diagnosis.unexplained.against)}"
    if spoiling := _spoiling(diagnosis):
        return "" if spoiling[0].kind == "row" else find_cause(spoiling[0].id).check
    return "nothing to correct" if diagnosis.verdict == "named" else "measure at another distance"


def _named(diagnosis: Outcome) -> list[Cause]:
    """Effects that have a name and matter."""
    least = diagnosis.settings.claims.named
    if diagnosis.verdict != "named":
        return []
    effects = [c for c in diagnosis.causes if c.kind == "effect" and c.in_model and c.matters]
    return [c for c in effects if c.probability >= least and not c.doubt]


def _spoiling(diagnosis: Outcome) -> list[Cause]:
    """Faults of rows and columns that are more probable than not."""
    return [c for c in diagnosis.causes if c.kind in ("row", "gross") and c.probability >= EVEN]


def column_fault(diagnosis: Outcome) -> bool:
    """Whether a whole column is wrong: a model does not mend it, and corrects the mended log alone."""
    return any(cause.kind == "gross" for cause in _spoiling(diagnosis))


def _name(cause: Cause) -> str:
    alike = 1 + len(cause.indistinguishable_from)
    if alike > 2 and (cause.probability_alone or 0.0) < EVEN:
        return f"one of {alike} causes"
    return f"one of {alike} causes such as {cause.id}" if cause.doubt and alike > 1 else cause.id


def _rows(diagnosis: Outcome) -> str:
    rows = diagnosis.rows
    why = ", ".join(f"{count} {reason}" for reason, count in rows["unusable"].items())
    return f"{rows['used']} of {rows['total']} rows are used{f' (left out: {why})' if why else ''}"


def _probability(value: float) -> str:
    return f"above {_CERTAIN}" if value >= _CERTAIN else f"{value:.2f}"


def _rms(meters: float, more: int = 0) -> str:
    if 0.0 < abs(meters) < _LEAST:
        return f"below {decimal(1e3 * _LEAST)} mm"
    return f"{decimal(1e3 * meters, more + (2 if abs(meters) < 1e-3 else 3))} mm"


def _interval(low: float, high: float) -> tuple[str, str]:
    """Both ends of an interval [m], with as many more digits as tell them apart."""
    pairs = ((_rms(low, more), _rms(high, more)) for more in range(_MORE))
    return next((pair for pair in pairs if pair[0] != pair[1]), (_rms(low), _rms(high)))


def _base(diagnosis: Outcome) -> str:
    speed = diagnosis.base["device_speed"]
    return str(diagnosis.base["law"]) if speed is None else f"{speed:g} m/s"
