"""Time since the first row."""

from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import CLOCK

FACTS = QuantityFacts(
    id="elapsed_time",
    words="elapsed time",
    example=3600.0,
    forms=(
        Form(
            "time",
            "elapsed_time",
            CLOCK,
            ("elapsed time",),
            holds=(
                "when (`time` is ISO 8601); counts from the earliest row; times of day (in the time zone "
                "that is given) also give the position of the sun"
            ),
        ),
    ),
    shown=Shown("days", 1 / 86400),
    column="time",
    suspect="a slow drift",
    why_no_codes="a device does not know how long it has been in use",
    runs_on=True,
)
