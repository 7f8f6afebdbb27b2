"""docs/compensation.md, from figures.json."""

import json
from pathlib import Path
from typing import Any

from compensation import figure
from compensation.campaign import ALL, BANDS, BEST, NOTHING, SHORT, TRAINED, Setting
from compensation.filters import FILTERS
from compensation.hardware import FIRMWARE, SENSOR_EURO, SENSOR_SOURCE, THERMOMETERS
from compensation.words import air, cannot, conclusions, head, simulated

ROOT = Path(__file__).parents[2]
PAGE, PICTURE = ROOT / "docs" / "compensation.md", ROOT / "docs" / "compensation.png"
RESULTS = Path(__file__).with_name("figures.json")
Record = dict[str, Any]

_STEPS = {
    "343 m/s": Setting(BEST, method="fixed"),
    "study: (331.4 + 0.6 T)": Setting(BEST, method="study"),
    "Cramer 1993 instead, dry air": Setting(BEST, method="dry"),
    "+ a humidity of 50 %": Setting(BEST, method="half"),
    "+ the measured humidity": Setting(BEST, method="cramer"),
    "+ zero at one mark": Setting(BEST, method="zeroed"),
    "+ line through all marks: everything": Setting(BEST),
    "everything but the humidity: 50 %": Setting(BEST, method="half_line"),
    "everything but the humidity: dry air": Setting(BEST, method="dry_line"),
    "everything but Cramer: the study's formula": Setting(BEST, method="study_line"),
    "everything but a thermometer": Setting("none"),
    "everything but the shield": Setting("dht22"),
    "named causes instead of the line": Setting(BEST, method="named"),
    "gradient boosting of what Cramer leaves": Setting(BEST, method="boosting_left"),
    "everything, air as it truly is at the thermometer": Setting(BEST, oracle="air"),
    "everything, a detector without time walk": Setting(BEST, oracle="detector"),
    "both": Setting(BEST, oracle="both"),
}


def load() -> Record:
    """Read what was measured last."""
    return json.loads(RESULTS.read_text(encoding="utf-8"))


def save(results: Record) -> None:
    """Write what was measured, a line for each configuration."""
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
    tables = (hardware(results), methods(results), steps(results), firmware(results), filters(results))
    return "\n".join(
        [head(results), simulated(), *tables, air(), conclusions(results), cannot(), assumptions()]
    )


def number(figures: list[float]) -> str:
    """Write a value with its interval."""
    value, low, high = (f"{one:.0f}" if one >= 100 else f"{one:.3g}" for one in figures)
    return f"{value} ({low} to {high})"


