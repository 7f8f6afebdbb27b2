"""Words of columns, by which foreign names are understood."""

import re

LENGTH = ("m", "cm", "mm", "inch", "ft")
TIME = ("us", "ms", "s")
WORDS: dict[str, tuple[tuple[str, ...], set[str]]] = {
    "distance": (LENGTH, {
        "exp",
        "actual", "true", "real", "reference", "ref", "ruler", "tape", "taped", "nominal", "expected", "soll",
        "referenz", "truth", "gt", "known", "wahr", "tatsächlich", "laser", "lidar", "set",
    }),
    "reading": (LENGTH, {
        "distance", "dist", "distanz", "abstand", "entfernung", "range", "reading", "indication", "measured",
        "measurement", "messwert", "sonar", "ultrasonic", "ultraschall", "ultrasound", "sr04",
        "hcsr04", "jsn",
        "sr04t", "jsnsr04t", "maxbotix", "sr50", "sr50a", "sr50at", "tcdt", "dt", "a02yyuw", "hrlv", "hrxl",
        "afstand", "distancia", "distanza", "avstand", "afstandssensor", "ping", "toughsonic", "echodistance",
    }),
    "echo": (TIME, {
        "echo", "tof", "flight", "pulse", "pulsewidth", "laufzeit", "duration", "echotime",
        "pulsein", "roundtrip",
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
        "pressure", "press", "pres", "baro", "barometer", "luftdruck", "bp", "barometric", "druck",
        "slp", "p",
    }),
    "co2": (("ppm",), {"co2"}),
    "wind": (("m_s", "km_h"), {"wind", "windspeed", "ws", "windgeschwindigkeit"}),
    "radiation": (("W_m2",), {
        "slr", "slrw", "solar", "radiation", "globalstrahlung", "irradiance", "swin", "ghi",
    }),
    "illuminance": (("lux",), {"light", "lux", "illuminance", "helligkeit", "als"}),
    "supply": (("V", "mV"), {"vcc", "supply", "vdd"}),
}  # fmt: skip
"""Units and words of each quantity."""

NOT = {
    "temperature": {"ob", "onboard",
        "box", "panel", "ptemp", "board", "logger", "cpu", "mcu", "internal", "case", "housing", "battery",
        "batt", "pi", "rtc", "soil", "water", "dew", "dewpoint", "ground", "surface", "object",
        "chill", "index",
        "feels", "setpoint", "target", "snow", "road", "second", "device", "chip", "core", "wet", "enclosure",
        "pyrot", "taupunkt", "boden", "wasser", "body", "probe2", "inside", "indoor", "ir", "pyro",
    },
    "humidity": {"ob", "onboard", "soil", "boden", "box", "internal", "logger", "moisture"},
    "pressure": {"water", "vapor", "vapour", "diff", "differential", "tire", "wasser", "sea"},
    "reading": {
        "depth", "level", "height", "hoehe", "höhe", "tiefe", "stand", "offset", "error", "err",
        "resolution", "threshold", "filtered", "corrected", "travelled", "traveled", "path", "twoway",
    },
    "wind": {"dir", "direction", "gust"},
    "distance": {"level", "levels", "pegel", "stage", "waterlevel", "wasserstand"},
}  # fmt: skip
"""Words that make it something else."""

LEVELS = {
    "level", "levels", "stage", "depth", "pegel", "waterlevel", "wasserstand", "snow", "tiefe", "niveau",
}  # fmt: skip
"""Words of what rises as the distance falls: its values are no distance, however usual they are for one."""

LETTERS = {"t", "p", "d", "r"}

NEVER = {
    "max", "min", "std", "stdev", "sd", "tmx", "tmn", "var", "variance", "error", "err", "diff", "delta",
}  # fmt: skip
"""A statistic of several values, or what is no value."""

TOKEN = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-zà-ÿ]+\d*|[A-Z]+\d*|\d+")
STATISTIC = re.compile(r"[_ .](?:avg|mean|smp|inst|median|mittelwert)$", re.IGNORECASE)
TIMES = {
    "timestamp", "datetime", "date time", "date_time", "time stamp", "zeitstempel", "zeitpunkt", "date/time",
    "datum/uhrzeit", "created_at", "_time", "received_at", "last_changed", "time_utc", "time [utc]", "utc",
    "time (utc)", "timestamp_utc", "utc_time", "datum uhrzeit", "datumzeit", "last_updated", "recorded_at",
    "date_heure", "horodatage", "fecha", "yyyy-mm-dd", "hh:mm", "hh:mm:ss", "dd.mm.yyyy", "measured_at",
    "time local", "date and time",
}  # fmt: skip
"""Names of columns of times."""

COUNTERS = {"millis": "time_ms", "millis()": "time_ms", "micros": "time_us", "micros()": "time_us"}
"""Functions of Arduino and MicroPython."""

CLOCK_UNITS = ("us", "ms", "s", "min", "h")
SINCE = {
    "timestamp", "elapsed", "uptime", "ticks", "seconds", "zeit", "time", "millis", "micros", "runtime",
    "clock",
}  # fmt: skip
NO_CLOCK = {
    "flight", "echo", "pulse", "tof", "duration", "transit", "travel", "laufzeit", "response", "delay",
    "return",
    "round", "measured", "diff",
}  # fmt: skip
CLOCKS = {
    "timestamps",
    "time", "date", "timestamp", "datetime", "datum", "uhrzeit", "zeit", "zeitstempel", "clock", "ts", "utc",
    "heure", "hora", "fecha", "created", "received", "changed", "epoch", "unix", "unixtime", "stamp", "tijd",
}  # fmt: skip

ELAPSED = {"diff", "difference", "differenz", "delta", "travel", "transit", "measured", "response"}
"""Words beside "time" that make it the time of an echo, and no clock."""

QUALITY = {"quality", "qualität", "qualitaet", "qualité"}
"""Of an echo."""

OF_QUALITY = {
    "echo", "number", "no", "nr", "value", "range", "ranger", "sonic", "distance", "reading", "measurement",
}  # fmt: skip
"""Words beside it with which it is no quality of the air, of a link or of a check."""
