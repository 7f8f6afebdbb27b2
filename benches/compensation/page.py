"""docs/compensation.md, from figures.json."""

import json
from pathlib import Path
from typing import Any

from compensation import figure
from compensation.campaign import ALL, BANDS, BEST, NOTHING, TRAINED, Setting
from compensation.filters import FILTERS
from compensation.hardware import FIRMWARE, SENSOR_EURO, SENSOR_SOURCE, THERMOMETERS
from compensation.words import air, cannot, conclusions, head, simulated

ROOT = Path(__file__).parents[2]
PAGE, PICTURE = ROOT / "docs" / "compensation.md", ROOT / "docs" / "compensation.png"
RESULTS = Path(__file__).with_name("figures.json")
Record = dict[str, Any]
_SHORT = ("fixed", "cramer", "zeroed", "line", "named")

_STEPS = {
    "343 m/s": Setting(BEST, method="fixed"),
    "study: (331.4 + 0.6 T)": Setting(BEST, method="study"),
    "Cramer 1993 instead, dry air": Setting(BEST, method="dry"),
    "+ a humidity of 50 %": Setting(BEST, method="half"),
    "+ the measured humidity": Setting(BEST, method="cramer"),
    "+ zero at one mark": Setting(BEST, method="zeroed"),
    "+ line through all marks: everything": Setting(BEST, method="line"),
    "everything but the humidity: 50 %": Setting(BEST, method="half_line"),
    "everything but the humidity: dry air": Setting(BEST, method="dry_line"),
    "everything but Cramer: the study's formula": Setting(BEST, method="study_line"),
    "everything but a thermometer": Setting("none", method="line"),
    "everything but the shield": Setting("htu31d", method="line"),
    "named causes instead of the line": Setting(BEST, method="named"),
    "gradient boosting of what Cramer leaves": Setting(BEST, method="boosting_left"),
    "everything, air as it truly is at the thermometer": Setting(BEST, method="line", oracle="air"),
    "everything, a detector without time walk": Setting(BEST, method="line", oracle="detector"),
    "both": Setting(BEST, method="line", oracle="both"),
}


def load() -> Record:
    """Read what was measured last."""
    return json.loads(RESULTS.read_text(encoding="utf-8"))


def save(results: Record) -> None:
    """Write what was measured."""
    lines = []
    for name, own in results.items():
        rows = [f'  "{key}": {json.dumps(one)}' for key, one in own.items()] if isinstance(own, dict) else []
        body = "{\n" + ",\n".join(rows) + "\n }" if rows else json.dumps(own)
        lines.append(f' "{name}": {body}')
    RESULTS.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def write() -> None:
    """Write page and figure."""
    results = load()
    PAGE.write_text(page(results), encoding="utf-8")
    figure.save(results, PICTURE)


def page(results: Record) -> str:
    """Compose the whole page."""
    parts = (
        head(results),
        simulated(),
        hardware(results),
        methods(results),
        steps(results),
        firmware(results),
        filters(results),
        air(),
        conclusions(results),
        cannot(),
        assumptions(),
    )
    return "\n".join(parts)


def number(figures: list[float], digits: int = 3) -> str:
    """Write a value with its interval."""
    value, low, high = (f"{one:.0f}" if one >= 100 else f"{one:.{digits}g}" for one in figures)
    return f"{value} ({low} to {high})"


def share(figure: float) -> str:
    """Write a share."""
    return f"{figure:.2f}"


def _table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def hardware(results: Record) -> str:
    """Make the table of what is bought."""
    figures, kelvin = results["figures"], results["kelvin"]
    rows = []
    for name, own in sorted(THERMOMETERS.items(), key=lambda item: item[1].euro):
        warm = kelvin.get(name)
        cells = [own.label, f"{SENSOR_EURO + own.euro:.1f}"]
        cells += [f"{warm['summer']:.2g}", f"{warm['winter']:.2g}"] if warm else ["-", "-"]
        for method in ("cramer", "zeroed", "line", "named", "boosting_left"):
            used = "fixed" if (name, method) == ("none", "cramer") else method
            key = Setting(name, method=used).key
            cells.append(number(figures[key]["other"]["all"]["rms"]) if key in figures else "-")
        cells.append(number(figures[Setting(name, oracle="detector").key]["other"]["all"]["rms"]))
        rows.append(cells)
    heads = ["thermometer", "€", "its error, summer [K]", "winter [K]", "as bought", "zero at one mark"]
    heads += ["line through all marks", "named causes"]
    heads += ["gradient boosting of what Cramer leaves", "line, a detector without time walk"]
    return f"""## Which euro

RMS error in summer and winter, 0.2 to 4 m [mm], of a device that was trained in spring; firmware with timer
capture. The price is that of the HC-SR04 and the thermometer, without the board. Without a thermometer the
speed is 343 m/s; else it is that of Cramer 1993. The last column is no product: it shows what a thermometer
can buy where the detector does not limit.

{_table(heads, rows)}"""


