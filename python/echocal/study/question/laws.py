"""Suspects about the temperature: the program's law, the potentiometer, the record, the air."""

from echocal.study.question import scenes
from echocal.study.question.suspects import SUSPECTS, Free, Suspect

_RANDOM_TABLES = 20
_NO_AIR = "Tinkercad has no air"


def _speed(text: str) -> dict[str, str]:
    return {"SPEED(celsius)": f"({text})"}


_LAWS = (
    Suspect(
        "law_331_4",
        "331.4 + 0.6 T",
        "law",
        "The law that the study states.",
        _speed("331.4 + 0.6 * (celsius)"),
    ),
    Suspect("law_331_5", "331.5 + 0.6 T", "law", "A common intercept.", _speed("331.5 + 0.6 * (celsius)")),
    Suspect("law_332", "332 + 0.6 T", "law", "A rounded intercept.", _speed("332 + 0.6 * (celsius)")),
    Suspect("law_0_606", "331.3 + 0.606 T", "law", "A common slope.", _speed("331.3 + 0.606 * (celsius)")),
    Suspect(
        "law_root",
        "331.3 sqrt(1 + T / 273.15)",
        "law",
        "The law of an ideal gas.",
        _speed("331.3 * sqrt(1 + (celsius) / 273.15)"),
    ),
    Suspect(
        "law_integer",
        "speed as an integer",
        "law",
        "int or long for the speed cuts its decimals off.",
        _speed("(long)(331.3 + 0.6 * (celsius))"),
        cuts_off=True,
    ),
    Suspect(
        "law_intercept",
        "any other intercept",
        "law",
        "The program has another speed at 0 degC.",
        _speed("332.3 + 0.6 * (celsius)"),
        free=Free("intercept less 331.3 m/s", "m/s", -0.5, 0.7, 1.0, "intercepts in use, 330.8 to 332 m/s"),
    ),
)

_TEMPERATURES = (
    Suspect(
        "codes_1024",
        "1024 instead of 1023 codes",
        "thermometer",
        "analogRead() * 50 / 1024.",
        {"TEMPERATURE(code)": "((code) * 50.0 / 1024.0)"},
    ),
    Suspect(
        "map_integer",
        "map() cuts the temperature off",
        "thermometer",
        "map(code, 0, 1023, 0, 50) gives whole degrees below.",
        {"TEMPERATURE(code)": "(map((code), 0, 1023, 0, 50))"},
        cuts_off=True,
    ),
    Suspect(
        "whole_degrees",
        "whole degrees shown, decimals used",
        "thermometer",
        "The potentiometer is turned until the display shows the degree, and the law takes the decimals.",
        scene=scenes.whole_degrees,
        tables=_RANDOM_TABLES,
    ),
    Suspect(
        "thermometer_offset",
        "temperature too high",
        "thermometer",
        "The program takes a higher temperature than the table says.",
        {"TEMPERATURE(code)": "((code) * 50.0 / 1023.0 + 2)"},
        free=Free("offset", "K", -1.0, 1.0, 2.0, "the study's own 'increment of approximately 1 degC'"),
    ),
    Suspect(
        "next_row",
        "reading of the next row",
        "record",
        "The potentiometer was turned before the reading was copied.",
        scene=scenes.next_row,
        cuts_off=True,  # rows are 1 or 2 degC apart
    ),
    Suspect(
        "hand",
        "potentiometer set by hand, within 1 K",
        "setting",
        "The temperature is set to about the degree, and the degree is written down.",
        scene=scenes.hand(1.0),
        tables=_RANDOM_TABLES,
    ),
    Suspect(
        "target_moved",
        "target placed anew for each row, within 5 mm",
        "setting",
        "A label that shows whole centimeters looks right within 5 mm.",
        scene=scenes.moved(5e-3),
        tables=_RANDOM_TABLES,
    ),
    Suspect(
        "dry_air",
        "true dry air",
        "air",
        "The speed of real air is no straight line.",
        scene=scenes.air,
        absent=_NO_AIR,
    ),
    Suspect(
        "damp_air",
        "true air of 50 % humidity",
        "air",
        "Vapor makes sound faster, and more so in warm air.",
        scene=scenes.damp_air,
        absent=_NO_AIR,
    ),
    Suspect(
        "comparator",
        "comparator of a real HC-SR04",
        "air",
        "Its pulse begins late and ends when the echo reaches a threshold; air of 50 % humidity.",
        scene=scenes.comparator,
        absent="Tinkercad's module has no transducer",
    ),
)

ALL = (*SUSPECTS, *_LAWS, *_TEMPERATURES)
"""All suspects, in the order of the page."""


def suspect(id_: str) -> Suspect:
    """Return a suspect by its name.

    Examples
    --------
    >>> suspect("pulse_in").place
    'timer'
    """
    return {one.id: one for one in ALL}[id_]
