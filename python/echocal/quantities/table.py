"""The influence quantities: one entry each, in the order of the core.

The core lists the quantities and holds what physics reads of them (`rust/core/src/conditions.rs`,
one line each). An entry here holds the rest. Every other place asks these entries.
"""

from math import inf, pi

from echocal.codes import HumidityCodes, TemperatureCodes
from echocal.quantities.facts import Form, QuantityFacts, Shown
from echocal.quantities.units import (
    ANGLE,
    CLOCK,
    FRACTION,
    ILLUMINANCE,
    IRRADIANCE,
    MOLE_FRACTION,
    NUMBER,
    PERCENT,
    PRESSURE,
    SPEED,
    TEMPERATURE,
    VOLTAGE,
)

ENTRIES: tuple[QuantityFacts, ...] = (
    # Air temperature.
    QuantityFacts(
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
        possible=(-273.15, inf),
        dead=(0.0, -127.0),  # DS18B20: DEVICE_DISCONNECTED_C of its library
        suspect="an error of the thermometer or of the law's slope",
        standard_name="air_temperature",
        codes=TemperatureCodes,
        workshop=(5.0, 35.0),  # a fridge and a warm box
        judged_outside=True,
    ),
    # Relative humidity over liquid water.
    QuantityFacts(
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
    ),
    # Air pressure.
    QuantityFacts(
        id="pressure",
        words="pressure",
        example=95e3,
        forms=(Form("pressure", "pressure", PRESSURE, ("air pressure",), (25e3, 120e3)),),
        shown=Shown("hPa", 0.01),
        possible=(1.0, inf),
        dead=(0.0,),
        standard_name="air_pressure",
        why_no_codes="no codes of a barometer are defined",
    ),
    # Mole fraction of carbon dioxide.
    QuantityFacts(
        id="co2_mole_fraction",
        words="CO2 mole fraction",
        example=1e-3,
        forms=(Form("co2", "co2_mole_fraction", MOLE_FRACTION, (), (0.0, 1.0), holds="carbon dioxide"),),
        shown=Shown("ppm", 1e6),
        possible=(0.0, 1.0),
        dead=(0.0,),
        standard_name="mole_fraction_of_carbon_dioxide_in_air",
        why_no_codes="no codes of a CO2 sensor are defined",
    ),
    # Time since the first row.
    QuantityFacts(
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
    ),
    # Supply voltage of the sensor.
    QuantityFacts(
        id="supply_voltage",
        words="supply voltage",
        example=4.8,
        forms=(Form("supply", "supply_voltage", VOLTAGE, ("supply voltage",), (0.0, 60.0)),),
        dead=(0.0,),
        suspect="the supply",
        why_no_codes="no codes of a voltmeter are defined",
    ),
    # Angle of incidence on the target.
    QuantityFacts(
        id="angle",
        words="angle",
        example=0.1,
        forms=(Form("angle", "angle", ANGLE, (), (-pi / 2, pi / 2), holds="angle of incidence"),),
        shown=Shown("deg", 180 / pi),
        why_no_codes="a device does not know how its target is turned",
    ),
    # Wind speed.
    QuantityFacts(
        id="wind_speed",
        words="wind speed",
        example=3.0,
        forms=(Form("wind", "wind_speed", SPEED, ("wind speed",), (0.0, 120.0)),),
        suspect="the wind, or how well it airs the instruments",
        standard_name="wind_speed",
        why_no_codes="no codes of an anemometer are defined",
    ),
    # Irradiance on the thermometer's shield.
    QuantityFacts(
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
    ),
    # Echo amplitude relative to full scale.
    QuantityFacts(
        id="amplitude",
        words="amplitude",
        example=0.5,
        forms=(
            Form("amplitude", "amplitude", FRACTION, (), (0.0, 1.0), holds="echo amplitude, of full scale"),
        ),
        why_no_codes="no codes of an echo's amplitude are defined",
    ),
    # Rate of change of the recorded temperature.
    QuantityFacts(
        id="temperature_rate",
        words="temperature rate",
        example=1e-3,
        why_no_codes="a device converts one echo at a time and keeps no earlier temperatures",
    ),
    # Temperature recorded some rows later.
    *(
        QuantityFacts(
            id=f"temperature_later_{rows}",
            words=f"temperature later {rows}",
            example=20.0 + 0.3 * rows,
            why_no_codes="a device does not know later temperatures",
        )
        for rows in range(1, 6)
    ),
    # Rate of change of the irradiance.
    QuantityFacts(
        id="radiation_rate",
        words="radiation rate",
        example=0.1,
        why_no_codes="a device converts one echo at a time and keeps no earlier irradiance",
    ),
    # Position of a row in its burst, 0 for the first.
    QuantityFacts(
        id="position_in_group",
        words="position in group",
        example=0.0,
        why_no_codes="a function of one echo does not know its place in a burst",
    ),
    # Hour angle of the local clock, 0 at noon.
    QuantityFacts(
        id="hour_angle",
        words="hour angle",
        example=0.0,
        why_no_codes="a device has no clock of the day",
    ),
    # Temperature of a further thermometer, taken for the air on the path.
    QuantityFacts(
        id="second_temperature",
        words="second temperature",
        example=19.0,
        possible=(-273.15, inf),
        why_no_codes="no codes of a second thermometer are defined",
    ),
    # Temperature of a further thermometer, taken for that of the ranger's own.
    QuantityFacts(
        id="device_temperature",
        words="device temperature",
        example=21.0,
        possible=(-273.15, inf),
        why_no_codes="no codes of a second thermometer are defined",
    ),
    # Quality number of an echo, as the ranger or its logger gives it.
    QuantityFacts(
        id="echo_quality",
        words="echo quality",
        example=190.0,
        forms=(
            Form("echo_quality", "echo_quality", NUMBER, (), holds="quality number of the echo, in no unit"),
        ),
        suspect="soft, wet or rough ground",
        why_no_codes="no codes of an echo's quality are defined",
    ),
)