def methods(results: Record) -> str:
    """Make the table of methods."""
    figures, rows = results["figures"], []
    missing = figures[Setting(BEST).key]["other"]["all"]["missing"]
    for name, own in ALL.items():
        key, other = Setting(BEST, method=name).key, Setting(BEST, method=name, trained="room").key
        tests, each = figures[key], results["each"][key]
        cells = [own.label]
        cells += [f"{tests[test]['all']['rms'][0]:.3g}" for test in ("spring", "summer", "winter")]
        cells += [number(tests["other"]["all"][of]) for of in ("rms", "high")]
        cells += [share(tests["other"]["all"]["within"]), f"{each[len(each) // 2]:.3g}, {each[-1]:.3g}"]
        cells += [str(results["wins"][key]), number(figures[other]["other"]["all"]["rms"])]
        rows.append(cells)
    heads = ["method", "same weather", "summer", "winter", "summer and winter", "95 % of errors below"]
    heads += ["within 3 mm", "median and worst device", "better than the line", "trained in a room"]
    return f"""## Which method

The same device with an HTU31D in a shield and timer capture. RMS errors [mm] at 0.2 to 4 m, of a device that
was trained in spring; in the last column, in summer and winter after a training in the room. *Better than
the line* counts the devices, of {results["devices"]}, with a smaller RMS in summer and winter than the line
through all marks. A value is missing where no reading of a burst had an echo: {missing:.2%} of them.

{_table(heads, rows)}
What `echocal.diagnose` put into its models, of {results["devices"]} each, and what it added to those of
`echocal.calibrate`:

{_named(results)}"""


def _named(results: Record) -> str:
    rows = []
    for trained, words in TRAINED.items():
        for method in ("named", "both"):
            counted = results["causes"][Setting(BEST, method=method, trained=trained).key]
            order = sorted(counted, key=lambda name: (-counted[name], name))
            effects = [f"{name if name == NOTHING else f'`{name}`'} {counted[name]}" for name in order]
            rows.append([words, ALL[method].label, ", ".join(effects)])
    return _table(["training", "method", "effects in the models"], rows)


def steps(results: Record) -> str:
    """Make the table of the data sheet's 3 mm."""
    rows = []
    for label, setting in _STEPS.items():
        tests = results["figures"][setting.key]
        cells = [label, *[share(tests["nominal"][band]["within"]) for band in list(BANDS)[1:]]]
        cells += [share(tests["other"][band]["within"]) for band in list(BANDS)[1:]]
        cells += [f"{tests[test]['all']['rms'][0]:.3g}" for test in ("nominal", "other")]
        rows.append(cells)
    heads = ["correction", "at 20 °C: 0.2 to 1 m", "1 to 2 m", "2 to 4 m", "summer and winter: 0.2 to 1 m"]
    heads += ["1 to 2 m", "2 to 4 m", "RMS at 20 °C [mm]", "RMS, summer and winter [mm]"]
    return f"""## The data sheet's 3 mm

Share of the values within 3 mm, in a room at 20 °C, which are the nominal conditions, and in other weather.
HTU31D in a shield, timer capture, trained in spring. The last three rows are no products: they show what
limits the others.

{_table(heads, rows)}"""


def firmware(results: Record) -> str:
    """Make the table of firmware."""
    rows = []
    for name, label in FIRMWARE.items():
        keys = [Setting(BEST, name, method).key for method in _SHORT]
        cells = [label, *[number(results["figures"][key]["other"]["all"]["rms"]) for key in keys]]
        rows.append(cells)
    heads = ["firmware", "343 m/s", "Cramer", "zero at one mark", "line through all marks", "named causes"]
    return f"""## Which firmware

RMS error in summer and winter [mm], HTU31D in a shield. `pulseIn()` loses 0.584 % of the pulse. The last one
counts whole centimeters.

{_table(heads, rows)}"""


def filters(results: Record) -> str:
    """Make the table of filters."""
    rows = []
    for name, label in FILTERS.items():
        cells = [label]
        for kind in ("capture", "whole_cm"):
            tests = results["figures"][Setting(BEST, kind, filter=name).key]["other"]
            cells += [number(tests[band]["rms"]) for band in ("all", "settled")]
        rows.append(cells)
    heads = ["filter", "timer capture", "an hour after a move", "whole centimeters", "an hour after a move"]
    return f"""## Which filter

RMS error in summer and winter [mm] after the line through all marks. The target is moved every three hours
and read every half hour. *An hour after a move* leaves out the first two bursts at each place. Both Kalman
filters have their variances from the training, by maximum likelihood.

{_table(heads, rows)}"""


def assumptions() -> str:
    """Make the table of prices and errors that were assumed."""
    rows = [["HC-SR04", f"{SENSOR_EURO:.1f}", "", "", "", "", SENSOR_SOURCE]]
    for own in THERMOMETERS.values():
        if own.kind == "none":
            continue
        kept = own.kind == "air"
        cells = [own.label, f"{own.euro:.1f}", f"{own.offset:g}" if own.offset else ""]
        cells += [f"{own.lag:g}" if kept else "", f"{own.sun:g}" if kept else ""]
        cells += [f"{100 * own.humidity:g}" if own.humidity else "", own.source]
        rows.append(cells)
    heads = ["part", "€", "offset, standard deviation [K]", "time constant [s]"]
    heads += ["sun, K per kW/m² in still air", "humidity, standard deviation [%]", "source"]
    return f"""## Prices and errors that were assumed

{_table(heads, rows)}
- Time constants are judgements. A sensor in a TO-18 housing has 13.5 s at 3 m/s and 60 s in still air (data
  sheet of the SMT160); boards, grids and shields make it slower.
- Sun: shields that people build let +7.4 K to less than +0.5 K pass (Tarara & Hoheisel 2007, HortScience 42,
  1372). A plate shield lets 2 to 4 K pass without wind ("Radiation loading model for evaluating air
  temperature errors with a nonaspirated radiation shield", 2001). In wind v the assumed value is divided by
  1 + v / (1 m/s).
- The board's clock errs by 0.18 % (standard deviation): the RMS of five boards with a ceramic resonator
  (github.com/manitou48/crystals). Its drift, 15 ppm/K, and 1 % for the 5 V that the converter compares with,
  are assumed.
- Modules differ: threshold by 20 %, the centers of the transducers by 200 Hz (standard deviations, assumed).
"""
