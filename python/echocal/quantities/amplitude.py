"""Echo amplitude relative to full scale."""

from echocal.quantities.facts import QuantityFacts
from echocal.quantities.form import Form
from echocal.quantities.units import FRACTION

FACTS = QuantityFacts(
    id="amplitude",
    words="amplitude",
    example=0.5,
    forms=(Form("amplitude", "amplitude", FRACTION, (), (0.0, 1.0), holds="echo amplitude, of full scale"),),
    why_no_codes="no codes of an echo's amplitude are defined",
)
