"""Which of the quantities of a log the ranger gives, and which change without jumps."""

from collections.abc import Mapping, Sequence

from echocal.observations.hints import hint, role_of
from echocal.observations.units import split_unit, symbol_of

__all__ = ["changes_smoothly", "ranger_names"]

_LEADS = (
    "distance",
    "dist",
    "abstand",
    "entfernung",
    "echo",
    "reading",
    "range",
    "ultrasonic",
    "sonar",
    "tank",
    "level",
)
_LENGTHS = {"m", "cm", "mm", "inch", "ft"}
_AIR_UNITS = {"C", "F", "K", "percent", "Pa", "hPa", "kPa", "mbar", "ppm", "m_s", "km_h", "W_m2", "lux"}
_AIR = (
    "temp", "humid", "press", "luft", "feuchte", "druck", "wind", "radiation", "solar", "light", "lux",
    "co2", "thermo", "dew", "taupunkt", "hum", "rh",
)  # fmt: skip


def ranger_names(names: Sequence[str], units: Mapping[str, str]) -> list[str]:
    """Names that are the ranger's own: those that say a reading or an echo; else those that may be.

    Examples
    --------
    >>> ranger_names(["Temp", "Echo took", "Got distance"], {"Echo took": "us", "Got distance": "m"})
    ['Echo took', 'Got distance']
    >>> ranger_names(["outdoor", "tank"], {}), ranger_names(["a", "b"], {"b": "cm"})
    (['tank'], ['b'])
    """
    said = [name for name in names if _says(name, units.get(name, ""))]
    alike = [name for word in _LEADS for name in names if word in name.lower()]
    lengths = [name for name in names if (symbol_of(units.get(name, "")) or symbol_of(name)) in _LENGTHS]
    return said or alike[:1] or lengths[:1]


def changes_smoothly(name: str, unit: str) -> bool:
    """Whether a quantity is one of the air, which goes from one value to the next without a jump."""
    if (symbol_of(unit) or split_unit(name)[1] or symbol_of(name)) in _AIR_UNITS:
        return True
    return any(word in name.lower() for word in _AIR)


def _says(name: str, unit: str) -> bool:
    said = hint(name, unit)
    if said is not None:
        return said.name.startswith(("reading", "echo_")) and said.name != "echo_quality"
    return role_of(name) in {"reading", "echo"}
