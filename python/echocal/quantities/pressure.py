"""Air pressure."""

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import PRESSURE

FACTS = QuantityFacts(
    id="pressure",
    words="pressure",
    example=95e3,
    forms=(Form("pressure", "pressure", PRESSURE, ("air pressure",), (25e3, 120e3)),),
    shown=Shown("hPa", 0.01),
    possible=(1.0, float("inf")),
    dead=(0.0,),
    standard_name="air_pressure",
    why_no_codes="no codes of a barometer are defined",
)
