"""What the sentences say, and what they do not say twice."""

from dataclasses import replace

import numpy as np
import pytest

import echocal
from echocal.diagnose import Cause, NextMeasurement
from echocal.diagnose.findings.parts import SmoothCorrection
from echocal.diagnose.results.explain import explain, lead, proposal_text
from echocal.diagnose.results.smooth import smooth_text
from echocal.model import Shape, Smooth

EFFECT = Cause("clock_error", "effect", 0.97, (), ("oblique_target",), "far rows read more")
SLIP = Cause("cycle_slip", "noise", 1.0, (), (), "some rows jump", in_model=False)


@pytest.fixture(scope="module")
def diagnosis() -> echocal.Diagnosis:
    reading = 1.0 + 1e-3 * np.sin(np.arange(60.0) ** 2)
    table = {"reading_m": reading, "temperature_C": 20.0 + 15.0 * np.sin(2.4 * np.arange(60.0))}
    return echocal.diagnose(table, reference_distance=1.0)


@pytest.mark.parametrize(
    ("causes", "said"),
    [
        ((EFFECT,), "The data name the cause clock_error (or oblique_target)"),
        ((replace(EFFECT, indistinguishable_from=("a", "b")),), "(or one of 2 similar causes)"),
        ((EFFECT, SLIP), "They also name cycle_slip, which acts on the noise"),
        ((SLIP,), "The data name no cause that shifts the readings. They name cycle_slip, which acts"),
        ((replace(EFFECT, doubt="its size differs"), SLIP), "no cause that shifts the readings. They name"),
        ((replace(EFFECT, probability=0.6), SLIP), "no cause that shifts the readings. They name"),
        (
            (replace(EFFECT, probability=0.85), SLIP),
            "has clock_error (or oblique_target) (probability 0.85, a name needs 0.9), which may act",
        ),
    ],
)
def test_the_first_sentence_names_what_is_named_and_no_more(
    diagnosis: echocal.Diagnosis, causes: tuple[Cause, ...], said: str
) -> None:
    assert said in lead(replace(diagnosis, verdict="named", causes=causes))


def test_nothing_is_said_to_be_gained_where_nothing_extends_the_base(diagnosis: echocal.Diagnosis) -> None:
    assert diagnosis.verdict == "nothing"
    text = explain(diagnosis)
    assert text.startswith("No effect is detected.\n60 of 60 rows are used.\n")
    assert "extended model" not in text
    assert "No effect extends the base." in text


def test_a_doubt_and_a_fault_are_told_once(diagnosis: echocal.Diagnosis) -> None:
    doubted = replace(EFFECT, doubt="the size of clock_error differs")
    notes = (
        "the size of clock_error differs",
        "cycle_slip: some rows jump",
        "3 of 60 rows cannot be used: 3",
    )
    text = explain(replace(diagnosis, verdict="unknown", causes=(doubted, SLIP), notes=notes))
    assert text.count("the size of clock_error differs") == 1
    assert text.count("some rows jump") == 1
    assert "cannot be used" not in text


def test_a_proposal_reads_as_a_person_would_say_it() -> None:
    at = {"distance": [3.0], "temperature": [35.0], "rows": [10]}
    one = proposal_text(NextMeasurement(at, ("nothing", "speed_slope"), 0.9, 0.6))
    assert one.startswith("to test for speed_slope: measure 10 rows at 3 m, 35 degC. The")
    at = {"distance": [0.3, 3.0], "rows": [4, 6]}
    two = proposal_text(NextMeasurement(at, ("clock_error", "zero_error", "nothing"), 0.9, 0.6))
    assert "to separate clock_error, zero_error and no effect: measure 10 rows (4 at 0.3 m; 6 at 3 m)." in two


def test_places_that_read_the_same_are_one_place() -> None:
    reading = 1.008 + 1e-3 * np.sin(np.arange(60.0) ** 2)
    table = {"reading_m": reading, "temperature_C": np.full(60, 20.0)}
    diagnosis = echocal.diagnose(table, reference_distance=1.0)
    plans = [p.conditions for p in diagnosis.next_measurements if "rows" in p.conditions]
    assert plans
    for plan in plans:
        names = [name for name in plan if name != "rows"]
        places = list(zip(*(plan[name] for name in names), strict=True))
        assert len(set(places)) == len(places)
        assert sum(plan["rows"]) == 10


def test_an_unknown_effect_is_told_beside_those_that_the_model_has(diagnosis: echocal.Diagnosis) -> None:
    text = lead(replace(diagnosis, verdict="unknown", causes=(replace(EFFECT, doubt="few rows carry it"),)))
    assert text.startswith("The data show an effect outside the catalogue. The model has clock_error")


def test_a_smooth_correction_that_is_not_offered_has_the_reason_that_decided() -> None:
    tried = Smooth(0.0, (Shape("temperature", (0.0, 20.0), (0.0, 2e-3), (1e-4, 1e-4)),))
    found = SmoothCorrection(
        tried=("temperature",),
        smooth=tried,
        scheme="nested, blocked by time, 5 folds",
        rms_before_m=2e-3,
        rms_after_m=1e-3,
        held_out_rows=100,
        interval_95=(0.5e-3, 1.5e-3),
        variance_removed=0.75,
        variance_removed_interval_95=(0.6, 0.8),
        chosen_by_folds=(("temperature",),) * 5,
    )
    assert found.offered
    one_fold = replace(found, chosen_by_folds=(*[("temperature",)] * 4, ()))
    assert not one_fold.offered
    assert "1 of 5 folds choose no correction" in smooth_text(one_fold)
    assert "not above 0" not in smooth_text(one_fold)
    chance = replace(found, interval_95=(-0.1e-3, 1.5e-3))
    assert "interval of the gain is not above 0" in smooth_text(chance)


def test_the_first_sentence_has_the_reason_why_nothing_is_named(diagnosis: echocal.Diagnosis) -> None:
    causes = (replace(EFFECT, doubt="its interval is not above 0", in_model=False),)
    said = lead(replace(diagnosis, verdict="ambiguous", causes=causes))
    assert "their gain may be chance, so the model is the base" in said
