"""Temperature recorded some rows later."""

from echocal.quantities.facts import QuantityFacts

FACTS = {
    f"temperature_later_{rows}": QuantityFacts(
        id=f"temperature_later_{rows}",
        words=f"temperature later {rows}",
        example=20.0 + 0.3 * rows,
        why_no_codes="a device does not know later temperatures",
    )
    for rows in range(1, 6)
}
