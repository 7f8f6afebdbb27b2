"""Messages that a watch must survive: what each is, and whether it holds a row of an echo."""

import json
from typing import Any

import numpy as np

GOOD = {"sensor_id": "a", "time": "2026-01-01T00:00:00", "echo_us": 11660.0, "temperature_C": 20.0}


def _of(**fields: Any) -> bytes:
    return json.dumps({**GOOD, **fields}).encode()


def _without(*names: str) -> bytes:
    return json.dumps({name: value for name, value in GOOD.items() if name not in names}).encode()


def _raw(text: str) -> bytes:
    """A good row whose echo time is written as a text says."""
    return json.dumps(GOOD).replace("11660.0", text).encode()


def messages(random: np.random.Generator) -> dict[str, tuple[bytes, str]]:
    """By name: the payload, and its end: "aside" or the status of the row that it is."""
    size = int(random.integers(100_000, 300_000))
    found = {
        "empty": (b"", "aside"),
        "blank": (b"  \n\t ", "aside"),
        "random bytes": (random.bytes(int(random.integers(1, 3000))) + b"\xff", "aside"),
        "zeros": (b"\0" * 64, "aside"),
        "a picture": (b"\x89PNG\r\n\x1a\n" + random.bytes(2000), "aside"),
        "gzip": (b"\x1f\x8b\x08\0" + random.bytes(300), "aside"),
        "utf-16": (json.dumps(GOOD).encode("utf-16"), "aside"),
        "utf-8 cut in a sign": (_of(sensor_id="ä")[:20] + "ä".encode()[:1], "aside"),
        "latin-1": ('{"sensor_id": "Behälter", "echo_us": 11660}'.encode("latin-1"), "aside"),
        "half a sign": (b'{"sensor_id": "\\ud800", "echo_us": 11660, "temperature_C": 20}', "aside"),
        "half a sign in a name": (b'{"sensor_id": "a", "\\udfff": 1, "echo_us": 11660}', "aside"),
        "cut object": (_of()[: int(random.integers(1, len(_of()) - 1))], "aside"),
        "two objects": (_of() + _of(), "aside"),
        "object and more": (_of() + b"}", "aside"),
        "single quotes": (str(GOOD).encode(), "aside"),
        "a comma too many": (b'{"sensor_id": "a", "echo_us": 11660,}', "aside"),
        "a number": (b"42", "aside"),
        "a large number": (b"9" * 5000, "aside"),
        "a text": (b'"online"', "aside"),
        "a bare word": (b"online", "aside"),
        "true": (b"true", "aside"),
        "null": (b"null", "aside"),
        "NaN": (b"NaN", "aside"),
        "an empty object": (b"{}", "aside"),
        "an empty list": (b"[]", "aside"),
        "a list of numbers": (b"[1]", "aside"),
        "a list of null": (b"[null]", "aside"),
        "a list in a list": (b"[[" + _of() + b"]]", "aside"),
        "a cut list": (b"[" + _of(), "aside"),
        "a deep list": (b"[" * size + b"]" * size, "aside"),
        "deep objects": (b'{"a":' * size + b"1" + b"}" * size, "aside"),
        "half-deep objects": (_of(x=0).replace(b'"x": 0', b'"x": ' + b"[" * 900 + b"]" * 900), "aside"),
        "an object within objects": (_of(x=[{"y": [{"z": 1}]}]), ""),
        "a deep id": (b'{"echo_us": 1, "sensor_id": ' + b"[" * 500 + b"]" * 500 + b"}", "aside"),
        "a field twice": (b'{"sensor_id": "a", "echo_us": 1, "echo_us": 11660}', "aside"),
        "csv": (b"sensor_id,echo_us\na,11660\n", "aside"),
        "xml": (b"<row><echo_us>11660</echo_us></row>", "aside"),
        "a battery": (b'{"sensor_id": "a", "battery": 3.3}', "aside"),
        "no id": (_without("sensor_id"), "aside"),
        "id null": (_of(sensor_id=None), "aside"),
        "id empty": (_of(sensor_id=""), "aside"),
        "id blank": (_of(sensor_id="  "), "aside"),
        "id a list": (_of(sensor_id=["a"]), "aside"),
        "id an object": (_of(sensor_id={"a": 1}), "aside"),
        "id true": (_of(sensor_id=True), "aside"),
        "id NaN": (_of(sensor_id=float("nan")), "aside"),
        "id unknown": (_of(sensor_id="nobody"), "no model for sensor nobody"),
        "id a number": (_of(sensor_id=77), "no model for sensor 77"),
        "id a large number": (_of(sensor_id=10**300), f"no model for sensor {10**300}"),
        "id a path": (_of(sensor_id="../../etc/passwd"), "no model for sensor ../../etc/passwd"),
        "id of the index": (_of(sensor_id="index"), "no model for sensor index"),
        "id that is another's file": (_of(sensor_id="a/b"), "no model for sensor a/b"),
        "id with an end": (_of(sensor_id="a\0b"), "no model for sensor a\0b"),
        "id of a terminal": (_of(sensor_id="\x1b[2J\x07"), "no model for sensor \x1b[2J\x07"),
        "id of a megabyte": (_of(sensor_id="x" * 1_000_000), f"no model for sensor {'x' * 1_000_000}"),
        "no reading": (_without("echo_us"), "aside"),
        "reading null": (_of(echo_us=None), "echo_us missing"),
        "reading empty": (_of(echo_us=""), "echo_us missing"),
        "reading a text": (_of(echo_us="far"), "echo_us is no number"),
        "reading a list": (_of(echo_us=[11660]), "echo_us is no number"),
        "reading an object": (_of(echo_us={"v": 1}), "echo_us is no number"),
        "reading true": (_of(echo_us=True), "echo_us is no number"),
        "reading in text": (_of(echo_us="11660"), ""),
        "reading NaN": (_raw("NaN"), "echo_us missing"),
        "reading infinite": (_raw("Infinity"), "echo_us out of range"),
        "reading minus infinite": (_raw("-Infinity"), "echo_us out of range"),
        "reading too large for a float": (_raw("1e999"), "echo_us out of range"),
        "reading a huge integer": (_raw("9" * 400), "echo_us out of range"),
        "reading an integer beyond Python": (_raw("9" * 5000), "aside"),
        "reading negative": (_raw("-11660"), "echo_us out of range"),
        "temperature a text": (_of(temperature_C="warm"), "temperature_C is no number"),
        "temperature impossible": (_of(temperature_C=1e9), "temperature_C out of range"),
        "temperature absent": (_without("temperature_C"), "any"),
        "a name without a unit": (_of(temperature=20.0), "aside"),
        "an unknown unit": (_of(humidity_parsec=20.0), "aside"),
        "two of a quantity": (_of(echo_ms=11.66), "aside"),
        "a status": (_of(status="ok"), "aside"),
        "corrected before": (_of(corrected_distance_m=2.0), "aside"),
        "another topic": (_of(topic="tanks/8/echo"), "aside"),
        "an empty name": (_of(**{"": 1}), ""),
        "a name of a megabyte": (_of(**{"n" * 1_000_000: 1}), "aside"),
        "a name of blanks": (_of(**{"a" + " " * 1_000_000: 1}), "aside"),
        "a field of a megabyte": (_of(note="n" * 1_000_000), ""),
        "many fields": (_of(**{f"n{i}": i for i in range(20_000)}), "aside"),
        "an object in a field": (_of(rssi={"lora": -80}), ""),
        "time a number": (_of(time=1767225600), ""),
        "time a list": (_of(time=[2026]), ""),
        "time a text": (_of(time="yesterday"), ""),
        "time null": (_of(time=None), ""),
        "time huge": (_of(time="99999-01-01T00:00:00"), ""),
        "time of day": (_of(time="13:45"), ""),
        "time before all": (_of(time="0001-01-01T00:00:00"), ""),
        "time in 2262": (_of(time="2263-01-01T00:00:00"), ""),
    }
    return dict(found)


def good(number: int) -> bytes:
    """A good row, each at a time of its own."""
    time = str(np.datetime64("2026-01-01T00:10:00") + np.timedelta64(600 * number, "s"))
    return json.dumps({**GOOD, "time": time, "n": number}).encode()
