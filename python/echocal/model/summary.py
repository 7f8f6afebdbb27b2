"""Summary of an effect: its facts in words, and its typical error in millimeters."""

from echocal.model.composition import Model
from echocal.quantities import QUANTITIES
from echocal.registry import Effect

__all__ = ["DISTANCE", "TEMPERATURES", "facts", "millimeters", "typical_errors"]

DISTANCE = 2.0  # [m]
TEMPERATURES = (0.0, 20.0, 40.0)  # [degC]


def typical_errors(effect: Effect) -> tuple[float, ...]:
    """Return the error [m] that an effect of typical size makes at 2 m, at 0, 20 and 40 degC.

    The size is the one that theory knows, else one scale of the prior above neutral.

    Examples
    --------
    >>> from echocal.registry import find_effect
    >>> [round(1e3 * error, 2) for error in typical_errors(find_effect("fixed_delay"))]
    [4.97, 5.15, 5.33]
    """
    sizes = [parameter for parameter in effect.parameters if parameter.role == "size"]
    values = {p.name: p.known[0] if p.known else p.neutral + p.prior_scale for p in sizes}
    model = Model(effect.extends[0] if effect.extends else "linear", {effect.id: values})
    recorded = {name: QUANTITIES[name].example for name in effect.requires if name != "temperature"}
    indications = (model.indicate(DISTANCE, temperature=t, **recorded) for t in TEMPERATURES)
    return tuple(indication - DISTANCE for indication in indications)


def millimeters(error: float, digits: int) -> str:
    """Write an error [m] in mm with its sign; nothing is not negative."""
    return f"{round(1e3 * error, digits) + 0.0:+.{digits}f} mm"


def facts(effect: Effect) -> dict[str, str]:
    """Return what is known besides formula and parameters, in reading order; only what there is.

    Examples
    --------
    >>> from echocal.registry import find_effect
    >>> facts(find_effect("humidity"))["firmware"]
    'compensated where the device has relative_humidity'
    """
    typical = zip(typical_errors(effect), TEMPERATURES, strict=True)
    all_ = {
        f"typical at {DISTANCE:g} m": ", ".join(f"{millimeters(e, 2)} at {t:g} degC" for e, t in typical),
        "reads": ", ".join(effect.reads),
        "needs recorded": ", ".join(effect.requires),
        "only if not recorded": ", ".join(effect.excludes),
        "not with laws that read": effect.supplies or "",
        "only beside": ", ".join(f"law {law}" for law in effect.extends),
        "holds for": effect.domain,
        "check": effect.check,
        "firmware": _on_a_device(effect),
        "source": effect.source,
    }
    return {name: text for name, text in all_.items() if text}


def _on_a_device(effect: Effect) -> str:
    """Say whether a firmware compensates the effect, and why not."""
    if effect.firmware == "folded":
        return "compensated within the tables"
    detail = str(effect.firmware_detail)
    if effect.firmware == "refused":
        return f"not compensated: {detail}"
    if QUANTITIES[detail].codes is None:
        return f"not compensated: it needs {detail} ({QUANTITIES[detail].why_no_codes})"
    return f"compensated where the device has {detail}"
