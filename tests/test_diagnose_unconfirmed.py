"""A cause of the model is named only if the rows that judge the model show it, too."""

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.diagnose.settings import Settings

ROWS, DAY = 600, 86400.0
DELAY, NOISE = 60e-6, 2e-6
_GAINS = {"temperature_gain", "speed_slope"}


def device(random: np.random.Generator, gain_until: float) -> pd.DataFrame:
    """Echoes of a device with a delay; until a time, its thermometer has an error of gain, too."""
    time = np.arange(ROWS) * 12 * DAY / ROWS
    air = 12 + 9 * np.sin(2 * np.pi * time / DAY) + random.normal(0, 1.0, ROWS)
    distance = random.uniform(0.5, 3.5, ROWS)
    echo = 2 * distance / echocal.speed_of_sound(air) + DELAY + random.normal(0, NOISE, ROWS)
    read = np.where(time < gain_until, air * 1.03, air)
    return pd.DataFrame({"time_s": time, "temperature_C": read, "distance_m": distance, "echo_s": echo})


@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore")
def test_what_ends_before_the_held_out_rows_is_not_named(random: np.random.Generator) -> None:
    table = device(random, gain_until=8 * DAY)
    held = echocal.diagnose(table, base="cramer", hold_out_after=8 * DAY)
    causes = [cause for cause in held.causes if cause.kind == "effect"]
    assert held.verdict == "named"
    shown, unseen = ([c for c in causes if bool(c.doubt) == doubted] for doubted in (False, True))
    assert shown
    assert unseen
    assert not any(_GAINS & {cause.id, *cause.indistinguishable_from} for cause in shown)
    for cause in unseen:
        assert _GAINS & {cause.id, *cause.indistinguishable_from}
        assert "held-out rows do not show" in cause.doubt
        assert cause.in_model  # these rows choose nothing
    seen = table[table["time_s"] <= 8 * DAY]
    assert len(echocal.diagnose(seen, base="cramer").model.effects) == len(held.model.effects)


@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore")
def test_what_goes_on_is_named(random: np.random.Generator) -> None:
    held = echocal.diagnose(device(random, np.inf), base="cramer", hold_out_after=8 * DAY)
    shown = [cause for cause in held.causes if cause.kind == "effect" and cause.in_model and not cause.doubt]
    assert any(_GAINS & {cause.id, *cause.indistinguishable_from} for cause in shown)
    assert len(shown) >= 2


@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore")
def test_the_threshold_is_a_setting(random: np.random.Generator) -> None:
    """No evidence is enough for a threshold that no rows reach."""
    assert Settings().claims.strong == 3.0
    table = device(random, gain_until=np.inf)
    found = echocal.diagnose(table, base="cramer", settings={"claims": {"strong": 1e9}})
    assert found.verdict == "ambiguous"
    assert all("cross-validated rows do not show" in c.doubt for c in found.causes if c.in_model)
