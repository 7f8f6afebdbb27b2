"""Logs that were written after the readers, for kinds that nobody had in mind."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from realistic_logs import Truth, drawn
from test_readers_logs import FIXED, Run, shell

__all__ = ["shell"]

Lines = Callable[[Truth], list[str]]


def _timed(t: Truth, form: str, line: str, head: list[str]) -> list[str]:
    rows = zip(t.times(form), t.rows, strict=True)
    return [
        *head,
        *(
            line.format(w=w, m=d, cm=d * 100, mm=d * 1000, us=2e6 * d / 343, c=c, h=h)
            for w, (d, c, h) in rows
        ),
    ]


ISO = "%Y-%m-%d %H:%M:%S"
SURE: dict[str, Lines] = {
    "names below names": lambda t: _timed(
        t, "%m/%d/%Y %I:%M:%S %p", "{w},{c},{mm:.1f}",
        ["z6-01234,Port 1,Port 1", "Records: 80,ATMOS 41,Sonic", "Timestamps,°C Air Temperature,mm Distance"],
    ),
    "a separator at each end": lambda t: [
        line.replace(".", ",") for line in _timed(t, "%H:%M:%S", "{w};{mm:.1f};{c};", ["Zeit;Abstand [mm];Temp [°C];"])  # noqa: E501
    ],
    "Node-RED": lambda t: _timed(t, "%d/%m/%Y, %H:%M:%S", "{w} node: debug Object distance: {cm:.2f} cm temp: {c} °C", []),  # noqa: E501
    "journal": lambda t: _timed(t, "%b %d %H:%M:%S", "{w} raspberrypi python3[812]: distance={cm:.2f} cm temp={c} C", []),  # noqa: E501
    "R table": lambda t: [
        '"time" "echo_us" "temperature_C"',
        *(f'"{n}" {line}' for n, line in enumerate(_timed(t, ISO, '"{w}" {us:.1f} {c}', []))),
    ],
    "month by name": lambda t: _timed(t, "%d-%b-%Y %H:%M:%S", "{w},{mm:.1f},{c}", ["Time,Distance (mm),Air temperature (°C)"]),  # noqa: E501
    "openHAB": lambda t: _timed(t, ISO + ".000", "{w};{cm:.2f} cm;{c} °C", ["Time;Tank_Distance;Outdoor_Temperature"]),  # noqa: E501
    "date and clock without their names": lambda t: _timed(
        t, "%Y-%m-%d,%H:%M", "{w},{cm:.2f},{c},{h}", ["yyyy-mm-dd,HH:MM,Snow sensor distance [cm],TA [degC],RH [%]"]  # noqa: E501
    ),
    "French": lambda t: [
        line.replace(".", ",") for line in _timed(
            t, "%d/%m/%Y %H:%M:%S", "{w};{cm:.2f};{c}", ["Horodatage;Distance (cm);Température (°C)"])
    ],
    "a maximum beside": lambda t: _timed(t, ISO, "{w},{m:.4f},{c},{h}", ["Timestamp,SR50_raw [m],AirT [°C],AirT_max [°C]"]),  # noqa: E501
}  # fmt: skip
GUESSED: dict[str, Lines] = {
    "plotter": lambda t: _timed(t, ISO, "Distance:{cm:.2f},Temp:{c}", []),
    "Tasmota": lambda t: _timed(
        t, "%Y-%m-%dT%H:%M:%S",
        'tele/tank/SENSOR {{"Time":"{w}","SR04":{{"Distance":{cm:.2f}}},"DHT22":{{"Temperature":{c}}},"TempUnit":"C"}}', [],  # noqa: E501
    ),
    "PuTTY": lambda t: _timed(t, ISO, "{cm:.2f},{c}", ["=~=~=~=~=~= PuTTY log 2024.05.31 14:00:00 =~=~=~=~=~="]),  # noqa: E501
    "NMEA": lambda t: _timed(t, ISO, "$SDXDR,D,{m:.4f},M,SONAR,C,{c},C,AIR*5A", []),
    "names without units": lambda t: _timed(t, ISO, "{us:.1f},{c}", ["echo,t_dht"]),
}  # fmt: skip
REFUSED: dict[str, tuple[Lines, str]] = {
    "yards": (lambda t: _timed(t, ISO, "{w},{m:.3f},{c}", ["Date,Range (yd),Temp (C)"]), "does not convert"),
    "payloads": (lambda t: _timed(t, ISO, "{w},0a{us:.0f}ff", ["time,data"]), "No column has numbers"),
    "TOB1": (lambda t: ['"TOB1","roof","CR1000"', "x"], "convert it to TOA5 with CardConvert"),
    "thousands": (
        lambda t: _timed(t, ISO, '{w},"2,274 mm",{c}', ["Time,Distance,Temp (C)"]),
        "write plain numbers",
    ),
}


@pytest.mark.parametrize("kind", SURE)
def test_no_flag_is_needed(kind: str, shell: Run, random: np.random.Generator) -> None:
    Path("log.txt").write_text("\n".join(SURE[kind](drawn(random))) + "\n")
    _explained(shell)


@pytest.mark.parametrize("kind", GUESSED)
def test_one_flag_is_needed(kind: str, shell: Run, random: np.random.Generator) -> None:
    Path("log.txt").write_text("\n".join(GUESSED[kind](drawn(random))) + "\n")
    code, _, err = shell("diagnose", "log.txt", *FIXED, "-q")
    assert code == 3
    assert "inspect LOG -o log.toml" in err
    assert shell("inspect", "log.txt", "-o", "log.toml", "-q")[0] == 0
    _explained(shell, "--options", "log.toml")


@pytest.mark.parametrize("kind", REFUSED)
def test_what_cannot_be_read_is_refused_with_the_way_out(
    kind: str, shell: Run, random: np.random.Generator
) -> None:
    lines, message = REFUSED[kind]
    Path("log.txt").write_text("\n".join(lines(drawn(random))) + "\n")
    code, _, err = shell("diagnose", "log.txt", *FIXED, "-q")
    assert (code, err.count("\n")) == (3, 1)
    assert message in err


def _explained(shell: Run, *flags: str) -> None:
    code, out, err = shell("diagnose", "log.txt", *FIXED, "--json", "-", *flags)
    assert code == 0, err
    document = json.loads(out)
    assert document["rows"]["used"] == document["rows"]["total"] == 80
    assert document["gain"]["rms_before_m"] < 3e-3
