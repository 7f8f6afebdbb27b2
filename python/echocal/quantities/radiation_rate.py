"""Rate of change of the irradiance."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="radiation_rate",
    words="radiation rate",
    example=0.1,
    why_no_codes="a device converts one echo at a time and keeps no earlier irradiance",
)
