"""Air temperature."""

from echocal.codes import TemperatureCodes
from echocal.quantities.facts import QuantityFacts
from echocal.quantities.form import Form
from echocal.quantities.units import TEMPERATURE

FACTS = QuantityFacts(
    id="temperature",
    words="temperature",
    example=17.0,
    forms=(
        Form(
            "temperature",
            "temperature",
            TEMPERATURE,
            ("air temperature",),
            (-95.0, 100.0),  # coldest air on record -89.2 degC (WMO); DS18B20 errors are 85 and -127
            (-60.0, 55.0),
            error_codes={"C": (85.0,)},  # DS18B20 at power-on
        ),
    ),
    possible=(-273.15, float("inf")),
    dead=(0.0, -127.0),  # DS18B20: DEVICE_DISCONNECTED_C of its library
    suspect="an error of the thermometer or of the law's slope",
    standard_name="air_temperature",
    codes=TemperatureCodes,
    workshop=(5.0, 35.0),  # a fridge and a warm box
    judged_outside=True,
)
