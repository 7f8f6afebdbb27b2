"""The study's question: the page is made of the board's readings, and another table brings another answer."""

import json
import re
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from echocal import DataError, silicon
from echocal.study import Tables
from echocal.study.question import picture
from echocal.study.question.answer import Answer, answer
from echocal.study.question.explanations import (
    compare,
    curve,
    deviation,
    explain,
    involved,
    pattern_of,
    unrounded,
    without_steps,
)
from echocal.study.question.investigation import Investigation, Readings, run
from echocal.study.question.laws import ALL, suspect
from echocal.study.question.measurements import MEASUREMENTS, separation
from echocal.study.question.page import FIGURES, render
from echocal.study.tables import Printed, Table

DOCS = Path(__file__).parents[1] / "docs"
READINGS = DOCS / "study-question.json"
MEASURE = {one.id: one for one in MEASUREMENTS}

Run = Callable[..., tuple[int, str]]


@pytest.fixture(scope="module")
def board() -> Investigation:
    return Investigation.load(READINGS)


@pytest.fixture(scope="module")
def found(board: Investigation) -> Answer:
    return answer(board)


def with_tinkercad(readings: np.ndarray) -> Table:
    """Table 2 with other readings of Tinkercad [m], printed to a millimeter."""
    table = Tables.load().table2
    cells = tuple(Printed(f"{value:.3f}") for value in readings)
    return replace(table, columns={**table.columns, "measured_distance_tinkercad_m": cells})


def test_the_page_is_fresh(found: Answer) -> None:
    fresh = render(found)
    page = (DOCS / "study-question.md").read_text(encoding="utf-8")
    assert page == fresh, "run: echocal study --out docs --quiet"


def test_the_file_is_what_the_board_made(board: Investigation) -> None:
    assert board.text() == READINGS.read_text(encoding="utf-8")
    assert list(board.far) == [one.id for one in ALL]
    assert {one.id for one in ALL if one.place not in ("setting", "none") and not one.absent} == set(
        board.near
    )
    assert board.temperature.tolist() == Tables.load().table2.temperature.tolist()


@pytest.mark.skipif(
    bool(silicon.missing_for_sketches()), reason=f"absent: {', '.join(silicon.missing_for_sketches())}"
)
def test_the_board_gives_the_same_readings_again(board: Investigation) -> None:
    """27 rows of a suspect whose readings hang on every part: interrupts, law, converter, rounding."""
    again = run(suspect("pulse_in"), board.temperature, 0.5, 1)
    np.testing.assert_array_equal(again.reading, board.near["pulse_in"].reading)
    np.testing.assert_array_equal(again.duration, board.near["pulse_in"].duration)


# mean less the calculation at 2 m [mm] and its tolerance, from figures of the sketches and from arithmetic
MEANS = {
    "nothing": (0.0, 0.3),
    "pulse_in": (-0.00584 * 1979.0, 0.5),
    "print_9600": (-24.0, 3.0),
    "pulse_in_long": (0.0, 0.4),
    "module_factor": ((343.0 / 344.6 - 1.0) * 1979.0, 0.3),
    "divide_29_1": ((1e4 / 29.1 / 343.0 - 1.0) * 1979.0, 0.3),
    "factor_034": ((340.0 / 343.0 - 1.0) * 1979.0, 0.3),
    "law_332": ((346.3 / 347.0 - 1.0) * 1979.0, 0.3),
    "whole_degrees": (-0.5 * 3.42, 0.4),
}


@pytest.mark.parametrize("name", MEANS)
def test_what_a_suspect_makes_agrees_with_arithmetic(name: str, found: Answer) -> None:
    mean, tolerance = MEANS[name]
    assert found.of(name).pattern.mean == pytest.approx(mean, abs=tolerance)


def test_table_2_has_this_pattern(found: Answer) -> None:
    wanted = found.wanted
    assert wanted.mean == pytest.approx(-7.667, abs=1e-3)  # as the study: MAE 7.67 mm
    assert wanted.step == 1
    assert wanted.mean_error == pytest.approx(2.36 / np.sqrt(27), abs=2e-3)
    assert abs(wanted.slope) < wanted.slope_error


def test_each_suspect_is_excluded_by_what_it_makes(found: Answer) -> None:
    why = {one.suspect.id: one.verdict.excluded_by for one in found.made}
    assert why["pulse_in"] == why["print_9600"] == ("size",)
    assert why["latency"] == ("sign",)
    assert why["divide_58"] == ("sign",)
    assert "step" in why["whole_cm"]
    assert "slope" in why["damp_air"]
    assert "absent" in why["comparator"]
    for name in ("target", "module_speed", "late_polling"):
        assert why[name] == (), name


