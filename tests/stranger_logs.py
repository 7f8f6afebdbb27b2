# ruff: noqa: E501, N806
"""Logs of kinds that the readers were not written for, with what they hold: drawn anew in each run."""

from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any

import numpy as np

__all__ = ["Expected", "logs"]

E, Z = "\x1b[0;36m", "\x1b[0m"
nan = float("nan")


@dataclass(frozen=True)
class Expected:
    """What a log holds.

    ``reading`` [m], ``echo`` [s] and ``temperature`` [degC] of each row, NaN where the log says that there is
    none; ``step`` [s] between rows. ``column``: what only its owner knows. ``ask``: it may not be read without a
    question, ``either``: it may. ``never``: columns that hold none of these. ``noextra``: copies.
    """

    lines: list[str]
    reading: Any = None
    echo: Any = None
    temperature: Any = None
    step: float | None = None
    column: dict[str, str] = field(default_factory=dict)
    ask: bool = False
    either: bool = False
    never: tuple[str, ...] = ()
    noextra: tuple[str, ...] = ()


def clock(n: int, step: int = 10) -> str:
    return (datetime(2024, 5, 14, 13, 55, 3) + timedelta(seconds=step * n)).strftime("%H:%M:%S")


def logs(r: np.random.Generator) -> dict[str, Expected]:
    """Draw all of them."""
    found: dict[str, Expected] = {}

    def case(name: str, lines: list[str], **given: Any) -> None:
        found[name] = Expected(lines, **given)

    N = 40
    D = (r.uniform(0.8, 2.5) + 0.1 * np.sin(np.arange(N) / 5) + r.normal(0, 0.003, N)).round(3)
    T = (r.uniform(12, 22) + 3 * np.sin(np.arange(N) / 7)).round(1)
    US = (D * 2e6 / 343).round()
    H = (50 + 10 * np.cos(np.arange(N) / 9)).round(1)
    lost = r.random(N) < 0.15
    lost[5] = True
    DL = np.where(lost, nan, D)
    # fmt: off
    case("ESPEasy",[f"{100000+10000*n} : Info  : ULTRASONIC : TaskNr: 1 Distance: {D[n]*100:.2f}" for n in range(N)],reading=D,step=10)
    case("arduino-esp32",[f"[{12034+10000*n:6d}][I][main.cpp:57] loop(): echo={US[n]:.0f} us dist={D[n]*100:.1f} cm t={T[n]} C" for n in range(N)],echo=US/1e6,temperature=T,step=10)
    case("ESP-IDF",[f"E ({1000*n}) ultrasonic: Echo timeout (no device or out of range)" if lost[n] else f"I ({1000*n}) ultrasonic: Distance: {D[n]:.3f} m" for n in range(N)],reading=DL,step=1)
    case("rospy",[f"[INFO] [{1623456789+n}.123]: range: {D[n]:.3f}" for n in range(N)],reading=D,step=1)
    case("zephyr",[f"[00:00:{n:02d}.234,000] <inf> hcsr04: distance {D[n]:.3f} m" for n in range(N)],reading=D,step=1)
    case("journal iso",[f"2024-05-14T{clock(n)}+0200 raspberrypi python3[812]: distance: {D[n]*100:.1f} cm temp: {T[n]} °C" for n in range(N)],reading=D,temperature=T,step=10)
    case("tasmota RSL",[x for n in range(N) for x in (f'{clock(n)}.101 RSL: STATE = {{"Time":"2024-05-14T{clock(n)}","Vcc":3.4,"Wifi":{{"RSSI":80}}}}',f'{clock(n)}.222 RSL: SENSOR = {{"Time":"2024-05-14T{clock(n)}","DS18B20":{{"Id":"0114","Temperature":{T[n]}}},"SR04":{{"Distance":{D[n]*100:.1f}}},"TempUnit":"C"}}')],reading=D,temperature=T,step=10)
    case("zigbee2mqtt",[f"Zigbee2MQTT:info  2024-05-14 {clock(n)}: MQTT publish: topic 'zigbee2mqtt/tank', payload '{{\"battery\":91,\"distance\":{D[n]:.3f},\"temperature\":{T[n]}}}'" for n in range(N)],reading=D,temperature=T,step=10)
    case("openHAB events",[f"2024-05-14 {clock(n)}.123 [INFO ] [openhab.event.ItemStateChangedEvent] - Item 'Tank_Distance' changed from {D[n-1]*100:.1f} to {D[n]*100:.1f}" for n in range(N)],reading=D,step=10)
    case("node-red csv epoch ms",["\"timestamp\",\"distance\",\"temp\""]+[f"{1715695000000+10000*n},{D[n]*1000:.0f},{T[n]}" for n in range(N)],reading=D,temperature=T,step=10)
    case("microbit",["Time (seconds),distance,temperature"]+[f"{10*n},{D[n]*100:.0f},{T[n]:.0f}" for n in range(N)],reading=D.round(2),temperature=T.round(),step=10)
    case("Ping example",[f"{int(D[n]/.0254)}in, {int(D[n]*100)}cm" for n in range(N)],reading=np.array([int(d*100) for d in D])/100)
    case("blocks",[x for n in range(N) for x in (f"Temperature: {T[n]} C",f"Distance: {D[n]*100:.1f} cm","")],reading=D,temperature=T)
    case("blocks begun within",["Distance: 119.9 cm",""]+[x for n in range(N) for x in (f"Temperature: {T[n]} C",f"Distance: {D[n]*100:.1f} cm","")],reading=np.append(1.199,D),temperature=np.append(nan,T))
    case("DHT tester",[f"Humidity: 45.{n%10}%  Temperature: {T[n]}°C {T[n]*1.8+32:.1f}°F  Distance: {D[n]*100:.1f}cm" for n in range(N)],reading=D,temperature=T)
    case("german units row",["Zeit;Entfernung;Lufttemperatur","hh:mm:ss;cm;°C"]+[f"{clock(n)};{D[n]*100:.1f};{T[n]}".replace(".",",") for n in range(N)],reading=D,temperature=T,step=10)
    case("no header temp first",[f"2024-05-14 {clock(n)},{T[n]},{D[n]*100:.1f}" for n in range(N)],reading=D,temperature=T,step=10)
    case("no header ms us cm",[f"{10000*n+5},{US[n]:.0f},{D[n]*100:.1f}" for n in range(N)],echo=US/1e6)
    case("sec,cm,C",["sec,cm,C"]+[f"{10*n},{D[n]*100:.1f},{T[n]}" for n in range(N)],reading=D,temperature=T)
    case("s,us,degC",["s,us,degC"]+[f"{10*n},{US[n]:.0f},{T[n]}" for n in range(N)],echo=US/1e6,temperature=T)
    case("mm,volts",["mm,volts"]+[f"{D[n]*1000:.0f},{4.11-.002*n:.2f}" for n in range(N)],reading=D,never=("volts",))
    case("JSON topics",[x for n in range(N) for x in (f'{{"ts": "2024-05-14T{clock(n)}", "topic": "air", "temp_c": {T[n]}}}',f'{{"ts": "2024-05-14T{clock(n)}", "topic": "tank", "distance_mm": {D[n]*1000:.0f}}}')],column={"distance_mm":"reading_mm"},reading=D,temperature=T,step=10)
    case("indexed lines",[f"{n}: {D[n]*100:.1f} cm" for n in range(N)],reading=D)
    case("numbered names",[f"Reading #{n} = {D[n]*100:.1f}cm ({US[n]:.0f}us)" for n in range(N)],reading=D)
    case("telemetrix",[f"2021-05-04 {clock(n)}  Trigger Pin::  16   Distance(cm):  {D[n]*100:.2f}" for n in range(N)],reading=D,step=10)
    case("minus one",[f"DISTANCE: {-1 if lost[n] else round(D[n]*100,2)}" for n in range(N)],reading=DL)
    case("bars",[f"Distance: {D[n]*100:.1f} cm | Temp: {T[n]} C | Time: {12345+10000*n} ms" for n in range(N)],reading=D,temperature=T,step=10)
    case("logcat",[f"05-14 {clock(n)}.123  1234  1250 D Sonar   : distance={D[n]:.3f} m" for n in range(N)],reading=D,step=10)
    case("platformio",["--- Terminal on /dev/ttyUSB0 | 115200 8-N-1","--- Available filters and text transformations: colorize, debug, default"]+[f"{clock(n)}.123 > Distance: {D[n]*100:.1f} cm\r" for n in range(N)],reading=D,step=10)
    case("gpiozero words",[f"Distance to nearest object is {D[n]:.3f} m" for n in range(N)],reading=D)
    case("left right",[f"Left: {D[n]*100:.0f} cm, Right: {D[n]*60:.0f} cm" for n in range(N)],ask=True)
    case("caps",["TIMESTAMP,DISTANCE_CM,TEMPERATURE_C"]+[f"2024-05-14 {clock(n)},{D[n]*100:.1f},{T[n]}" for n in range(N)],reading=D,temperature=T,step=10)
    case("esphome mm",[f"[{clock(n)}][V][jsn_sr04t.sensor:045]: Distance from sensor: {D[n]*1000:.0f} mm, {D[n]:.3f} m" for n in range(N)],reading=D,step=10)
    case("esphome states only",[x for n in range(N) for x in (f"[{clock(n)}.123][S][sensor]: 'Tank level sensor' >> {D[n]:.3f} m",f"[{clock(n,10)}.456][S][sensor]: 'Air temperature' >> {T[n]} °C")],reading=D,temperature=T,step=10)
    case("esphome echo in brackets",[f"[{clock(n)}][D][ultrasonic.sensor:061]: 'T' - Got distance: {D[n]:.3f} m (echo: {US[n]:.0f}us)" for n in range(N)],echo=US/1e6,step=10)
    case("thonny shell",["MicroPython v1.22.2 on 2024-02-22; Raspberry Pi Pico with RP2040",">>> %Run -c $EDITOR_CONTENT",""]+[f"Distance: {D[n]*100:.4f} cm" if not lost[n] else "Out of range" for n in range(N)],reading=DL)
    case("key=val with tabs no unit",[f"d={D[n]*100:.2f}\tt={T[n]}\th=45" for n in range(N)],reading=D,temperature=T, either=True)
    case("mosquitto -F",[f"2024-05-14T{clock(n)}+0200 garden/tank/distance_cm {D[n]*100:.1f}" if k else f"2024-05-14T{clock(n)}+0200 garden/air/temperature {T[n]}" for n in range(N) for k in (0,1)],column={"distance_cm":"reading_cm"},reading=D,temperature=T,step=10)
    case("CSV of us and mm with names",["no,t_us,d_mm,air"]+[f"{n},{US[n]:.0f},{D[n]*1000:.0f},{T[n]}" for n in range(N)],echo=US/1e6)
    case("arrow colon",[f"{clock(n)}.123 -> Echo: {US[n]:.0f} us" for n in range(N)],echo=US/1e6,step=10)
    case("esphome 2019 verbose order",[x for n in range(N) for x in ((f"[{clock(n)}][V][sensor.ultrasonic:032]: Echo took {US[n]:.0f}µs",f"[{clock(n)}][V][sensor.sensor:020]: 'Ultrasonic Sensor': Received new state {US[n]*343e-6/2:.6f}",f"[{clock(n)}][D][sensor.ultrasonic:040]: 'Ultrasonic Sensor' - Got distance: {D[n]:.2f} m",f"[{clock(n)}][V][sensor.sensor:020]: 'Ultrasonic Sensor': Received new state {US[n]*343e-6/2:.6f}") if not lost[n] else (f"[{clock(n)}][V][sensor.ultrasonic:032]: Echo took 0µs",f"[{clock(n)}][D][sensor.ultrasonic:035]: 'Ultrasonic Sensor' - Distance measurement timed out!",f"[{clock(n)}][V][sensor.sensor:020]: 'Ultrasonic Sensor': Received new state nan"))],echo=np.where(lost,nan,US/1e6),step=10)
    case("esphome colors dht states",[x for n in range(N) for x in (f"{E}[{clock(n)}.412][D][ultrasonic.sensor:061]: 'Level raw' - Got distance: {D[n]:.3f} m{Z}",f"{E}[{clock(n)}.413][D][sensor:135]: 'Level raw': Sending state {D[n]:.5f} m with 2 decimals of accuracy{Z}",f"{E}[{clock(n)}.510][D][dallas.temp.sensor:054]: 'Shed Temperature': Got Temperature={T[n]:.1f}°C{Z}",f"{E}[{clock(n)}.511][D][sensor:135]: 'Shed Temperature': Sending state {T[n]:.5f} °C with 1 decimals of accuracy{Z}")],reading=D,temperature=T,step=10)
    case("esphome two rangers",[x for n in range(N) for x in (f"[{clock(n)}][D][ultrasonic.sensor:061]: 'Sensor back' - Got distance: {D[n]:.3f} m",f"[{clock(n)}][D][ultrasonic.sensor:061]: 'Sensor front' - Got distance: {D[n]*.5:.3f} m")],reading=D,step=10)
    case("esphome No echo custom",[f"[{clock(n)}][D][ui:01]: 'T' - No echo received within timeout!" if lost[n] else f"[{clock(n)}][D][ultrasonic.sensor:061]: 'T' - Got distance: {D[n]:.3f} m" for n in range(N)],reading=DL,step=10)
    case("docker compose prefix",[f"esphome  | [{clock(n)}.001][D][ultrasonic.sensor:040]: 'Tank' - Got distance: {D[n]:.3f} m" for n in range(N)],reading=D,step=10)
    case("addon prefix dates",[f"2024-05-14 {clock(n)} [{clock(n)}][D][ultrasonic.sensor:040]: 'Tank' - Got distance: {D[n]:.3f} m" for n in range(N)],reading=D,step=10)
    case("tasmota mqt",[f'{clock(n)}.456-025 MQT: tele/tasmota_1A/SENSOR = {{"Time":"2024-05-14T{clock(n)}","SR04":{{"Distance":{D[n]*100:.1f}}},"BME280":{{"Temperature":{T[n]},"Humidity":{H[n]},"Pressure":1013.2}},"PressureUnit":"hPa","TempUnit":"C"}}' for n in range(N)],reading=D,temperature=T,step=10)
    case("circuitpython two values",[f"({D[n]*100:.1f}, {T[n]})" if not lost[n] else "Retrying!" for n in range(N)],reading=DL)
    case("circuitpython plain sentence",["Auto-reload is on. Simply save files over USB to run them or enter REPL to disable.","code.py output:"]+[f"{D[n]*100:.2f}" if not lost[n] else "Retrying!" for n in range(N)],reading=DL)
    case("micropython dict",[str({"t":10*n,"cm":float(round(D[n]*100,1)),"C":float(T[n])}) for n in range(N)],reading=D,temperature=T)
    case("python logging file:line",[f"2024-05-14 {clock(n)},123 [MainThread] DEBUG sonar.py:88 - distance={D[n]*100:.2f} cm, air={T[n]} C" for n in range(N)],reading=D,temperature=T,step=10)
    case("cpp file line",[f"src/main.cpp:{41+n%3}: dist_mm={D[n]*1000:.0f} temp_c={T[n]}" for n in range(N)],reading=D,temperature=T)
    case("loguru",[f"2024-05-14 {clock(n)}.123 | INFO     | __main__:loop:57 - Distance: {D[n]:.3f} m" for n in range(N)],reading=D,step=10)
    case("units names feet us",["feet,us,degF"]+[f"{D[n]/.3048:.2f},{US[n]:.0f},{T[n]*1.8+32:.1f}" for n in range(N)],echo=US/1e6,temperature=T)
    case("units in ms no header comment",["# in, ms"]+[f"{D[n]/.0254:.1f},{US[n]/1000:.3f}" for n in range(N)],echo=US.round()/1e6)
    case("tab plotter names like units",[f"cm:{D[n]*100:.1f}\tC:{T[n]}\tV:{4.9+.01*(n%3):.2f}" for n in range(N)],reading=D,temperature=T,never=("V",))
    case("spaces no colon",[f"Distance {D[n]*100:.1f} cm Temperature {T[n]} C Humidity {H[n]} %" for n in range(N)],reading=D,temperature=T)
    case("no header charge first",[f"{97-.05*n:.1f},{1.749e9+600*n:.0f},{D[n]*1000:.0f},{3.98-.001*n:.2f}" for n in range(N)],reading=D,never=("column 1","column 4"),step=600, either=True)
    case("no header temp+volts",[f"{1.749e9+600*n:.0f},{D[n]*1000:.0f},{T[n]},{12.4+.2*np.sin(n/6):.2f}" for n in range(N)],reading=D,temperature=T,never=("column 4",),step=600, either=True)
    case("copies rounding",["time_s,reading_mm,temperature_C,disp_cm,adc"]+[f"{600*n},{D[n]*1000:.0f},{T[n]},{D[n]*100:.0f},{D[n]*1000/5:.0f}" for n in range(N)],reading=D,temperature=T,noextra=("disp_cm","adc"),step=600)
    case("HA temps later unit col",["entity_id;state;unit_of_measurement;last_changed"]+[x for n in range(N) for x in (f"sensor.tank;{D[n]*100:.1f};cm;2024-05-14T{clock(n,300)}+00:00",f"sensor.roof_temperature;{T[n]};°C;2024-05-14T{clock(n,300)[:-1]}8+00:00")],column={"sensor.tank":"reading_cm"},reading=D,step=300)
    case("syslog esp",[f"May 14 {clock(n)} esp32 sonar[1]: d={D[n]*100:.1f}cm t={T[n]}C v=4.0{n%3}V" for n in range(N)],reading=D,temperature=T,step=10)
    case("csv with no echo word cells",["time,distance (cm),temp (C)"]+[f"2024-05-14 {clock(n)},{'timeout' if lost[n] else round(D[n]*100,1)},{T[n]}" for n in range(N)],either=True,reading=DL,temperature=T,step=10)
    case("negative one csv",["millis,distance_cm_raw,temp_C"]+[f"{10000*n},{-1 if lost[n] else round(D[n]*100,1)},{T[n]}" for n in range(N)],temperature=T,either=True,reading=DL,step=10)
    case("rtos lines",[f"[{n*0.5:.3f}s] sonar: echo {US[n]:.0f} us" for n in range(N)],echo=US/1e6,step=.5)
    case("json nested no units",[f'{{"time":"2024-05-14T{clock(n)}Z","sonar":{{"cm":{D[n]*100:.1f}}},"air":{{"C":{T[n]}}}}}' for n in range(N)],reading=D,temperature=T,step=10)
    case("excel seconds micros",["time_s,echo_us,temperature_C"]+[f"{100057*n+n%7},{US[n]:.0f},{T[n]}" for n in range(N)],ask=True)
    case("thingspeak alternate entries",["created_at,entry_id,field1,field2"]+[x for n in range(N) for x in (f"2024-05-14 {clock(n,30)} UTC,{2*n+1},{D[n]*100:.1f},",f"2024-05-14 {clock(n,30)[:-1]}9 UTC,{2*n+2},,{T[n]}")],ask=True)
    case("GPS style",[f"$SONAR,{clock(n)},{D[n]:.3f},M,{T[n]},C*3F" for n in range(N)],either=True,reading=D)
    case("sentence w/ unit words",[f"The object is {D[n]*100:.1f} centimeters away, air {T[n]} degrees celsius" for n in range(N)],reading=D,temperature=T)
    # fmt: on
    return found
