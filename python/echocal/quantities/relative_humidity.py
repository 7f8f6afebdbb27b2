"""Relative humidity over liquid water."""

from echocal.codes import HumidityCodes
from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import FRACTION, PERCENT

FACTS = QuantityFacts(
    id="relative_humidity",
    words="relative humidity",
    example=0.5,
    forms=(
        Form(
            "humidity",
            "relative_humidity",
            PERCENT,
            ("humidity",),
            (0.0, 1.0),
            (0.015, 1.0),  # a median below 1.5 % looks like a fraction
            also=("relative_humidity",),
            holds="relative humidity",
        ),
        Form(
            "relative_humidity",
            "relative_humidity",
            FRACTION,
            ("relative humidity",),
            (0.0, 1.0),
            also=("humidity_percent",),
            holds="relative humidity, 0 to 1 or in percent",
        ),
    ),
    shown=Shown("%", 100.0),
    possible=(0.0, 1.0),
    dead=(0.0,),
    suspect="an error of the hygrometer that grows with humidity",
    standard_name="relative_humidity",
    codes=HumidityCodes,
    judged_outside=True,
)
