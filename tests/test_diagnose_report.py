"""A diagnosis as one page: what it says, that it needs nothing from any host, and that a browser shows it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browsed import CLEAN, Text, browsed, chromium, drawn_in

import echocal
from echocal.charts.errors import distance_chart, time_chart, truth_chart
from echocal.charts.parts import Axis, Chart, Panel, Points, Rug
from echocal.charts.results import posterior_chart
from echocal.diagnose.results.brief import brief
from echocal.report.html import report_page
from echocal.report.html.document import drawn

ROWS = 300
WHERE = """() => {
  const path = document.querySelector(".points.before");
  const at = path.getAttribute("d").split("M")[100].match(/[-\\d.e]+/g);
  const point = new DOMPoint(+at[0], +at[1]).matrixTransform(path.getScreenCTM());
  return [point.x, point.y];
}"""
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


def test_it_needs_nothing_from_any_host_and_is_small(named: echocal.Diagnosis) -> None:
    page = report_page(named)
    assert Text(page).fetched == ["data:,"]
    assert len(page) < 200_000


def test_a_page_of_a_long_table_is_below_a_megabyte(named: echocal.Diagnosis) -> None:
    """Twenty thousand rows, with four columns to draw over."""
    rows = np.arange(20_000)
    noise = np.sin(1e4 * rows)
    columns = {name: place + np.sin(rows * (place + 1.1)) for place, name in enumerate("abcd")}
    traces = replace(
        named.traces,
        row=rows,
        before=1e-3 * noise + 0.01,
        after=1e-4 * noise,
        against={**columns, "time": 60.123 * rows, "distance": 2.0 + noise},
        begin=np.datetime64("2024-07-03T10:00"),
    )
    assert len(report_page(replace(named, traces=traces))) < 1_000_000


def test_links_lead_to_a_place_of_the_page(named: echocal.Diagnosis) -> None:
    text = Text(report_page(named))
    assert {"causes", "errors", "rows", "model"} <= set(text.links) <= set(text.ids)
    assert len(text.ids) == len(set(text.ids))


def test_causes_come_before_the_errors(named: echocal.Diagnosis) -> None:
    page = report_page(named)
    assert page.index('id="causes"') < page.index('id="gain"') < page.index('id="errors"')


def test_no_probability_has_an_axis_beyond_one(named: echocal.Diagnosis) -> None:
    chart = posterior_chart(replace(named, posterior=(((), 0.4), (("cycle_slip",), 0.6))))
    assert chart.most == 1.0
    assert "width:60%" in drawn(chart)


def test_times_are_dates(random: np.random.Generator) -> None:
    rows = table(random, np.full(ROWS, 1.5), 0.01)
    rows["time"] = pd.date_range("2024-07-03T10:00", periods=ROWS, freq="h").astype(str)
    diagnosis = echocal.diagnose(rows, base="343")
    x = time_chart(diagnosis).x
    assert (x.begin, x.label) == (np.datetime64("2024-07-03T10:00"), "time (UTC)")
    assert x.low <= 0.0
    assert x.high >= 3600.0 * (ROWS - 1)
    assert 'data-begin="2024-07-03T10:00:00.000Z"' in report_page(diagnosis)
    rows = rows.drop(columns="time").assign(time_s=3600.0 * np.arange(ROWS))
    assert time_chart(echocal.diagnose(rows, base="343")).x.label == "time [d]"


def test_each_drawn_error_is_one_of_the_table(named: echocal.Diagnosis) -> None:
    """Row numbers and errors of the first figure, as they stand in the page."""
    before, after = (mark for mark in drawn_in(report_page(named), 0) if mark.rows)
    for mark, error in ((before, named.traces.before), (after, named.traces.after)):
        of_row = dict(zip((named.traces.row + 1).tolist(), error.tolist(), strict=True))
        assert len(mark.y) == len(mark.rows) == np.isfinite(error).sum()
        assert mark.y == pytest.approx([1e3 * of_row[row] for row in mark.rows], rel=1e-5, abs=1e-9)


def test_marks_show_where_rows_are_left_out(named: echocal.Diagnosis) -> None:
    marked = [mark.x for panel in time_chart(named).panels for mark in panel.marks if isinstance(mark, Rug)]
    out = [row for row, fate in enumerate(named.fates.fate, start=1) if fate in named.fates.counts]
    assert len(out) >= 6
    assert [x.tolist() for x in marked] == [out, out]


def test_a_worse_model_looks_worse(named: echocal.Diagnosis) -> None:
    traces = named.traces
    worse = replace(named, traces=replace(traces, before=traces.after, after=traces.before))
    first, second = time_chart(worse).panels
    assert first.y == second.y
    assert second.title == "after: extended model, at the same scale"


def test_distance_and_reading_stand_beside_the_truth(named: echocal.Diagnosis) -> None:
    traces = named.traces
    over_time, against_truth = distance_chart(named), truth_chart(named)
    for chart in (over_time, against_truth):
        assert isinstance(chart, Chart)
        assert [mark.name for mark in chart.panels[0].marks] == ["base", "extended model", "true"]
    reading = traces.against["distance"] + traces.before
    assert isinstance(against_truth, Chart)
    (base, *_) = against_truth.panels[0].marks
    assert isinstance(base, Points)
    assert base.y == pytest.approx(reading[np.isfinite(reading)])
    page = Text(report_page(named)).seen
    assert page.index("Over distance") < page.index("Distance over") < page.index("Reading against truth")


def test_a_name_is_no_markup() -> None:
    name = '"><script>x'
    panel = Panel(name, Axis(name, 0.0, 1.0), [Points(name, "before", np.zeros(1), np.zeros(1))])
    assert "<script" not in drawn(Chart(name, Axis(name, 0.0, 1.0), [panel], name))


def test_it_says_how_to_make_it_again(run: Run, random: np.random.Generator) -> None:
    table(random, np.repeat([0.5, 1.5, 3.0], ROWS // 3), 10e-3).to_csv("my log.csv", index=False)
    assert run("diagnose", "my log.csv", "--base", "343", "--quiet", "--report", "log.html")[0] == 0
    text = Text(Path("log.html").read_text(encoding="utf-8")).seen
    assert "echocal diagnose 'my log.csv' --base 343 --quiet --report log.html" in text
    assert "echocal correct my log.csv" not in text


def test_it_names_the_model_that_was_written_and_the_whole_command(
    run: Run, random: np.random.Generator
) -> None:
    rows = table(random, np.repeat([0.5, 1.5, 3.0], ROWS // 3), 10e-3)
    rows.rename(columns={"reading_m": "Messwert"}).to_csv("log.csv", index=False)
    column = ("--column", "Messwert=reading_m", "--base", "343", "--quiet")
    assert run("log.csv", *column)[0] == 0
    assert run("diagnose", "log.csv", *column, "--save-model", "m.json", "--report", "log.html")[0] == 0
    for page, model, reads in (
        ("log-report.html", "log-model.json", "--options log-options.toml"),
        ("log.html", "m.json", "--column Messwert=reading_m"),
    ):
        text = Text(Path(page).read_text(encoding="utf-8")).seen
        assert f"The model is saved as {model}" in text
        assert "--save-model model.json" not in text
        assert f"echocal correct log.csv {reads} --model {model}" in text
    assert run("diagnose", "log.csv", *column, "--report", "log.html")[0] == 0
    assert "--save-model model.json" in Text(Path("log.html").read_text(encoding="utf-8")).seen


def test_lengths_in_the_five_lines_can_be_told_apart(named: echocal.Diagnosis) -> None:
    assert named.gain is not None
    gain = replace(named.gain, rms_after_m=5e-12, interval_95=(10.01e-3, 10.04e-3))
    said = brief(replace(named, gain=gain))
    assert "with the correction below 0.001 mm" in said.size
    assert "gains 10.01 mm to 10.04 mm" in said.sure


def test_a_probability_in_doubt_says_of_what_it_is(named: echocal.Diagnosis) -> None:
    doubted = replace(named.causes[0], doubt="its gain may be chance", kind="effect", in_model=True)
    alike = ("fixed_delay", "amplitude_walk")
    doubted = replace(doubted, indistinguishable_from=alike, probability_alone=0.9)
    said = brief(replace(named, verdict="ambiguous", causes=(doubted,))).sure
    assert f"by the fit alone: one of 3 causes such as {doubted.id}" in said
    assert f"in doubt: {doubted.id}" in said


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


@pytest.mark.slow
def test_it_is_dark_where_the_reader_wants_it_and_prints_light(
    named: echocal.Diagnosis, tmp_path: Path
) -> None:
    """The paper of the page, its ink, and the color of the points, by scheme and medium."""
    playwright = pytest.importorskip("playwright.sync_api")
    (tmp_path / "page.html").write_text(report_page(named), encoding="utf-8")
    seen = {}
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        page = browser.new_page()
        page.goto((tmp_path / "page.html").as_uri())
        for scheme, medium in (("light", "screen"), ("dark", "screen"), ("dark", "print")):
            page.emulate_media(color_scheme=scheme, media=medium)
            seen[scheme, medium] = page.evaluate(
                """() => { const style = name => getComputedStyle(document.querySelector(name));
                return [style("body").backgroundColor, style("body").color, style("path.before").stroke]; }"""
            )
        browser.close()
    light, dark = seen["light", "screen"], seen["dark", "screen"]
    assert light[0] == "rgb(255, 255, 255)"
    assert all(one != other for one, other in zip(light, dark, strict=True))
    assert seen["dark", "print"] == light


@pytest.mark.slow
def test_the_pointer_reads_values_and_zooms(named: echocal.Diagnosis, tmp_path: Path) -> None:
    """The text beside a point is its row and error; a frame, a button and a double click change the range."""
    playwright = pytest.importorskip("playwright.sync_api")
    text = report_page(named)
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    before = drawn_in(text, 0)[0]
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 800, "height": 1200})
        page.goto((tmp_path / "page.html").as_uri())
        figure = page.locator("figure", has=page.locator("svg.chart")).first
        figure.scroll_into_view_if_needed()
        box = figure.locator("svg.plot").first.bounding_box()
        assert box is not None
        place = page.evaluate(WHERE)
        page.mouse.move(*place)
        told = figure.locator("output").inner_text()
        assert told == f"base, row {before.rows[99]}, {before.y[99]:.5g} mm"
        ticks = figure.locator("text.tick")
        shown = [ticks.all_inner_texts()]
        page.mouse.move(box["x"] + 100, box["y"] + 20)
        page.mouse.down()
        page.mouse.move(box["x"] + 200, box["y"] + 90, steps=3)
        page.mouse.up()
        shown.append(ticks.all_inner_texts())
        figure.get_by_role("button", name="+").click()
        shown.append(ticks.all_inner_texts())
        figure.locator("svg.chart").dblclick(position={"x": 300, "y": 100})
        assert ticks.all_inner_texts() == shown[0]
        assert len(set(map(tuple, shown))) == 3
        browser.close()
