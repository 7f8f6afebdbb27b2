"""Temperature of a further thermometer, taken for that of the ranger's own."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="device_temperature",
    words="device temperature",
    example=21.0,
    possible=(-273.15, float("inf")),
    why_no_codes="no codes of a second thermometer are defined",
)
