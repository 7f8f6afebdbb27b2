"""Logs as loggers and spreadsheets write them, with fresh numbers: text or bytes, and what they hold."""

import gzip
import io
import json
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

import numpy as np

__all__ = ["Made", "Truth", "drawn", "text_log"]


@dataclass(frozen=True)
class Truth:
    """What a log holds: distance [m] of each row, temperature [degC], and seconds."""

    distance: np.ndarray
    temperature: np.ndarray
    humidity: np.ndarray
    seconds: np.ndarray
    start: datetime

    def times(self, form: str = "%Y-%m-%d %H:%M:%S", ahead: int = 0) -> list[str]:
        """Times of a clock that is some hours ahead of UTC."""
        start = self.start + timedelta(hours=ahead)
        return [(start + timedelta(seconds=float(s))).strftime(form) for s in self.seconds]

    @property
    def rows(self) -> list[tuple[float, float, float]]:
        return list(
            zip(self.distance.tolist(), self.temperature.tolist(), self.humidity.tolist(), strict=True)
        )


@dataclass(frozen=True)
class Made:
    """A log as a file."""

    name: str
    content: bytes
    flags: list[str] = field(default_factory=list)
    """At most one flag, for what only its owner knows."""
    readings: int = 1
    """Readings that a row of the truth has."""
    temperature: bool = True
    time: bool = True


def drawn(random: np.random.Generator, rows: int = 80) -> Truth:
    """Draw a target that stands still in air that warms up, read by a device that assumes 343 m/s."""
    temperature = np.round(np.linspace(5.0, 30.0, rows) + random.normal(0.0, 0.3, rows), 1)
    far = random.uniform(0.8, 3.0)
    distance = far * 343.0 / (331.4 + 0.6 * temperature) + random.normal(0.0, 1e-3, rows)
    humidity = np.round(np.linspace(80.0, 40.0, rows) + random.normal(0.0, 1.0, rows), 1)
    start = datetime(2024, int(random.integers(1, 13)), int(random.integers(13, 28)), 6, 0, 0, tzinfo=UTC)
    return Truth(np.round(distance, 4), temperature, humidity, np.arange(rows) * 600.0, start)


def text_log(name: str, lines: list[str], flags: list[str] | None = None, **kind: object) -> Made:
    return Made(name, ("\n".join(lines) + "\n").encode(), flags or [], **kind)  # type: ignore[arg-type]


def commonest(t: Truth) -> Made:
    lines = [f"{d * 100:.2f},{c:.1f}" for d, c, _ in t.rows]
    return text_log("log.csv", ["Distance (cm),Temp (°C)", *lines], time=False)


def toa5(t: Truth) -> Made:
    head = [
        '"TOA5","roof","CR1000","1234","CR1000.Std.32","CPU:snow.CR1","4321","Table10"',
        '"TIMESTAMP","RECORD","DT_Avg","AirTC_Avg","RH","BattV_Min","PTemp_C_Avg"',
        '"TS","RN","m","Deg C","%","Volts","Deg C"',
        '"","","Avg","Avg","Smp","Min","Avg"',
    ]
    rows = [
        f'"{w}",{n},{"NAN" if n == 7 else f"{d:.4f}"},{c},{h},12.6,{c + 2:.1f}'
        for n, (w, (d, c, h)) in enumerate(zip(t.times(), t.rows, strict=True))
    ]
    return text_log("roof.dat", head + rows)


def serial_monitor(t: Truth) -> Made:
    lines = []
    for w, (d, c, _) in zip(t.times("%H:%M:%S.199"), t.rows, strict=True):
        lines += [f"{w} -> Distance: {d * 100:.2f} cm", f"{w} -> Temperature: {c} °C"]
    return text_log("putty.log", ["06:00:00.000 -> ets Jul 29 2019 12:21:46", *lines])