def _table(heads: str, rows: list[list[str]]) -> str:
    lines = [heads.split(" | "), ["---"] * len(heads.split(" | ")), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def hardware(results: Record) -> str:
    """Make the table of what is bought."""
    figures, rows = results["figures"], []
    for name, own in sorted(THERMOMETERS.items(), key=lambda item: item[1].euro):
        warm = results["kelvin"].get(name)
        cells = [own.label, f"{SENSOR_EURO + own.euro:.1f}"]
        cells += [f"{warm[season]:.2g}" if warm else "-" for season in ("summer", "winter")]
        settings = [figure.bought(name, method) for method in figure.BOUGHT]
        for setting in (*settings, Setting(name, oracle="detector")):
            known = figures.get(setting.key)
            cells.append(number(known["other"]["all"]["rms"]) if known else "-")
        rows.append(cells)
    labels = " | ".join(label for label, *_ in figure.BOUGHT.values())
    heads = f"thermometer | € | its error, summer [K] | winter [K] | {labels}"
    return f"""## Which euro

RMS error in summer and winter, 0.2 to 4 m [mm], of a device that was trained in spring; firmware with timer
capture. The price is that of the HC-SR04 and the thermometer, without the board. Without a thermometer the
speed is 343 m/s; else it is that of Cramer 1993. The last column is no product: it shows what a thermometer
can buy where the detector does not limit.

{_table(heads + " | line, a detector without time walk", rows)}"""


def methods(results: Record) -> str:
    """Make the table of methods."""
    figures, rows = results["figures"], []
    for name, own in ALL.items():
        key, room = Setting(BEST, method=name).key, Setting(BEST, method=name, trained="room").key
        tests, each = figures[key], results["each"][key]
        cells = [own.label]
        cells += [f"{tests[test]['all']['rms'][0]:.3g}" for test in ("spring", "summer", "winter")]
        cells += [number(tests["other"]["all"][of]) for of in ("rms", "high")]
        cells += [f"{tests['other']['all']['within']:.2f}", f"{each[len(each) // 2]:.3g}, {each[-1]:.3g}"]
        cells += [str(results["wins"][key]), number(figures[room]["other"]["all"]["rms"])]
        rows.append(cells)
    heads = "method | same weather | summer | winter | summer and winter | 95 % of errors below | "
    heads += "within 3 mm | median and worst device | better than the line | trained in a room"
    missing = figures[Setting(BEST).key]["other"]["all"]["missing"]
    return f"""## Which method

The same device with a DHT22 in a shield and timer capture. RMS errors [mm] at 0.2 to 4 m, of a device that
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
    return _table("training | method | effects in the models", rows)


def steps(results: Record) -> str:
    """Make the table of the data sheet's 3 mm."""
    rows = []
    for label, setting in _STEPS.items():
        tests = [results["figures"][setting.key][name] for name in ("nominal", "other")]
        cells = [f"{test[band]['within']:.2f}" for test in tests for band in list(BANDS)[1:]]
        rows.append([label, *cells, *[f"{test['all']['rms'][0]:.3g}" for test in tests]])
    heads = "correction | at 20 °C: 0.2 to 1 m | 1 to 2 m | 2 to 4 m | summer and winter: 0.2 to 1 m | "
    heads += "1 to 2 m | 2 to 4 m | RMS at 20 °C [mm] | RMS, summer and winter [mm]"
    return f"""## The data sheet's 3 mm

Share of the values within 3 mm, in a room at 20 °C, which are the nominal conditions, and in other weather.
DHT22 in a shield, timer capture, trained in spring. The last three rows are no products: they show what
limits the others.

{_table(heads, rows)}"""


def firmware(results: Record) -> str:
    """Make the table of firmware."""
    rows = []
    for name, label in FIRMWARE.items():
        keys = [Setting(BEST, name, method).key for method in SHORT]
        rows.append([label, *[number(results["figures"][key]["other"]["all"]["rms"]) for key in keys]])
    return f"""## Which firmware

RMS error in summer and winter [mm], DHT22 in a shield. `pulseIn()` loses 0.584 % of the pulse. The last one
counts whole centimeters.

{_table(" | ".join(["firmware", *[ALL[method].label for method in SHORT]]), rows)}"""


def filters(results: Record) -> str:
    """Make the table of filters."""
    rows = []
    for name, label in FILTERS.items():
        keys = [Setting(BEST, kind, filter=name).key for kind in ("capture", "whole_cm")]
        tests = [results["figures"][key]["other"] for key in keys]
        rows.append([label, *[number(test[band]["rms"]) for test in tests for band in ("all", "settled")]])
    heads = "filter | timer capture | an hour after a move | whole centimeters | an hour after a move"
    return f"""## Which filter

RMS error in summer and winter [mm] after the line through all marks. The target is moved every three hours
and read every half hour. *An hour after a move* leaves out the first two bursts at each place. Both Kalman
filters have their variances from the training, by maximum likelihood.

{_table(heads, rows)}"""


def assumptions() -> str:
    """Make the table of prices, and of the parts of the bench."""
    rows = [["HC-SR04", f"{SENSOR_EURO:.1f}", SENSOR_SOURCE, "", "", "", "", ""]]
    for name, own in THERMOMETERS.items():
        if own.source:
            cells = [own.label, f"{own.euro:.1f}", own.source]
            part = own.part if name != "hand" else None
            values = (part.tolerance, part.noise, part.step, part.time_constant, part.sun) if part else ()
            rows.append([*cells, *(f"{value:g}" for value in values), *[""] * (5 - len(values))])
    heads = "part | € | source of the price | offset, standard deviation [K] | noise [K] | step [K] | "
    return f"""## Prices and parts

{_table(heads + "time constant [s] | in full sun [K]", rows)}
- Thermometers and the hygrometer are the parts of the virtual bench: `echocal.virtual_bench.instruments` and
  `hygrometers` name the source of each number. Analog parts are read with 10 bits against a supply that errs
  by 1 % (assumed). The DHT22 is read twice, and the first reading is thrown away, since it is old. Its
  humidity errs by 2.5 % (half of the data sheet's limit).
- A shield lets 1.9 to 2.8 K pass (Teichmann et al. 2024, doi:10.3390/s24051564), and doubles the time
  constant (assumed). Shields that people build let +7.4 K to less than +0.5 K pass (Tarara & Hoheisel 2007,
  HortScience 42, 1372).
- The board's clock errs by 0.18 % (standard deviation): the RMS of five boards with a ceramic resonator
  (github.com/manitou48/crystals). Its drift, 15 ppm/K, is assumed.
- Modules differ: the sensitivity of the transducers by 20 %, their centers by 200 Hz (standard deviations,
  assumed).
"""
