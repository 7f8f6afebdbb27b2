"""A sensor on a desk: ruler distances, bursts of pings in recorded order; see ../shared/data."""

import re
from pathlib import Path

import pandas as pd
import pytest

import echocal
from echocal.diagnose import Cause

COLUMNS = {
    "true_cm": "distance_cm",
    "temp_C": "temperature_C",
    "reading_cm": "reading_cm",
    "obs": "order",
    "file": "group",
}


@pytest.fixture(scope="module")
def path(shared: Path) -> Path:
    return shared / "data" / "desk-hcsr04" / "hcsr04_known_distance_tidy.csv"


@pytest.fixture(scope="module")
def diagnosis(path: Path) -> echocal.Diagnosis:
    with pytest.warns(echocal.DataWarning):
        return echocal.diagnose(path, columns=COLUMNS, reading_speed="331.3+0.606*T")


def found(diagnosis: echocal.Diagnosis, id_: str) -> Cause:
    (cause,) = [c for c in diagnosis.causes if id_ in (c.id, *c.indistinguishable_from)]
    return cause


def test_no_offset_and_no_scale_stand_for_whole_periods(diagnosis: echocal.Diagnosis) -> None:
    """The errors go in steps of whole periods with the distance and from session to session."""
    effects = {c.id for c in diagnosis.causes if c.kind == "effect" and c.probability >= 0.9 and not c.doubt}
    assert effects == {"first_ping"}
    assert found(diagnosis, "cycle_offset").probability >= 0.9


def test_nothing_at_the_edge_of_the_beam_stands_in_for_them(diagnosis: echocal.Diagnosis) -> None:
    assert "beam_edge" not in {c.id for c in diagnosis.causes}


def test_slips_are_of_one_period(diagnosis: echocal.Diagnosis) -> None:
    cause = found(diagnosis, "cycle_slip")
    sizes = {p.name: p.value for p in cause.parameters}
    assert cause.probability >= 0.9
    assert sizes["period"] == pytest.approx(25e-6)
    assert 0.05 < sizes["probability"] < 0.4


def test_the_first_ping_differs_as_medians_say(diagnosis: echocal.Diagnosis, path: Path) -> None:
    table = pd.read_csv(path)  # an independent look: medians of each distance, first ping and others
    off = 10 * (table["reading_cm"] - table.groupby("true_cm")["reading_cm"].transform("median"))
    first = table["obs"] == "Obs. 1"
    seen = off[first].median() - off[~first].median()  # mm
    cause = found(diagnosis, "first_ping")
    (delay,) = cause.parameters
    assert cause.probability >= 0.9
    assert 1e3 * delay.value * 349.0 / 2 == pytest.approx(seen, abs=0.3)  # at 29 degC
    said = re.search(r"first ping reads (\S+) mm .* predicts (\S+) mm", cause.because)
    assert said is not None
    assert float(said[1]) == pytest.approx(float(said[2]), abs=0.3)  # what it tells to check is there


def test_near_echoes_are_late_and_the_model_has_it(diagnosis: echocal.Diagnosis) -> None:
    """Medians over the distance fall by 16 mm from 5 cm to 75 cm, and by 3 mm from there to 1.5 m."""
    late = found(diagnosis, "receiver_recovery")
    delay = next(p for p in late.parameters if p.name == "delay")
    assert late.in_model
    assert 70e-6 < delay.value < 180e-6
    assert diagnosis.gain is not None
    assert diagnosis.gain.rms_after_m < 0.4 * diagnosis.gain.rms_before_m
    assert diagnosis.gain.interval_95[0] > 3e-3


def test_the_gain_is_no_better_than_that_of_the_model(diagnosis: echocal.Diagnosis) -> None:
    """A fold names a scale that all rows together do not; the model that ships has none."""
    gain = diagnosis.gain
    assert gain is not None
    assert gain.rms_after_m >= gain.ladder[-1][1]
