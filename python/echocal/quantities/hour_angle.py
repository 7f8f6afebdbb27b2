"""Hour angle of the local clock, 0 at noon."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="hour_angle",
    words="hour angle",
    example=0.0,
    why_no_codes="a device has no clock of the day",
)
