"""Another explanation of a claim is told, and withholds nothing."""

import numpy as np
import pandas as pd
import pytest

import echocal

ROWS = 120


def table(random: np.random.Generator, speed: float) -> pd.DataFrame:
    """Readings of a device that converts with one speed."""
    distance = np.repeat(np.linspace(0.4, 3.2, 12), ROWS // 12)
    celsius = 18.0 + random.normal(0.0, 2.0, ROWS)
    echo = 2.0 * distance / (331.4 + 0.6 * celsius) + random.normal(0.0, 1.5e-6, ROWS)
    return pd.DataFrame({"temperature_C": celsius, "distance_m": distance, "reading_m": speed * echo / 2.0})


@pytest.mark.statistical
@pytest.mark.parametrize(("true", "stated"), [(331.4, 343.0), (340.0, 344.8)])
def test_a_wrong_speed_is_asked_for(random: np.random.Generator, true: float, stated: float) -> None:
    found = echocal.diagnose(table(random, true), reading_speed=stated)
    (note,) = (note for note in found.notes if "give it with reading_speed" in note)
    assert float(note.split("converts with ")[1].split(" ")[0]) == pytest.approx(true, abs=0.5)
    assert found.model.effects
    right = echocal.diagnose(table(random, true), reading_speed=true)
    assert not any("give it with reading_speed" in note for note in right.notes)


@pytest.mark.statistical
def test_recorded_echo_times_have_no_reading_speed(random: np.random.Generator) -> None:
    rows = table(random, 343.0)
    rows["echo_us"] = rows.pop("reading_m") * 1.02 * 2e6 / 343.0
    found = echocal.diagnose(rows)
    assert found.model.effects
    assert not any("give it with reading_speed" in note for note in found.notes)