def german_excel(t: Truth) -> Made:
    lines = ["Datum;Uhrzeit;Abstand (cm);Lufttemperatur (°C)"]
    for w, (d, c, _) in zip(t.times("%d.%m.%Y;%H:%M"), t.rows, strict=True):
        lines.append(
            f"{w};{d * 100:.2f};{c:.1f}".replace(".", ",").replace(",", ".", 2)
            if False
            else f"{w};" + f"{d * 100:.2f};{c:.1f}".replace(".", ",")
        )
    return Made("messung.csv", ("\r\n".join(lines) + "\r\n").encode("cp1252"))


def two_columns_of_time(t: Truth) -> Made:
    lines = [
        f"{w},{d * 1000:.0f},{c}"
        for w, (d, c, _) in zip(t.times("%m/%d/%Y,%I:%M:%S %p"), t.rows, strict=True)
    ]
    return text_log("log.txt", ["Date,Time,Range [mm],Air Temp [C]", *lines])


def corrupt_line(t: Truth) -> Made:
    lines = [
        f"{w},{d * 100:.2f},{c}" for w, (d, c, _) in zip(t.times("%Y-%m-%dT%H:%M:%SZ"), t.rows, strict=True)
    ]
    lines[20] = lines[20][:23] + "\ufffd#" + lines[20][25:]
    lines[30] += ",12.5,9,9"
    lines.insert(40, "# moved the shield")
    lines.insert(50, "time,reading_cm,temperature_C")
    return text_log("sd.csv", ["time,reading_cm,temperature_C", *lines])


def bursts(t: Truth) -> Made:
    names = ",".join(f"obs {n}" for n in range(1, 6))
    lines = [
        f"{w},{c}," + ",".join(f"{d * 100 + k / 100:.2f}" for k in range(5))
        for w, (d, c, _) in zip(t.times(), t.rows, strict=True)
    ]
    return text_log(
        "bursts.csv", [f"time,temperature_C,{names}", *lines], ["--column", "obs=reading_cm"], readings=5
    )


def excel(t: Truth) -> Made:
    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    sheet.title = "Messwerte"
    sheet.append(["Tank 7, logged by J."])
    sheet.append([])
    sheet.append(["Date", "Distance [mm]", "Temperature [°C]"])
    for s, (d, c, _) in zip(t.seconds, t.rows, strict=True):
        sheet.append([(t.start + timedelta(seconds=float(s))).replace(tzinfo=None), round(d * 1000, 1), c])
    buffer = io.BytesIO()
    book.save(buffer)
    return Made("tank.xlsx", buffer.getvalue())


def json_lines(t: Truth) -> Made:
    lines = [
        json.dumps({"ts": w, "distance_mm": round(d * 1000, 1), "temp_c": c})
        for w, (d, c, _) in zip(t.times("%Y-%m-%dT%H:%M:%SZ"), t.rows, strict=True)
    ]
    lines[11] = lines[11][:17]
    return text_log("log.jsonl", lines, ["--column", "distance_mm=reading_mm"])


def zipped(t: Truth) -> Made:
    return Made("log.csv.gz", gzip.compress(commonest(t).content), time=False)


def arduino_sd(t: Truth) -> Made:
    lines = [
        f"{int(s * 1000)},{2e6 * d / 343:.0f},{c}" for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)
    ]
    return text_log("DATALOG.TXT", ["millis,duration_us,temp_c", *lines], [])


def esphome(t: Truth) -> Made:
    lines = ["[05:59:59][I][app:102]: ESPHome version 2024.5.0 compiled on May 20 2024"]
    for w, (d, c, _) in zip(t.times("%H:%M:%S"), t.rows, strict=True):
        lines += [
            f"[{w}][D][ultrasonic.sensor:040]: 'Tank distance' - Got distance: {d:.3f} m",
            f"[{w}][D][sensor:094]: 'Tank distance': Sending state {d:.5f} m with 2 decimals of accuracy",
            f"[{w}][D][sensor:094]: 'Outside Temperature': Sending state {c:.5f} °C with 1 decimals of accuracy",  # noqa: E501
        ]
    return text_log("esphome.log", lines)


