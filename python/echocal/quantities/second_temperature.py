"""Temperature of a further thermometer, taken for the air on the path."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="second_temperature",
    words="second temperature",
    example=19.0,
    possible=(-273.15, float("inf")),
    why_no_codes="no codes of a second thermometer are defined",
)
