"""A diagnosis as one page: what it says, that it needs nothing from any host, and that a browser shows it."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browsed import CLEAN, Text, browsed

import echocal

pytest.importorskip("plotly")
from echocal.report.html import report_page
from echocal.report.html.errors import distance_figure, time_figure, truth_figure

ROWS = 300
Run = Callable[..., tuple[int, str]]


def table(random: np.random.Generator, distance: np.ndarray, offset: float) -> pd.DataFrame:
    celsius = random.uniform(5.0, 35.0, ROWS)
    reading = distance + offset + random.normal(0.0, 1e-3, ROWS)
    return pd.DataFrame({"reading_m": reading, "temperature_C": celsius, "distance_m": distance})


@pytest.fixture(scope="module")
def named(request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]) -> echocal.Diagnosis:
    """An offset of 10 mm at three distances, with some ghosts and two rows without a reading."""
    random = seeded(request)
    rows = table(random, np.repeat([0.5, 1.5, 3.0], ROWS // 3), 10e-3)
    ghosts = 20 + random.choice(ROWS - 20, 4, replace=False)  # not those without a reading
    rows.loc[ghosts, "reading_m"] = 0.07  # no distance in another unit
    rows.loc[[7, 8], "reading_m"] = np.nan
    return echocal.diagnose(rows, base="343")


def test_it_says_what_the_diagnosis_says(named: echocal.Diagnosis) -> None:
    text = Text(report_page(named, "tank <7>.csv")).seen
    assert "tank <7>.csv" in text  # as text, not as a tag
    assert named.explain().partition("\n")[0].rstrip(".:") in text
    for cause in named.causes:
        assert cause.id in text
        assert cause.because in text
    assert named.gain is not None
    for rms in (named.gain.rms_before_m, named.gain.rms_after_m):
        assert f"{1e3 * rms:.2f} mm" in text
    assert f"{named.rows['used']} of {named.rows['total']} rows are used" in text
    for reason, count in named.fates.counts.items():
        assert f"{reason} {count}" in text


def test_it_needs_nothing_from_any_host(named: echocal.Diagnosis) -> None:
    assert Text(report_page(named)).fetched == ["data:,"]


def test_each_drawn_error_is_one_of_the_table(named: echocal.Diagnosis) -> None:
    """Row numbers and errors of the first figure, as they stand in the page."""
    page = report_page(named)
    (figure,) = re.findall(r'Plotly\.newPlot\(\s*"[^"]+",\s*(\[.*?\]),\s*\{"', page, re.DOTALL)[:1]
    before, after = (trace for trace in json.loads(figure) if trace["name"] != "left out")
    for trace, error in ((before, named.traces.before), (after, named.traces.after)):
        of_row = dict(zip((named.traces.row + 1).tolist(), error.tolist(), strict=True))
        assert len(trace["y"]) == np.isfinite(error).sum()
        told = [1e3 * of_row[row] for row in trace["customdata"]]
        assert trace["y"] == pytest.approx(told, rel=1e-5, abs=1e-9)


def test_marks_show_where_rows_are_left_out(named: echocal.Diagnosis) -> None:
    figure = time_figure(named)
    marked = [np.asarray(trace.x) for trace in figure.data if trace.name == "left out"]
    out = [row for row, fate in enumerate(named.fates.fate, start=1) if fate in named.fates.counts]
    assert len(out) >= 6
    assert [x.tolist() for x in marked] == [out, out]


def test_a_worse_model_looks_worse(named: echocal.Diagnosis) -> None:
    traces = named.traces
    worse = replace(named, traces=replace(traces, before=traces.after, after=traces.before))
    layout = time_figure(worse).layout
    assert layout.yaxis.range == layout.yaxis2.range
    assert layout.annotations[1].text == "extended model, at the same scale"


def test_distance_and_reading_stand_beside_the_truth(named: echocal.Diagnosis) -> None:
    traces = named.traces
    over_time, against_truth = distance_figure(named), truth_figure(named)
    for figure in (over_time, against_truth):
        assert [trace.name for trace in figure.data] == ["base", "extended model", "true"]
    reading = traces.against["distance"] + traces.before
    assert list(against_truth.data[0].y) == pytest.approx(reading[np.isfinite(reading)], rel=1e-5)
    page = Text(report_page(named)).seen
    assert page.index("Over distance") < page.index("Distance over") < page.index("Reading against truth")


def test_it_says_how_to_make_it_again(run: Run, random: np.random.Generator) -> None:
    table(random, np.repeat([0.5, 1.5, 3.0], ROWS // 3), 10e-3).to_csv("my log.csv", index=False)
    assert run("diagnose", "my log.csv", "--base", "343", "--quiet", "--report", "log.html")[0] == 0
    text = Text(Path("log.html").read_text(encoding="utf-8")).seen
    assert "echocal diagnose 'my log.csv' --base 343 --quiet --report log.html" in text
    assert "echocal correct my log.csv" not in text


def test_a_table_in_which_nothing_is_wrong_has_a_page_too(random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(table(random, np.full(ROWS, 1.5), 0.0), base="343")
    text = Text(report_page(diagnosis)).seen
    assert diagnosis.verdict in text
    assert ("No cause is reported." in text) == (not diagnosis.causes)


def test_the_command_writes_it_and_replaces_only_its_own(run: Run, random: np.random.Generator) -> None:
    table(random, np.repeat([0.5, 1.5, 3.0], ROWS // 3), 10e-3).to_csv("log.csv", index=False)
    words = ("diagnose", "log.csv", "--base", "343", "--quiet", "--report")
    assert run(*words, "log.html")[0] == 0
    assert "log.csv" in Path("log.html").read_text()
    assert run(*words, "log.html")[0] == 0  # again, over its own page
    Path("notes.html").write_text("<p>mine</p>")
    code, said = run(*words, "notes.html")
    assert code != 0
    assert "notes.html" in said
    assert Path("notes.html").read_text() == "<p>mine</p>"
    code, said = run(*words, "log.csv")
    assert code != 0
    assert "log.csv" in said
    assert Path("log.csv").read_text().startswith("reading_m")


@pytest.mark.slow
def test_a_browser_shows_it(named: echocal.Diagnosis, tmp_path: Path) -> None:
    """Every figure is drawn, and the console has no error; a phone has no line that is cut off."""
    assert browsed(report_page(named), tmp_path) == CLEAN
