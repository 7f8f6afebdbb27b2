"""Supply voltage of the sensor."""

from echocal.quantities.facts import QuantityFacts
from echocal.quantities.form import Form
from echocal.quantities.units import VOLTAGE

FACTS = QuantityFacts(
    id="supply_voltage",
    words="supply voltage",
    example=4.8,
    forms=(Form("supply", "supply_voltage", VOLTAGE, ("supply voltage",), (0.0, 60.0)),),
    dead=(0.0,),
    suspect="the supply",
    why_no_codes="no codes of a voltmeter are defined",
)
