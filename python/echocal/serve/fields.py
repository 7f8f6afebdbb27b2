"""The words of the page's fields: as its labels, and as messages name them."""

from collections.abc import Mapping

DISTANCES = {
    "column": "is a column, or there are placements",
    "constant": "is constant and not known",
    "known": "is constant and known",
}
"""What is known of the distance of the target."""
DISTANCE = "distance [m]"
PLACEMENTS = "ruler values of the placements [m], in their order"
TEMPERATURE = "temperature of the air [degC]"
HEIGHT = "mount height above the zero of a level [m]"
SPEED = "speed of sound of the readings: law, m/s"
BASE = "speed of sound that the base assumes: a law, or m/s"
STEP = "step of the thermometer [K]"
LARGEST = "largest error [mm]"

FIELDS: Mapping[str, str] = {
    "columns": "choose {1} beside '{0}'",
    "constant_distance": f'choose "{DISTANCES["constant"]}"',
    "reference_distance": f'"{DISTANCES["known"]}": {{1}}',
    "placements": f'"{PLACEMENTS}": {{1}}',
    "at.temperature": f'"{TEMPERATURE}": {{1}}',
    "mount_height": f'"{HEIGHT}": {{1}}',
    "reading_speed": f'"{SPEED}": {{1}}',
    "base": f'"{BASE}": {{1}}',
    "max_error": f'"{LARGEST}"',
}
"""Words of messages by keyword; a keyword with a point is one name of its mapping."""
