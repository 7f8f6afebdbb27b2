"""Sentences of NMEA 0183 of several kinds, or of a depth sounder (``$SDDPT,1.85,0.0*6B``): refused."""

import re
from collections.abc import Sequence

from echocal.errors import DataError
from echocal.observations.readers.log import Log

NAME = "sentences of NMEA 0183"

_DEPTHS = {"DBK", "DBS", "DBT", "DPT"}
_SENTENCE = re.compile(r"[$!](?P<kind>[A-Z]{2}[A-Z0-9]{3}),.*")


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are such sentences; those of one other kind are rows of a table without names."""
    look = [_SENTENCE.match(line.strip()) for line in lines[:100]]
    kinds = {match["kind"][2:] for match in look if match}
    return 2 * sum(map(bool, look)) > len(look) and (len(kinds) > 1 or bool(kinds & _DEPTHS))


def read(lines: Sequence[str], path: str) -> Log:
    """Refuse the sentences: each kind has other fields, and depth sounders measure in water.

    Raises `DataError` always.
    """
    kinds = dict.fromkeys(m["kind"] for line in lines if (m := _SENTENCE.match(line.strip())))
    raise DataError(
        f"{path} has {NAME} ({', '.join(list(kinds)[:4])}), whose fields differ from kind to kind. Write the "
        "values of a sensor in air as a table with names and units (time, distance_cm, temperature_C). A "
        "depth sounder measures in water, and echocal has the speed of sound in air only"
    )
