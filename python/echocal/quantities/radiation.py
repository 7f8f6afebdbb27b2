"""Irradiance on the thermometer's shield."""

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import IRRADIANCE

FACTS = QuantityFacts(
    id="radiation",
    words="radiation",
    example=500.0,
    forms=(
        Form(
            "radiation",
            "radiation",
            IRRADIANCE,
            ("irradiance",),
            (-50.0, 2000.0),  # pyranometers read slightly below zero at night
            holds="irradiance on the thermometer's shield",
        ),
    ),
    shown=Shown("W/m2"),
    suspect="the sun on the thermometer or the hygrometer",
    why_no_codes="no codes of a pyranometer are defined",
)
