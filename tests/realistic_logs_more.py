"""More of them: scripts, dashboards, robots, radio; and all kinds by name."""

import json
from collections.abc import Callable

from realistic_logs import KINDS as FIRST
from realistic_logs import Made, Truth, text_log

__all__ = ["LOGS"]


def maxbotix(t: Truth) -> Made:
    return text_log(
        "minicom.cap",
        [f"R{d * 1000:04.0f}" for d in t.distance],
        ["--at", "temperature=18+-5"],
        temperature=False,
        time=False,
    )


def ros(t: Truth) -> Made:
    head = "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.radiation_type,field.field_of_view,field.min_range,field.max_range,field.range"
    stamps = [int((t.start.timestamp() + s) * 1e9) for s in t.seconds]
    lines = [
        f"{w},{n},{w},sonar,0,0.26,0.02,4.0,{d:.4f}"
        for n, (w, d) in enumerate(zip(stamps, t.distance, strict=True))
    ]
    return text_log("range.csv", [head, *lines], ["--at", "temperature=18+-5"], temperature=False)


def micropython(t: Truth) -> Made:
    return text_log(
        "repl.txt",
        [
            "MicroPython v1.22.0 on 2023-12-27",
            ">>> main()",
            *(f"({int(s)}, {d * 100:.2f}, {c})" for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)),
        ],
        ["--options"],
        time=False,
    )


def senix(t: Truth) -> Made:
    head = [
        "SenixVIEW Data Log",
        "Model: TSPC-30S1-485",
        "Serial Number: 60212",
        "",
        "Date,Time,Distance (in),Temperature (F)",
    ]
    lines = [
        f"{w},{d / 0.0254:.3f},{c * 1.8 + 32:.2f}"
        for w, (d, c, _) in zip(t.times("%m/%d/%Y,%H:%M:%S"), t.rows, strict=True)
    ]
    return text_log("senix.csv", head + lines)


def grafana(t: Truth) -> Made:
    lines = [f'"{w}","{d * 100:.2f} cm","{c} °C"' for w, (d, c, _) in zip(t.times(), t.rows, strict=True)]
    return text_log("Tank-data-2024.csv", ['"Time","Distance","Outside Temperature"', *lines], [])


def ttn(t: Truth) -> Made:
    lines = [
        json.dumps(
            {
                "end_device_ids": {"device_id": "tank-7"},
                "received_at": w,
                "uplink_message": {
                    "f_port": 2,
                    "decoded_payload": {"distance_mm": round(d * 1000), "air_temp_c": c, "batt_v": 3.6},
                    "rx_metadata": [{"rssi": -97}],
                },
            }
        )
        for w, (d, c, _) in zip(t.times("%Y-%m-%dT%H:%M:%S.123456789Z"), t.rows, strict=True)
    ]
    return text_log("ttn.json", lines, ["--column", "distance_mm=reading_mm"])


def line_protocol(t: Truth) -> Made:
    lines = [
        f"tank,site=roof distance_cm={d * 100:.2f},temperature_C={c} {int((t.start.timestamp() + s) * 1e9)}"
        for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)
    ]
    return text_log("points.lp", lines, ["--column", "distance_cm=reading_cm"])


def mobaxterm(t: Truth) -> Made:
    lines = [
        f"[{w}] dist={d * 100:.2f}cm temp={c}C hum={h}%"
        for w, (d, c, h) in zip(t.times(), t.rows, strict=True)
    ]
    return text_log("session.log", ["[2024-01-01 00:00:00] boot ok", *lines])


def key_values(t: Truth) -> Made:
    lines = [f"Distance: {d * 100:.2f} cm, Temperature: {c} C" for d, c, _ in t.rows]
    lines[33] = "Out of range"
    return text_log("serial.txt", ["HC-SR04 test", *lines], time=False)


def python_logging(t: Truth) -> Made:
    lines = [
        f"{w},123 INFO distance: {d:.4f} m temperature: {c} C"
        for w, (d, c, _) in zip(t.times(), t.rows, strict=True)
    ]
    return text_log("sensor.log", lines)


def blanks(t: Truth) -> Made:
    lines = [f"{s:8.1f} {2 * d / 343:12.9f} {c:6.1f}" for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)]
    return text_log("run.dat", ["# time_s  echo_s  temperature_C", *lines])


def savetxt(t: Truth) -> Made:
    lines = [f"{s:.6e},{2 * d / 343:.9e},{c:.6e}" for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)]
    return text_log("run.csv", ["# time_s,echo_s,temperature_C", *lines])


def excel_sep(t: Truth) -> Made:
    lines = [
        f"{w};{d * 100:.2f};{c:.1f}".replace(".", ",")
        for w, (d, c, _) in zip(t.times("%Y-%m-%d %H:%M:%S"), t.rows, strict=True)
    ]
    return text_log("export.csv", ["sep=;", "Zeitstempel;Entfernung [cm];Temperatur [°C]", *lines])


def utf16(t: Truth) -> Made:
    lines = [f"{w}\t{d * 100:.2f}\t{c}" for w, (d, c, _) in zip(t.times(), t.rows, strict=True)]
    return Made(
        "unicode.txt",
        "\r\n".join(["Timestamp\tDistance (cm)\tTemperature (°C)", *lines]).encode("utf-16"),
        ["--encoding", "utf-16"],
    )


def epoch(t: Truth) -> Made:
    lines = [
        f"{t.start.timestamp() + s:.0f},{d * 100:.2f},{c},{h}"
        for s, (d, c, h) in zip(t.seconds, t.rows, strict=True)
    ]
    return text_log("epoch.csv", ["timestamp,distance,temperature,humidity", *lines], ["--options"])


def no_header(t: Truth) -> Made:
    lines = [f"{w},{d * 100:.2f},{c}" for w, (d, c, _) in zip(t.times(), t.rows, strict=True)]
    return text_log("LOG0001.CSV", lines, ["--options"], time=False)


def thingspeak_json(t: Truth) -> Made:
    feeds = [
        {"created_at": w, "entry_id": n, "field1": f"{d * 100:.2f}", "field2": str(c)}
        for n, (w, (d, c, _)) in enumerate(zip(t.times("%Y-%m-%dT%H:%M:%SZ"), t.rows, strict=True), 1)
    ]
    whole = {
        "channel": {"id": 7, "name": "tank", "field1": "Distance (cm)", "field2": "Temperature (C)"},
        "feeds": feeds,
    }
    return Made("feeds.json", json.dumps(whole).encode())


def two_units_rows(t: Truth) -> Made:
    head = ["Time,Distance,AirTemp,RH", "UTC,cm,degC,%"]
    return text_log(
        "station.csv",
        head + [f"{w},{d * 100:.2f},{c},{h}" for w, (d, c, h) in zip(t.times(), t.rows, strict=True)],
    )


KINDS = (
    maxbotix,
    ros,
    micropython,
    senix,
    grafana,
    ttn,
    line_protocol,
    mobaxterm,
    key_values,
    python_logging,
    blanks,
    savetxt,
    excel_sep,
    utf16,
    epoch,
    no_header,
    thingspeak_json,
    two_units_rows,
)

LOGS: dict[str, Callable[[Truth], Made]] = {made.__name__: made for made in (*FIRST, *KINDS)}
