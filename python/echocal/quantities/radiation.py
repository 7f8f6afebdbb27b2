"""Irradiance on the thermometer's shield."""

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import ILLUMINANCE, IRRADIANCE

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
        Form(
            "illuminance",
            "radiation",
            ILLUMINANCE,
            ("daylight",),
            (-50.0, 2000.0),
            stand_in=True,
            holds="daylight instead of the irradiance, 110 lm/W; a further column beside an irradiance",
        ),
    ),
    shown=Shown("W/m2"),
    suspect="the sun on the thermometer or the hygrometer",
    why_no_codes="no codes of a pyranometer are defined",
)
