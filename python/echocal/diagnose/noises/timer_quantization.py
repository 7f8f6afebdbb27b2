"""Echo times in whole ticks."""

import numpy as np

from echocal.concise import percent
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.noises.common.kinds import Quantization
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.observations.quantization_grid import FINEST_STEP, find_grid

__all__ = ["NOISE"]

FACTS = CauseFacts(
    id="timer_quantization",
    kind="noise",
    sentence="The timer counts whole ticks: 1 or 4 us of a microcontroller, 1 ms of a system clock.",
    signature="echo times are multiples of one step",
    source="Arduino micros(): 4 us; DarkFlippers/unleashed-firmware PR #367: 1 ms, 17 cm",
    parameters=(Quantity("step", "s", "tick of the timer", (1e-7, 1e-2), "any"),),
    check="time the echo with a capture unit of the timer",
    prior=0.1,
    formula="echo time' = step * round(echo time / step)",
    needs=("echo_time",),
)


def detect(view: View, settings: NoiseSettings) -> Finding | None:
    """Find the tick of the echo times."""
    reading = view.observations.reading
    if reading is not None and view.resolution > FINEST_STEP:
        return None  # whatever the timer did, the reading's own step hides it
    grid = find_grid(np.where(view.good, view.observations.echo_time, np.nan))
    if grid is None:
        return None
    rows = view.good & (view.observations.echo_time > 0)
    speed = float(np.median(view.indication[rows] / view.observations.echo_time[rows]))  # half of sound's
    step = speed * grid.step
    share = step**2 / 12 / max(view.scatter**2, step**2 / 12)
    because = (
        f"all {grid.distinct} different echo times are multiples of {1e6 * grid.step:.4g} us, "
        f"{1e3 * step:.3g} mm; the tick makes {percent(share)} of the variance of the noise"
    )
    parameters = (Parameter("step", grid.step, 0.0, "s"),)
    return Finding(
        FACTS, grid.evidence, because, parameters, view.observations.usable, None, share, step / 12**0.5
    )


def draw(table: Columns, random: np.random.Generator) -> None:
    """Count ticks of 16 us."""
    speed = 331.4 + 0.6 * table["temperature_C"]
    tick = 0.5 * speed * 16e-6  # m
    table["reading_m"] = np.round(table["reading_m"] / tick) * tick


NOISE = Quantization(facts=FACTS, draw=draw, detect=detect, imitates=("cycle_slip", "polling_jitter"))
