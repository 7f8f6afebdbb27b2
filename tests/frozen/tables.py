"""The tables of the frozen corpus, each by name: drawn from fixed seeds, of the study, of real records."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from hidden_effects.answers import known
from hidden_effects.cases import build
from hidden_effects.designs import DESIGNS
from hidden_effects.menu import draw, fits

import echocal
from echocal.study.diagnosed import QUESTIONS, Question
from echocal.study.tables import DISTANCE, Tables

ROOT = Path(__file__).parents[2]
SEED = 20261122
DRAWN = {
    "null": 15,
    "prior": 12,
    "wild": 16,
    "power5": 8,
    "power8": 8,
    "pair": 10,
    "unknown": 8,
    "other": 12,
}
"""Tables of each stratum in each design; see `hidden_effects.cases.STRATA`."""

Ask = Callable[[], echocal.Diagnosis]


def tables(shared: Path) -> dict[str, Ask]:
    """Every table with what is asked about it; those of `shared` only where that folder is there."""
    return {**dict(_drawn()), **dict(_study()), **(dict(_real(shared / "data")) if shared.is_dir() else {})}


def _drawn() -> Iterator[tuple[str, Ask]]:
    engine = known()
    for design in DESIGNS:
        for stratum, count in DRAWN.items():
            random = np.random.default_rng([SEED, *design.encode(), *stratum.encode()])
            kinds = ("noise", "row", "gross") if stratum == "other" else ("mean",)
            causes = [id_ for id_ in fits(design, kinds) if id_ in engine]
            for i, spec in enumerate(draw(design, stratum, count, causes, random)):
                yield (
                    f"drawn/{design}/{stratum}/{i:02}",
                    lambda spec=spec: echocal.diagnose(build(spec).table),
                )


def _study() -> Iterator[tuple[str, Ask]]:
    for i, question in enumerate(QUESTIONS):
        yield f"study/{i}", lambda question=question: _asked(question)
    examples = ROOT / "examples"
    yield "example/study_table2", lambda: echocal.diagnose(examples / "study_table2.csv")
    for base in ("cramer", "linear", "343"):
        yield (
            f"example/warehouse/{base}",
            lambda base=base: echocal.diagnose(examples / "warehouse.csv", base=base),
        )


def _asked(question: Question) -> echocal.Diagnosis:
    table = getattr(Tables.load(), question.table)
    return echocal.diagnose(
        {"temperature_C": table.temperature, "reading_m": table.values(question.column)},
        base=question.base,
        reading_speed=question.reading_speed,
        reference_distance=DISTANCE,
    )


ROOF = {
    "TIMESTAMP": "time",
    "SR_U": "reading_m",
    "Asp_temp_L": "temperature_C",
    "Humidity_L": "humidity_percent",
    "Pressure_L": "pressure_hPa",
    "WindSpeed_S_L": "wind_m_s",
    "SWUpper": "radiation_W_m2",
    **dict.fromkeys(("Asp_temp_U", "Humidity_U", "Pressure_U"), "ignore"),
}
BOX = {
    "Exp Distance": "two_way_distance_m",
    "Measured Time Diff": "echo_s",
    "Temperature": "temperature_K",
    "run": "stand",
    **dict.fromkeys(("Derived k_B", "Derived k_B Error", "Pressure", "HC-SRO4 Raw", "L"), "ignore"),
}
DESK = {
    "true_cm": "distance_cm",
    "temp_C": "temperature_C",
    "reading_cm": "reading_cm",
    "obs": "order",
    "file": "group",
}
ROCK = {
    "Time [UTC]": "time",
    "Distance [mm]": "reading_mm",
    "Temp Atmos [C]": "temperature in degC",
    "Humidity [%]": "humidity in %",
    "PresOB [mBar]": "pressure in mbar",
    "Bat [V]": "supply_V",
}
PERIODS: dict[str, dict[str, Any]] = {
    "july": {"since": "2022-07-05", "until": "2022-08-03"},
    "july-held-out": {"since": "2022-07-05", "until": "2022-08-03", "hold_out_after": "2022-07-20"},
    "june": {"since": "2022-06-09", "until": "2022-06-24"},
    "may": {"until": "2022-06-06"},
    "whole": {},
}


def _real(data: Path) -> Iterator[tuple[str, Ask]]:
    for name, period in PERIODS.items():
        for speed in ("331.4", None):
            yield (
                f"roof/{name}/{speed}",
                lambda period=period, speed=speed: echocal.diagnose(
                    data / "roof-sr50" / "roof_fixed_target_tidy.csv",
                    columns=ROOF,
                    constant_distance=True,
                    base="linear",
                    reading_speed=speed,
                    **period,
                ),
            )
    days = ("2019-04-20", "2019-04-22", "2019-04-30", "2019-05-01", "2019-05-06", "2019-05-14", "2019-05-15")
    for day in (*days, "2019-05-21", "2019-05-29", "2019-06-03", "2019-06-05", "2019-05", "2019-06", "2019"):
        yield f"box/{day}", lambda day=day: _box(data, day)
    yield (
        "desk",
        lambda: echocal.diagnose(
            data / "desk-hcsr04" / "hcsr04_known_distance_tidy.csv",
            columns=DESK,
            reading_speed="331.3+0.606*T",
        ),
    )
    yield (
        "rock",
        lambda: echocal.diagnose(
            data / "weather-maxbotix" / "WS3-Orloc.csv",
            columns=ROCK,
            skip_lines=1,
            missing={"Distance [mm]": [-500, 9999], "": [-9999]},
            constant_distance=True,
        ),
    )
    for record in ("ot-sw-2021", "ot-hw-2022", "ot-sw-ard-2021"):
        yield f"old-town/{record}", lambda record=record: _old_town(data, record)
    yield "cycling", lambda: echocal.diagnose(data / "cycling-a02" / "cycling-a02.csv")
    yield "mre320", lambda: echocal.diagnose(data / "mre320-hcsr04" / "mre320.csv")


def _box(data: Path, day: str) -> echocal.Diagnosis:
    table = pd.read_csv(data / "kb-hcsr04" / "all_runs_tidy.csv")
    chosen = table["day"].str.startswith(day)
    return echocal.diagnose(table[chosen].reset_index(drop=True), columns=BOX)


def _old_town(data: Path, record: str) -> echocal.Diagnosis:
    table = pd.read_csv(data / "old-town-sr50" / f"{record}.csv").drop(columns="second_ranger_mm")
    return echocal.diagnose(table, constant_distance=True, reading_speed="331.4")
