"""Readings and references in different units."""

from echocal.diagnose.facts import CauseFacts, Quantity
from echocal.diagnose.faults.finding import Finding
from echocal.diagnose.faults.ratio import divided, factor_of
from echocal.diagnose.faults.view import View
from echocal.diagnose.result import Parameter

__all__ = ["FACTS", "detect"]

_UNITS = {
    2.54: "cm where inches are meant",
    1 / 2.54: "inches where cm are meant",
    25.4: "mm where inches are meant",
    1 / 25.4: "inches where mm are meant",
    10.0: "mm where cm are meant, or a shifted decimal point",
    0.1: "cm where mm are meant, or a shifted decimal point",
    100.0: "cm where m are meant",
    0.01: "m where cm are meant",
    1000.0: "mm where m are meant, or us where ms are meant",
    0.001: "m where mm are meant, or ms where us are meant",
    0.3048: "feet where m are meant",
    1 / 0.3048: "m where feet are meant",
}

FACTS = CauseFacts(
    id="unit_mixup",
    kind="gross",
    sentence="Readings and reference distances stand in different units.",
    signature="reading / reference = 2.54, 10, 25.4, 100, 1000, 0.3048, or one over these, in every row",
    source="jeremylindsayni/Bifrost.Arduino.Sensors.HCSR04 #5: 332 m/s commented as 3320 cm/s",
    parameters=(Quantity("factor", "1", "reading over what it should be"),),
    check="look up in the device's program which unit it prints",
    prior=0.01,
)


def detect(view: View) -> Finding | None:
    """Compare the median ratio of reading and reference with the ratios of units."""
    found = factor_of(view, (2.0, 0.5, *_UNITS))
    if found is None or found.value not in _UNITS:
        return None
    because = (
        f"readings are {found.ratio:.4g} times the reference distance (median of all rows), as if one of the "
        f"columns were in another unit: {_UNITS[found.value]}"
    )
    return Finding(
        FACTS,
        found.log_bayes,
        f"{because}; the rest of the diagnosis divides them by {found.value:.4g}",
        (Parameter("factor", found.value, 0.0, "1"),),
        view.observations.usable,
        divided(view, found.value, "reading_m"),
    )
