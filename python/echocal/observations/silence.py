"""Sentences by which a program says that no echo came: ``Retrying!``, ``Distance measurement timed out!``."""

import re

__all__ = ["NO_ECHO", "SILENT", "says_no_echo"]

NO_ECHO = "no echo"
"""Reason of a row whose line says that no echo came."""

SILENT = (
    r"time[ds]?[ _-]?out(?!\s*[:=]\s*\d)"
    r"|out[ _-]of[ _-](?:max\w*[ _-])?range|(?:over|beyond)[ _-](?:max\w*[ _-])?range"
    r"|no[ _-]?(?:echo|ping|pulse|object|obstacle|signal|reading|target|return|response|measure\w*|valid\w*)"
    r"|retry(?:ing)?|invalid|too[ _-](?:far|close)|not[ _-](?:detected|valid)|lost[ _-](?:echo|ping|pulse)"
    r"|(?:echo|ping|pulse)[ _-](?:was[ _-])?(?:lost|missed|missing)|nothing (?:in|within|detected)"
)
"""Words that say so, wherever the letters are small or large."""

_WORDS = re.compile(
    rf"(?i)(?<![a-z])(?:{SILENT}|error (?:getting|reading|measuring) (?:the )?distance)(?![a-z])"
)
_OTHERS = re.compile(
    r"(?i)(?<![a-z])(?:wi-?fi|mqtt|ntp|https?|tcp|udp|socket|server|broker|connect\w*|dht\w*|temp\w*|humid\w*"
    r"|dallas|ds18\w*|bme\w*|i2c|api|ota|dns|ip|client|login|password|lora\w*|modem|network)(?![a-z])"
)
"""Of which a line may speak instead."""
_ECHO_OF_CODE = re.compile(r"\s+warnings\.warn\(")


def says_no_echo(text: str) -> bool:
    """Whether a line says that no echo came.

    Examples
    --------
    >>> says_no_echo("'Tank' - Distance measurement timed out!"), says_no_echo("MQTT connection timed out")
    (True, False)
    >>> says_no_echo("Timeout: 11661 us")  # what it is set to
    False
    """
    return bool(_WORDS.search(text)) and not (_OTHERS.search(text) or _ECHO_OF_CODE.match(text))
