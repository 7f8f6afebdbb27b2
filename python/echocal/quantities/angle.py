"""Angle of incidence on the target."""

from math import pi

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import ANGLE

FACTS = QuantityFacts(
    id="angle",
    words="angle",
    example=0.1,
    forms=(Form("angle", "angle", ANGLE, (), (-pi / 2, pi / 2), holds="angle of incidence"),),
    shown=Shown("deg", 180 / pi),
    why_no_codes="a device does not know how its target is turned",
)
