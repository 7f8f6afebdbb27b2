"""A diagnosis in short: what is wrong, by how much, how sure, what to do next."""

from dataclasses import dataclass

from echocal.concise import decimal
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.parts import Cause, Gain
from echocal.diagnose.findings.sentences import enumerated, parameter_text
from echocal.diagnose.noises.registry import listed_only
from echocal.diagnose.results.explain import good_enough_text, mm_text, proposal_text
from echocal.diagnose.results.outcome import Outcome

__all__ = ["Brief", "brief"]

_SHOWN = 3  # causes in one line
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
    'Nothing: these rows show no systematic error of the base (linear).'
    """
    return Brief(_wrong(diagnosis), _size(diagnosis), _sure(diagnosis), _next(diagnosis))


def _wrong(diagnosis: Outcome) -> str:
    told = _told(diagnosis)
    if diagnosis.good_enough:
        return f"{good_enough_text(diagnosis)}."
    if diagnosis.verdict == "nothing":
        return f"Nothing: these rows show no systematic error of the base ({_base(diagnosis)})."
    if diagnosis.verdict == "named":
        return " ".join(_sentence(cause) for cause in told)
    spoiled = [_sentence(cause) for cause in told if cause.kind in ("row", "gross")]
    return " ".join([_open(diagnosis), *spoiled])


def _open(diagnosis: Outcome) -> str:
    """What is wrong where no effect is named."""
    if diagnosis.unexplained is not None:
        against = diagnosis.unexplained.against
        return f"Something that echocal has no name for shifts the readings; it follows the column {against}."
    if diagnosis.verdict == "unknown":
        return "Something that echocal has no name for shifts the readings."
    ids = [cause.id for cause in _effects(diagnosis)]
    ids += [id_ for cause in _effects(diagnosis) for id_ in cause.indistinguishable_from if id_ not in ids]
    ids = list(dict.fromkeys(ids)) or [one.id for one in diagnosis.refuted]
    more = f" or one of {len(ids) - _SHOWN} others" if len(ids) > _SHOWN else ""
    if not ids:
        return "Something may shift the readings; these rows do not tell what."
    if len(ids) == 1:
        return f"Something may shift the readings, perhaps {ids[0]}: {find_cause(ids[0]).sentence}"
    return f"Something shifts the readings, and these rows do not tell what: {', '.join(ids[:_SHOWN])}{more}."


def _sentence(cause: Cause) -> str:
    rivals = cause.indistinguishable_from
    sentence = find_cause(cause.id).sentence.rstrip(".")
    if not rivals:
        return f"{sentence} ({cause.id})."
    alike = f"{rivals[0]}" if len(rivals) == 1 else f"{len(rivals)} others"
    return f"{sentence} ({cause.id}; in these rows {alike} would look the same)."


def _size(diagnosis: Outcome) -> str:
    gain = diagnosis.gain
    sizes = [
        parameter_text(p.name, p.value, p.standard_uncertainty, p.unit)
        for cause in _told(diagnosis)
        if cause.kind != "noise" or not _effects(diagnosis)
        for p in cause.parameters
        if p.standard_uncertainty > 0.0 or cause.kind != "effect"
    ]
    parts = [_error(gain)] if gain is not None and gain.held_out_rows else []
    return "; ".join([*parts, *sizes[:_SHOWN]]) + "."


def _error(gain: Gain) -> str:
    before = f"RMS error {_rms(gain.rms_before_m)}"
    if len(gain.ladder) == 1:
        return f"{before}; no correction by the recorded columns is proven to make it smaller"
    return f"{before}, with the correction {_rms(gain.rms_after_m)}"


def _sure(diagnosis: Outcome) -> str:
    parts = []
    if named := [cause for cause in _told(diagnosis) if cause.kind == "effect"]:
        parts += [f"{cause.id} {_probability(cause.probability)}" for cause in named[:_SHOWN]]
    elif others := [cause for cause in _told(diagnosis) if cause.kind != "effect"]:
        parts += [f"{cause.id} {_probability(cause.probability)}" for cause in others[:_SHOWN]]
    if diagnosis.verdict == "nothing":
        none = sum(p for ids, p in diagnosis.posterior if not {*ids} - _not_effects(diagnosis))
        parts = [f"no effect {_probability(none)}"]
    said = [f"Probability: {', '.join(parts)}"] if parts else []
    gain = diagnosis.gain
    if gain is not None and gain.held_out_rows and len(gain.ladder) > 1:
        low, high = (1e3 * end for end in gain.interval_95)
        said.append(
            f"The correction gains {decimal(low, 2)} to {decimal(high, 2)} mm (95 %) on {gain.held_out_rows} "
            f"{gain.judged_rows}"
        )
    elif gain is not None and not gain.held_out_rows:
        said.append("No row can judge a correction, so nothing is named")
    doubts = [cause.id for cause in _effects(diagnosis) if cause.doubt and cause.matters]
    if doubts:
        said.append(f"In doubt: {enumerated(doubts)}")
    return "; ".join(said[:1] + [f"{one[0].lower()}{one[1:]}" for one in said[1:]]) + "."


def _next(diagnosis: Outcome) -> str:
    if diagnosis.good_enough or diagnosis.verdict == "nothing":
        return "Nothing to correct."
    if diagnosis.verdict == "named" and diagnosis.model.effects:
        return "Correct the readings with this model."
    if diagnosis.next_measurements:
        said = proposal_text(diagnosis.next_measurements[0])
        return f"{said[0].upper()}{said[1:]}."
    if diagnosis.unexplained is not None:
        return f"Look at what changes with {diagnosis.unexplained.against}."
    return "Look at the rows of the report."


def _told(diagnosis: Outcome) -> list[Cause]:
    """Causes that the first line is about: those that are named, and faults of rows and columns."""
    least = diagnosis.settings.claims.named
    named = [
        cause
        for cause in diagnosis.causes
        if cause.probability >= least and not cause.doubt and cause.matters and cause.id not in listed_only()
    ]
    effects = [c for c in named if c.kind != "noise" and (c.in_model or c.kind != "effect")]
    return effects or [cause for cause in named if cause.kind == "noise"]


def _effects(diagnosis: Outcome) -> list[Cause]:
    return [cause for cause in diagnosis.causes if cause.kind == "effect"]


def _not_effects(diagnosis: Outcome) -> set[str]:
    return {cause.id for cause in diagnosis.causes if cause.kind != "effect"}


def _probability(value: float) -> str:
    return f"above {_CERTAIN}" if value >= _CERTAIN else f"{value:.2f}"


def _rms(meters: float) -> str:
    return mm_text(meters) if meters < 1e-3 else f"{decimal(1e3 * meters)} mm"


def _base(diagnosis: Outcome) -> str:
    speed = diagnosis.base["device_speed"]
    return str(diagnosis.base["law"]) if speed is None else f"{speed:g} m/s"
