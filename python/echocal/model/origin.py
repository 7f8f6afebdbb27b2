"""What the provenance of a model says of the diagnosis that it comes from, in lines for people."""

from collections.abc import Mapping
from typing import Any


def diagnosed(provenance: Mapping[str, Any]) -> list[str]:
    """Verdict, class and member of each cause, and gain; empty where no diagnosis has left them.

    A provenance is free text for other programs, too: what is not as `echocal diagnose` writes it is left
    out.

    Examples
    --------
    >>> cause = {"id": "fixed_delay", "probability": 0.97, "indistinguishable_from": []}
    >>> diagnosed({"verdict": "named", "causes": [cause]})
    ['verdict: named', 'cause fixed_delay: probability 0.970']
    >>> diagnosed({"gain": "large", "causes": 3})
    []
    """
    lines = []
    if isinstance(verdict := provenance.get("verdict"), str):
        lines.append(f"verdict: {verdict}")
    causes = provenance.get("causes")
    for cause in causes if isinstance(causes, list | tuple) else []:
        lines += _tried(_cause, cause)
    gain = _tried(_gain, provenance.get("gain"))
    return lines + (gain if causes else gain[:1])


def _tried(line: Any, given: Any) -> list[str]:
    try:
        return [*line(given)]
    except (TypeError, KeyError, ValueError, IndexError, AttributeError):
        return []


def _cause(cause: Mapping[str, Any]) -> list[str]:
    id_, rivals = str(cause["id"]), list(cause["indistinguishable_from"])
    together = f"{float(cause['probability']):.3f}"
    if not rivals:
        return [f"cause {id_}: probability {together}"]
    alone = cause.get("probability_alone")
    own = "" if alone is None else f"; that it is {id_} itself: {float(alone):.3f}"
    return [
        f"cause {id_}: one of {1 + len(rivals)} causes that the data cannot separate. Probability that one "
        f"of them acts: {together}{own}",
        f"the others are {', '.join(map(str, rivals))}",
    ]


def _gain(gain: Mapping[str, Any]) -> list[str]:
    before, after = (1e3 * float(gain[name]) for name in ("rms_before_m", "rms_after_m"))
    low, high = (100 * float(end) for end in gain["variance_removed_interval_95"])
    part = 100 * float(gain["variance_removed"])
    return [
        f"RMS error on {int(gain['held_out_rows'])} rows ({gain['scheme']}): {before:.2f} mm with the base, "
        f"{after:.2f} mm with the model",
        f"part of the mean square error that the model removes there: {part:.0f} % "
        f"({low:.0f} to {high:.0f} %, 95 % interval)",
    ]
