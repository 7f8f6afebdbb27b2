"""Wind speed."""

from echocal.quantities.facts import QuantityFacts
from echocal.quantities.form import Form
from echocal.quantities.units import SPEED

FACTS = QuantityFacts(
    id="wind_speed",
    words="wind speed",
    example=3.0,
    forms=(Form("wind", "wind_speed", SPEED, ("wind speed",), (0.0, 120.0)),),
    suspect="the wind, or how well it airs the instruments",
    standard_name="wind_speed",
    why_no_codes="no codes of an anemometer are defined",
)