def home_assistant(t: Truth) -> Made:
    lines = ["entity_id,state,last_changed"]
    for w, (d, c, _) in zip(t.times("%Y-%m-%dT%H:%M:%S.000Z"), t.rows, strict=True):
        lines += [f"sensor.outdoor_temperature,{c},{w}", f"sensor.tank_distance,{d * 100:.2f},{w}"]
    lines.append("sensor.outdoor_temperature,unavailable,2024-12-31T23:00:00.000Z")
    return text_log("history.csv", lines, ["--options"])


def influx(t: Truth) -> Made:
    head = "#group,false,false,true,true,false,false,true,true\n#datatype,string,long,dateTime:RFC3339,dateTime:RFC3339,dateTime:RFC3339,double,string,string\n#default,_result,,,,,,,"  # noqa: E501
    names = ",result,table,_start,_stop,_time,_value,_field,_measurement"
    lines = [*head.split("\n"), names]
    stamps = t.times("%Y-%m-%dT%H:%M:%SZ")
    lines += [
        f",,0,{stamps[0]},{stamps[-1]},{w},{d * 100:.2f},distance_cm,tank"
        for w, d in zip(stamps, t.distance, strict=True)
    ]
    lines += ["", *head.split("\n"), names]
    lines += [
        f",,1,{stamps[0]},{stamps[-1]},{w},{c},temperature_C,tank"
        for w, c in zip(stamps, t.temperature, strict=True)
    ]
    return text_log("query.csv", lines, ["--column", "distance_cm=reading_cm"])


def thingspeak(t: Truth) -> Made:
    lines = [
        f"{w} UTC,{n},{d * 100:.2f},{c}"
        for n, (w, (d, c, _)) in enumerate(zip(t.times(), t.rows, strict=True), 1)
    ]
    return text_log("feeds.csv", ["created_at,entry_id,field1,field2", *lines], ["--options"])


def labview(t: Truth) -> Made:
    head = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t.",  # noqa: E501
        "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative", "Operator\tlab", "Date\t2024/05/31", "Time\t14:00:00.0",  # noqa: E501
        "***End_of_Header***\t", "\t", "Channels\t2\t\t", f"Samples\t{len(t.seconds)}\t{len(t.seconds)}\t",
        "Date\t2024/05/31\t2024/05/31\t", "Time\t14:00:00.0\t14:00:00.0\t", "Y_Unit_Label\tcm\tdegC\t",
        "X_Dimension\tTime\tTime\t", "X0\t0.0\t0.0\t", "Delta_X\t600\t600\t", "***End_of_Header***\t\t\t",
        "X_Value\tDistance\tTemperature\tComment",
    ]  # fmt: skip
    lines = [f"{s:.6f}\t{d * 100:.6f}\t{c:.6f}" for s, (d, c, _) in zip(t.seconds, t.rows, strict=True)]
    return text_log("run1.lvm", head + lines, ["--column", "X_Value=time_s"])


def hobo(t: Truth) -> Made:
    head = [
        '"Plot Title: snow 3"',
        '"#","Date Time, GMT-05:00","Temp, °C (LGR S/N: 1021, SEN S/N: 1021, LBL: air)","Distance, cm (LGR S/N: 1021, SEN S/N: 7)","Batt, V (LGR S/N: 1021)"',  # noqa: E501
    ]
    lines = [
        f"{n},{w},{c},{d * 100:.2f},3.55"
        for n, (w, (d, c, _)) in enumerate(zip(t.times("%m/%d/%y %I:%M:%S %p", -5), t.rows, strict=True), 1)
    ]
    return Made("snow3.csv", ("\ufeff" + "\n".join(head + lines) + "\n").encode())


KINDS = (
    commonest,
    toa5,
    serial_monitor,
    german_excel,
    two_columns_of_time,
    corrupt_line,
    bursts,
    excel,
    json_lines,
    zipped,
    arduino_sd,
    esphome,
    home_assistant,
    influx,
    thingspeak,
    labview,
    hobo,
)
