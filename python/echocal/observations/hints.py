"""What a column holds by its name and its unit, where both leave one reading only."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from echocal.errors import DataError
from echocal.observations.found import Found
from echocal.observations.names import IGNORE, by_name, by_request
from echocal.observations.units import NAMES
from echocal.observations.units_said import split_unit, symbol_of

__all__ = ["Hint", "completed", "hint", "is_time_name", "refusal_of_levels", "role_of"]

_LENGTH = ("m", "cm", "mm", "inch")
_TIME = ("us", "ms", "s")
_WORDS: dict[str, tuple[tuple[str, ...], set[str]]] = {
    "distance": (_LENGTH, {
        "actual", "true", "real", "reference", "ref", "ruler", "tape", "taped", "nominal", "expected", "soll",
        "referenz", "truth", "gt", "known", "wahr", "tatsächlich", "laser", "lidar", "set",
    }),
    "reading": (_LENGTH, {
        "distance", "dist", "distanz", "abstand", "entfernung", "range", "reading", "indication", "measured",
        "measurement", "messwert", "sonar", "ultrasonic", "ultraschall", "ultrasound", "sr04", "hcsr04", "jsn",
        "sr04t", "jsnsr04t", "maxbotix", "sr50", "sr50a", "sr50at", "tcdt", "dt", "a02yyuw", "hrlv", "hrxl",
        "afstand", "distancia", "distanza", "avstand", "afstandssensor", "ping", "toughsonic", "echodistance",
    }),
    "echo": (_TIME, {
        "echo", "tof", "flight", "pulse", "pulsewidth", "laufzeit", "duration", "echotime", "pulsein", "roundtrip",
    }),
    "temperature": (("C", "K", "F"), {
        "temp", "temperature", "temperatur", "lufttemperatur", "air", "airtemp", "airtc", "airtf", "ambient",
        "tair", "temperatura", "température", "temperatuur", "t", "ta", "tc", "aussentemperatur", "outdoor",
        "tempc", "tempf", "dht22", "dht11", "ds18b20", "bme280", "sht31", "airt",
    }),
    "humidity": (("percent",), {
        "rh", "humidity", "hum", "feuchte", "luftfeuchte", "luftfeuchtigkeit", "humid", "relhum", "rf",
        "humidité", "humedad", "relativehumidity",
    }),
    "pressure": (("Pa", "hPa", "kPa", "mbar"), {
        "pressure", "press", "pres", "baro", "barometer", "luftdruck", "bp", "barometric", "druck", "slp", "p",
    }),
    "co2": (("ppm",), {"co2"}),
    "wind": (("m_s", "km_h"), {"wind", "windspeed", "ws", "windgeschwindigkeit"}),
    "radiation": (("W_m2",), {"slr", "slrw", "solar", "radiation", "globalstrahlung", "irradiance", "swin", "ghi"}),
    "illuminance": (("lux",), {"light", "lux", "illuminance", "helligkeit", "als"}),
    "supply": (("V", "mV"), {"vcc", "supply", "vdd"}),
}  # fmt: skip
"""Units and words of each quantity."""

_NOT = {
    "temperature": {
        "box", "panel", "ptemp", "board", "logger", "cpu", "mcu", "internal", "case", "housing", "battery",
        "batt", "pi", "rtc", "soil", "water", "dew", "dewpoint", "ground", "surface", "object", "chill", "index",
        "feels", "setpoint", "target", "snow", "road", "second", "device", "chip", "core", "wet", "enclosure",
        "pyrot", "taupunkt", "boden", "wasser", "body", "probe2", "inside", "indoor", "ir", "pyro",
    },
    "humidity": {"soil", "boden", "box", "internal", "logger", "moisture"},
    "pressure": {"water", "vapor", "vapour", "diff", "differential", "tire", "wasser", "sea"},
    "reading": {
        "depth", "level", "height", "hoehe", "höhe", "tiefe", "stand", "offset", "error", "err",
        "resolution", "threshold", "filtered", "corrected", "travelled", "traveled", "path", "twoway",
    },
    "wind": {"dir", "direction", "gust"},
}  # fmt: skip
"""Words that make it something else."""

_NEVER = {
    "max",
    "min",
    "std",
    "stdev",
    "sd",
    "tmx",
    "tmn",
    "var",
    "variance",
    "error",
    "err",
    "diff",
    "delta",
}
"""A statistic of several values, or what is no value."""

_TOKEN = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-zà-ÿ]+\d*|[A-Z]+\d*|\d+")
_STATISTIC = re.compile(r"[_ .](?:avg|mean|smp|inst|median|mittelwert)$", re.IGNORECASE)
_TIMES = {
    "timestamp", "datetime", "date time", "date_time", "time stamp", "zeitstempel", "zeitpunkt", "date/time",
    "datum/uhrzeit", "created_at", "_time", "received_at", "last_changed", "time_utc", "time [utc]", "utc",
    "time (utc)", "timestamp_utc", "utc_time", "datum uhrzeit", "datumzeit", "last_updated", "recorded_at",
    "date_heure", "horodatage", "fecha", "yyyy-mm-dd", "hh:mm", "hh:mm:ss", "dd.mm.yyyy", "measured_at", "time local", "date and time",
}  # fmt: skip
"""Names of columns of times."""

_COUNTERS = {"millis": "time_ms", "millis()": "time_ms", "micros": "time_us", "micros()": "time_us"}
"""Functions of Arduino and MicroPython."""

_CLOCK_UNITS = ("us", "ms", "s", "min", "h")
_SINCE = {
    "timestamp",
    "elapsed",
    "uptime",
    "ticks",
    "seconds",
    "zeit",
    "time",
    "millis",
    "micros",
    "runtime",
    "clock",
}
_NO_CLOCK = {
    "flight", "echo", "pulse", "tof", "duration", "transit", "travel", "laufzeit", "response", "delay", "return",
    "round", "measured", "diff",
}  # fmt: skip
_CLOCKS = {
    "timestamps",
    "time", "date", "timestamp", "datetime", "datum", "uhrzeit", "zeit", "zeitstempel", "clock", "ts", "utc",
    "heure", "hora", "fecha", "created", "received", "changed", "epoch", "unix", "unixtime", "stamp", "tijd",
}  # fmt: skip


@dataclass(frozen=True)
class Hint:
    """What a foreign name and its unit say.

    Attributes
    ----------
    name : str
        The column in echocal's way: ``reading_cm``.
    sure : bool
        Whether this cannot be another quantity.
    """

    name: str
    sure: bool = True


def hint(column: str, unit: str = "") -> Hint | None:
    """What a column may hold by its name and its unit; None where they say nothing, or too little.

    Parameters
    ----------
    unit : str
        Unit that the log gives beside the name.

    Examples
    --------
    >>> hint("Distance (cm)"), hint("AirTC_Avg", "Deg C"), hint("level [m]")
    (Hint(name='reading_cm', sure=False), Hint(name='temperature_C', sure=True), None)
    """
    if column.strip().lower() in _TIMES or column.strip().lower().startswith(("date time,", "date-time")):
        return Hint("time")
    words, own = split_unit(_STATISTIC.sub("", column))
    symbol = symbol_of(unit) or own
    if column.strip().lower() in _COUNTERS:
        return Hint(_COUNTERS[column.strip().lower()])
    if not symbol:
        return None
    tokens = {token.lower() for token in _TOKEN.findall(words)}
    tokens |= {"".join(sorted_pair) for sorted_pair in zip(_listed(words), _listed(words)[1:], strict=False)}
    if tokens & _NEVER:
        return None
    since = _SINCE - {"time", "zeit"} if symbol == "us" else _SINCE  # a time in us may be that of the echo
    if symbol in _CLOCK_UNITS and tokens & since and not tokens & _NO_CLOCK:
        return Hint(f"time_{symbol}")
    for role, (units, known) in _WORDS.items():
        if symbol in units and tokens & known and not tokens & _NOT.get(role, set()):
            name = _name(role, symbol)
            return Hint(name, role not in {"reading"} or not tokens & {"distance", "dist", "abstand"})
    return None


def is_time_name(column: str) -> bool:
    """Whether a column is called as columns of times are."""
    tokens = {token.lower() for token in _TOKEN.findall(column)} | {column.strip().lower()}
    never = {"flight", "echo", "pulse", "tof", "diff", "transit", "delta", "interval", "response", "duration"}
    return not tokens & never and bool(tokens & _CLOCKS or column.strip().lower() in _TIMES)


def completed(
    columns: Collection[str], requests: Mapping[str, str], found: Found | None = None
) -> tuple[dict[str, str], list[str]]:
    """Requests, with those that names and units add, and a sentence on these.

    What echocal's own names and the requests hold stays as it is; where two columns may hold the same, none
    is taken.
    """
    beside = found or Found()
    requests = {**{c: r for c, r in beside.requests.items() if c in columns}, **requests}
    held = _held(columns, requests)
    hints: dict[str, list[tuple[str, Hint]]] = {}
    for column in columns:
        unit = beside.units.get(column, "")
        if column in requests or _is_ours(column, unit):
            continue
        if said := hint(column, unit):
            hints.setdefault(NAMES[said.name][0].quantity, []).append((column, said))
    notes: list[str] = []
    _drop_unsure(hints, held, notes)
    taken: dict[str, str] = {}
    for quantity, listed in hints.items():
        if quantity in held:
            continue
        if len(listed) > 1:
            notes.append(_several(listed))
            continue
        (column, said), *_ = listed
        taken[column] = said.name
    if taken:
        listed_ = ", ".join(f"'{column}' as {name}" for column, name in taken.items())
        first = next(iter(taken))
        notes.insert(
            0,
            f'read by name and unit: {listed_}; if one is something else: --column "{first}=extra", or =ignore',
        )
    return {**taken, **requests}, notes


def _drop_unsure(found: dict[str, list[tuple[str, Hint]]], held: set[str], notes: list[str]) -> None:
    """Leave out a distance that, beside an echo time or a reading, may as well be the reference."""
    readings = found.get("reading", [])
    unsure = [(column, said) for column, said in readings if not said.sure]
    if not unsure or (
        len(readings) == 1 and not {"echo_time", "reading"} & (held | set(found) - {"reading"})
    ):
        return
    if len(unsure) == len(readings) and not {"echo_time", "reading"} & (held | set(found) - {"reading"}):
        return  # several distances and nothing else: `_several` asks
    for column, said in unsure:
        reference = said.name.replace("reading", "distance")
        given = f'--column "{column}={reference}", or "{column}={said.name}"'
        notes.append(f"'{column}' is not used, it may be the reference or a reading; to use it: {given}")
    found["reading"] = [pair for pair in readings if pair[1].sure]
    if not found["reading"]:
        del found["reading"]


def refusal_of_levels(columns: Collection[str], units: Mapping[str, str]) -> str:
    """The request for the only column of a length, for a message; empty where there are more."""
    lengths = [(c, symbol_of(units.get(c, "")) or split_unit(c)[1]) for c in columns]
    lengths = [(column, unit) for column, unit in lengths if unit in _LENGTH]
    return f"{lengths[0][0]}=reading_{lengths[0][1]}" if len(lengths) == 1 else ""


def _several(listed: list[tuple[str, Hint]]) -> str:
    names = " and ".join(f"'{column}'" for column, _ in listed)
    column, said = listed[0]
    return (
        f'{names} may both hold {said.name}, and neither is used; say which: --column "{column}={said.name}"'
    )


def _name(role: str, symbol: str) -> str:
    return f"{role}_{symbol}" if f"{role}_{symbol}" in NAMES else role


def _listed(words: str) -> list[str]:
    return [token.lower() for token in _TOKEN.findall(words)]


def _is_ours(column: str, unit: str) -> bool:
    """Whether a name is one of echocal's; one that lacks its unit is none where the log gives the unit."""
    try:
        return by_name(column) is not None
    except DataError:
        return not symbol_of(unit)


def _held(columns: Collection[str], requests: Mapping[str, str]) -> set[str]:
    """Quantities that echocal's own names and the requests hold."""
    held = set()
    for column in columns:
        request = requests.get(column)
        if request is not None and request.strip() == IGNORE:
            continue
        try:
            found = by_name(column) if request is None else by_request(column, request)
        except (DataError, ValueError):
            continue
        if found is not None and not found[0].several:
            held.add(found[0].quantity)
    return held


def role_of(column: str) -> str:
    """Which quantity a name without a unit speaks of; empty for none.

    Examples
    --------
    >>> role_of("distance"), role_of("Temp"), role_of("battery")
    ('reading', 'temperature', '')
    """
    words, _ = split_unit(_STATISTIC.sub("", column))
    tokens = {token.lower() for token in _TOKEN.findall(words)}
    if tokens & _NEVER:
        return ""
    roles = (
        role for role, (_, known) in _WORDS.items() if tokens & known and not tokens & _NOT.get(role, set())
    )
    return next(roles, "")
