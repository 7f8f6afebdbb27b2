"""Mistakes of firmware and logger that people make every day; each changes the finished table."""

import numpy as np
import pandas as pd

from echocal.errors import UsageError
from echocal.virtual_bench.campaign.campaign import Campaign, cause

_CENTIMETERS = 100.0


def device(campaign: Campaign, speed: float, step_cm: float = 0.0) -> None:
    """Let the device compute its reading with one speed [m/s], cut off to a step [cm] or in two decimals."""

    def reckon(table: pd.DataFrame) -> pd.DataFrame:
        if "echo_us" not in table:
            raise UsageError(
                "two causes say how the device computes its reading; give one of fixed_speed, divisor, "
                "reading_quantization and mistyped_rows"
            )
        centimeters = _CENTIMETERS * 0.5 * speed * 1e-6 * table["echo_us"]
        centimeters = centimeters // step_cm * step_cm if step_cm else centimeters.round(2)
        made = table.drop(columns="echo_us")
        made.insert(1, "reading_cm", centimeters)
        return made

    campaign.logger.append(reckon)


def _measured(table: pd.DataFrame) -> str:
    """Column that holds what the sensor measured."""
    return "echo_us" if "echo_us" in table else "reading_cm"


@cause("m/s", 335.0, 350.0, "reference")
def fixed_speed(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The device computes with one speed of sound at every temperature."""
    device(campaign, size)


@cause("us/cm", 57.0, 59.0, "reference", in_catalogue=False, whole=True)
def divisor(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The device divides the microseconds by a round number: 57, 58 or 59."""
    device(campaign, 2e4 / size)


@cause("cm", 1.0, 1.0, "reference")
def reading_quantization(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The device cuts its reading off to whole centimeters."""
    device(campaign, 343.0, size)


@cause("1", 0.01, 0.06)
def timeout(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Readings without an echo are written as the length of the time-out."""
    lost = random.uniform(size=len(campaign)) < size

    def write(table: pd.DataFrame) -> pd.DataFrame:
        column = _measured(table)
        number = 38000.0 if column == "echo_us" else 651.7
        return table.assign(**{column: np.where(lost, number, table[column])})

    campaign.logger.append(write)


@cause("1", 0.01, 0.04, "reference")
def mistyped_rows(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Somebody types the centimeters of a display, and exchanges two digits now and then."""
    wrong = random.uniform(size=len(campaign)) < size

    device(campaign, 343.0)

    def typed(centimeters: float, slip: bool) -> float:
        digits = f"{centimeters:.1f}"
        swapped = digits[1] + digits[0] + digits[2:]
        return float(swapped if slip and centimeters >= 10.0 else digits)

    def write(table: pd.DataFrame) -> pd.DataFrame:
        shown = table["reading_cm"].to_numpy()
        kept = [typed(*row) if np.isfinite(row[0]) else np.nan for row in zip(shown, wrong, strict=True)]
        return table.assign(reading_cm=kept)

    campaign.logger.append(write)


@cause("rows", 40.0, 120.0, "time")
def stuck_reading(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The sensor repeats one reading for a while."""
    first = int(random.uniform(0.2, 0.7) * len(campaign))
    rows = slice(first, first + max(8, min(int(size), len(campaign) // 10)))

    def write(table: pd.DataFrame) -> pd.DataFrame:
        column = _measured(table)
        values = table[column].to_numpy().copy()
        values[rows] = values[first]
        return table.assign(**{column: values})

    campaign.logger.append(write)


@cause("1", 2.0, 2.0, "reference")
def round_trip_factor(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The way out and back is not halved."""
    campaign.pulse.append(lambda seconds: seconds * size)


@cause("1", 0.005, 0.02, "reference")
def reference_scale(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The tape is stretched."""

    def write(table: pd.DataFrame) -> pd.DataFrame:
        return table.assign(distance_m=table["distance_m"] / (1 + size))

    campaign.logger.append(write)


@cause("m", 2e-3, 6e-3, "reference", "visits")
def reference_error(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Each placement is read from the tape with an error of its own."""
    errors = random.normal(0.0, size, campaign.placement.max() + 1)
    moved = errors[campaign.placement]

    def write(table: pd.DataFrame) -> pd.DataFrame:
        return table.assign(distance_m=np.round(table["distance_m"] + moved, 4))

    campaign.logger.append(write)


@cause("1", 1.0, 1.0, "weather")
def unrecorded_humidity(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Nobody measures the humidity of warm and damp air."""
    campaign.around.temperature += 12.0
    campaign.air += 12.0
    campaign.device_temperature += 12.0
    campaign.around.relative_humidity = np.clip(campaign.around.relative_humidity + 0.2, 0.0, 1.0)
    campaign.logger.append(lambda table: table.drop(columns="humidity_percent"))
