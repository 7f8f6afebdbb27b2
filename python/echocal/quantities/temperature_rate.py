"""Rate of change of the recorded temperature."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="temperature_rate",
    words="temperature rate",
    example=1e-3,
    why_no_codes="a device converts one echo at a time and keeps no earlier temperatures",
)
