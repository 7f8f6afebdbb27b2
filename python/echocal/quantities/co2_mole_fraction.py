"""Mole fraction of carbon dioxide."""

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import MOLE_FRACTION

FACTS = QuantityFacts(
    id="co2_mole_fraction",
    words="CO2 mole fraction",
    example=1e-3,
    forms=(Form("co2", "co2_mole_fraction", MOLE_FRACTION, (), (0.0, 1.0), holds="carbon dioxide"),),
    shown=Shown("ppm", 1e6),
    possible=(0.0, 1.0),
    dead=(0.0,),
    standard_name="mole_fraction_of_carbon_dioxide_in_air",
    why_no_codes="no codes of a CO2 sensor are defined",
)