def test_every_cause_of_the_class_is_judged(found: Answer) -> None:
    assert [one.id for one in found.members if not one.verdict] == []
    verdicts = {one.id: one.verdict for one in found.members}
    assert verdicts["fixed_delay"] == "sign"
    assert verdicts["interrupt_loss"] == "size"
    assert verdicts["zero_error"] == "remains"


def test_probabilities_are_those_of_all_explanations(found: Answer) -> None:
    assert sum(one.probability for one in found.explanations) == pytest.approx(1.0)
    for one in found.explanations:
        places = [own.place for own in one.suspects]
        assert len(set(places)) == len(places)
        assert not any(own.absent for own in one.suspects)


@pytest.mark.statistical
def test_what_only_one_run_of_the_board_has_is_no_evidence(
    board: Investigation, random: np.random.Generator
) -> None:
    """Jitter and rounding of the rows are smoothed away; steps that belong to a suspect stay."""
    table = Tables.load().table2
    before = board.far["target"]
    shaken = Readings("target", before.reading + random.normal(0.0, 1e-3, 27), before.duration)
    smooth, again = (without_steps(table, suspect("target"), one) for one in (before, shaken))
    assert np.sqrt(((again - smooth) ** 2).mean()) < 3.0 * np.sqrt(3 / 27), "three coefficients of a curve"
    exact = 1e3 * (686.0 / (331.3 + 0.6 * table.temperature))
    assert 1e3 * unrounded(table) == pytest.approx(exact, abs=0.15)
    cut = without_steps(table, suspect("law_integer"), board.far["law_integer"])
    speed = 331.3 + 0.6 * table.temperature
    assert cut == pytest.approx(exact * (speed / np.floor(speed + 1e-9) - 1.0), abs=0.9)


def test_steps_of_the_simulator_and_pulse_in_make_mean_and_scatter(found: Answer) -> None:
    """By hand: half a step is the mean, a twelfth of its square the variance."""
    missing = found.wanted.mean - found.of("pulse_in").pattern.mean
    step = missing / (0.5 * 0.1715 * 0.99)
    scatter = np.hypot(step * 0.1715 / np.sqrt(12.0), found.of("pulse_in").scatter[1])
    page = render(found)
    told = re.search(
        r"a step of (\d+) us brings the mean of Table 2. Then both scatter by ([\d.]+) mm", flat(page)
    )
    assert told is not None
    assert float(told[1]) == pytest.approx(step, rel=0.06)
    assert float(told[2]) == pytest.approx(scatter, rel=0.1)


def flat(page: str) -> str:
    return " ".join(page.split())


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("pulse_in", "latency"),
        ("latency", "pulse_in"),
        ("law_332", "divide_58"),
        ("divide_58", "law_332"),
    ],
)
def test_another_table_brings_another_answer(
    name: str, other: str, board: Investigation, random: np.random.Generator
) -> None:
    """Rows that one suspect made, with the scatter of Table 2, are given to that suspect or to its sum."""
    table = Tables.load().table2
    made = curve(table, board.far[name])
    calculation = table.values("measured_distance_calculation_m")
    scattered = calculation + 1e-3 * (made + random.normal(0.0, 2.0, len(made)))
    planted = with_tinkercad(scattered)
    best = explain(planted, ALL, board.far)
    single = {one.name: one for one in best if len(one.suspects) == 1}
    assert single[name].probability == max(one.probability for one in single.values()) or (
        single[name].left == pytest.approx(min(one.left for one in single.values()), rel=0.05)
    )
    assert compare(planted, suspect(name), board.far[name]).remains
    assert not compare(planted, suspect(other), board.far[other]).remains


def test_a_free_size_is_found(board: Investigation, random: np.random.Generator) -> None:
    table = Tables.load().table2
    offset = float(random.uniform(-8.0, 8.0))
    readings = table.values("measured_distance_calculation_m") + 1e-3 * (
        offset * 0.99 + random.normal(0.0, 1.0, len(table))
    )
    planted = with_tinkercad(readings)
    size = compare(planted, suspect("target"), board.far["target"]).size
    assert size == pytest.approx(offset, abs=1.0)
    alone = next(one for one in explain(planted, ALL, board.far) if one.name == "target")
    assert alone.sizes["target"] == pytest.approx(offset, abs=1.0)
    assert alone.size_errors["target"] == pytest.approx(0.2, abs=0.15)


def test_nothing_is_the_answer_where_nothing_is_wrong(board: Investigation) -> None:
    calculation = Tables.load().table2.values("measured_distance_calculation_m")
    alternating = calculation + 1e-3 * np.resize([1.0, -1.0], len(calculation))
    best = explain(with_tinkercad(alternating), ALL, board.far)
    assert best[0].name == "nothing"


def test_steps_of_readings_are_seen() -> None:
    temperature = np.linspace(0.0, 50.0, 27)
    for step in (10, 5, 2, 1):
        readings = np.round(np.linspace(2070.0, 1890.0, 27) / step) * step / 1e3
        assert pattern_of(temperature, readings * 1e3, readings).step == step


def test_how_far_apart_a_measurement_sets_two_explanations(found: Answer) -> None:
    """By hand: what pulseIn() loses comes back, over the scatter of two means of ten readings."""
    by_name = {one.name: one for one in found.explanations}
    pair = by_name["pulse_in"], by_name["target"]
    held = separation(MEASURE["interrupts_held"], pair, found.effects)
    lost = -found.of("pulse_in").pattern.mean
    assert held == pytest.approx(lost / (found.effects.jitter * np.sqrt(0.2)), rel=1e-6)
    # a label does not say where pulseIn() counts
    assert separation(MEASURE["label"], pair, found.effects) > 5.0
    assert (
        separation(MEASURE["interrupts_held"], (by_name["target"], by_name["law_332"]), found.effects) == 0.0
    )
    assert separation(MEASURE["second_distance"], pair, found.effects) < 3.0, "the mouse errs there, too"


def test_what_is_measured_next_tells_more_than_is_known(found: Answer) -> None:
    now = sum(one.probability**2 for one in found.explanations)
    worth = {one.measurement.id: one.expected_probability for one in found.outcomes}
    assert list(worth.values()) == sorted(worth.values(), reverse=True)
    assert min(worth.values()) > now - 0.02  # 4000 draws
    assert worth["steps_and_interrupts"] > worth["steps"] > worth["microseconds"] - 0.02


def test_shares_of_suspects_count_pairs(found: Answer) -> None:
    shares = involved(found.explanations)
    alone = next(one for one in found.explanations if one.name == "target")
    assert shares["target"] > alone.probability
    assert all(0.0 <= share <= 1.0 + 1e-9 for share in shares.values())


def test_figures(found: Answer, tmp_path: Path) -> None:
    for path in picture.save(found, tmp_path):
        width, height = struct.unpack(">II", path.read_bytes()[16:24])
        assert (width, height) > (1000, 400)
        assert (DOCS / path.name).exists()
    assert len(FIGURES) == 2


def test_the_command_makes_the_page_of_readings_that_are_there(run: Run, tmp_path: Path) -> None:
    (tmp_path / "study-question.json").write_text(READINGS.read_text(encoding="utf-8"), encoding="utf-8")
    code, told = run("study", "--quiet", "--out", ".", "--json", "study.json")
    assert code == 0, told
    page = (tmp_path / "study-question.md").read_text(encoding="utf-8")
    assert page == (DOCS / "study-question.md").read_text(encoding="utf-8")
    question = json.loads((tmp_path / "study.json").read_text(encoding="utf-8"))["question"]
    assert question["table_2"]["mean"] == pytest.approx(-7.667, abs=1e-3)
    assert {one["id"] for one in question["suspects"]} == {one.id for one in ALL}


def test_without_the_tools_it_says_what_to_install(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(silicon.arduino, "missing_for_sketches", lambda: ["avr-gcc", "arduino-core-avr"])
    code, told = run("study", "--emulate", "--quiet")
    assert code == 2
    assert "apt install gcc-avr avr-libc arduino-core-avr" in told
    assert len(told.strip().splitlines()) == 1


def test_a_file_that_holds_something_else_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "study-question.json"
    path.write_text('{"schema": "mine/1"}', encoding="utf-8")
    with pytest.raises(DataError, match="holds no readings of the study's question"):
        Investigation.load(path)


def test_a_curve_of_another_size_is_proportional() -> None:
    table = Tables.load().table2
    readings = Readings("x", table.values("measured_distance_calculation_m")[None] + 0.002, np.zeros((1, 27)))
    assert curve(table, readings) == pytest.approx(np.full(27, 2.0))
    assert curve(table, readings, size=-3.0, staged=1.0) == pytest.approx(np.full(27, -6.0))
    assert deviation(table).mean() == pytest.approx(-7.667, abs=1e-3)
