"""What the plots show first, and what they show as one."""

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from rich.console import Console

import echocal
from echocal.charts.errors import by_correlation, column_chart
from echocal.diagnose import Cause, NextMeasurement
from echocal.diagnose.results.grouped import grouped
from echocal.plots.diagnosis import (
    _summary,
    next_figure,
    plot_gain,
    plot_posterior,
    plot_unexplained,
    residuals_figure,
    save_diagnosis,
)
from echocal.plots.draw import draw_panel
from echocal.report import print_diagnosis


@pytest.fixture(scope="module")
def diagnosis() -> echocal.Diagnosis:
    temperature = 20.0 + 15.0 * np.sin(2.4 * np.arange(120.0))
    distance = np.tile([0.4, 1.0, 1.9], 40)
    reading = distance * 343.0 / (331.4 + 0.6 * temperature) + 1e-3 * np.sin(np.arange(120.0) ** 2)
    table = {"reading_m": reading, "temperature_C": temperature, "distance_m": distance}
    return echocal.diagnose(table)


def test_the_column_with_the_clearest_trend_comes_first(diagnosis: echocal.Diagnosis) -> None:
    assert diagnosis.verdict == "named"
    assert by_correlation(diagnosis)[0] == "temperature"
    assert set(by_correlation(diagnosis)) <= set(diagnosis.traces.against)


def test_what_cannot_be_told_apart_is_one_bar(diagnosis: echocal.Diagnosis) -> None:
    scale = Cause("clock_error", "effect", 0.9, (), ("oblique_target", "reference_scale"), "far rows")
    sets = (
        (("cycle_slip", "oblique_target"), 0.4),
        (("clock_error", "cycle_slip"), 0.3),
        (("cycle_slip", "reference_scale"), 0.2),
        (("cycle_slip",), 0.1),
    )
    joined = replace(diagnosis, causes=(scale,), refuted=(), posterior=sets)
    first, second = grouped(joined)
    assert first.classes == ("clock_error or 2 others", "cycle_slip")
    assert first.shares == (0.4, 0.3, 0.2)
    assert second.classes == ("cycle_slip",)
    assert first.probability + second.probability == pytest.approx(1.0)
    ax = Figure().add_subplot()
    plot_posterior(joined, ax)
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        "+ clock_error or 2 others",
        "cycle_slip",
    ]
    assert "in every set: cycle_slip" in ax.get_title(loc="left")
    assert "clock_error or 2 others: oblique_target, reference_scale" in ax.get_title(loc="left")
    assert ax.get_title(loc="left").startswith("named: ")
    said = printed(joined, 120)
    assert "clock_error or 2 others" in said
    assert "does a further cause act beside cycle_slip?" in said


def printed(diagnosis: echocal.Diagnosis, width: int) -> str:
    text = io.StringIO()
    print_diagnosis(diagnosis, Console(file=text, width=width))
    return text.getvalue()


@pytest.mark.parametrize("width", [40, 120])
def test_no_bar_is_cut_and_no_unit_lost(diagnosis: echocal.Diagnosis, width: int) -> None:
    said = printed(diagnosis, width)
    assert "RMS [mm]" in said
    assert "…" not in said.partition("error on")[2].partition("note")[0]


def test_the_gain_names_what_joins(diagnosis: echocal.Diagnosis) -> None:
    ax = Figure().add_subplot()
    plot_gain(diagnosis, ax)
    labels = [label.get_text() for label in ax.get_yticklabels()]
    assert labels[-4:] == ["base", "+ fixed_speed", "chosen by each fold", "all columns could reach"]


def test_side_measurements_are_told_where_no_row_helps(diagnosis: echocal.Diagnosis) -> None:
    (figure, nothing) = (
        next_figure(replace(diagnosis, next_measurements=plans))
        for plans in (
            (_side("turn the target"), _side("count a second")),
            (),
        )
    )
    words = [text.get_text() for ax in figure.axes for text in ax.texts]
    assert "turn the target" in words[0]
    assert "count a second" in words[0]
    assert [text.get_text() for ax in nothing.axes for text in ax.texts] == [
        "no further causes are to be separated"
    ]


def _side(what: str) -> NextMeasurement:
    return NextMeasurement({"side_measurement": what}, ("clock_error", "oblique_target"), None)


@pytest.mark.parametrize(
    "name",
    [
        r"$\frac{$ of $x_1$",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("long_name " * 40, "[bold]<b>|a_b|</b>")),
    ],
)
def test_columns_may_have_any_name(name: str, tmp_path: Path) -> None:
    wave = np.sin(np.arange(200.0) / 9.0)
    noise = 5e-4 * np.sin(np.arange(200.0) ** 2)
    table = {
        "reading_m": 2.0 + 4e-3 * wave + noise,
        "temperature_C": np.linspace(20.0, 21.0, 200),
        name: wave,
    }
    found = echocal.diagnose(table, base=343, reading_speed=343, reference_distance=2.0)
    assert found.unexplained is not None
    assert found.unexplained.against == name.strip()
    assert name.strip() in found.unexplained.description
    assert found.smooth is not None
    assert len(save_diagnosis(found, tmp_path)) == 5 + found.smooth.offered
    ax = Figure().add_subplot()
    plot_unexplained(found, ax)
    assert max(map(len, ax.get_xlabel().splitlines())) <= 80
    assert len(ax.get_xlabel().splitlines()) <= 3
    assert " ".join(name.split()) in " ".join(printed(found, 2000).split())


def test_no_title_is_wider_than_its_figure(diagnosis: echocal.Diagnosis) -> None:
    ids = (
        "clock_temperature_coefficient",
        "reading_quantization",
        "temperature_self_heating",
        "noise_growth",
    )
    causes = tuple(Cause(id_, "noise", 0.99, (), (), "rows") for id_ in ids)
    gain = diagnosis.gain
    assert gain is not None
    gain = replace(gain, scheme="rows from 2022-07-20 12:00 on; causes are selected and fitted without them")
    long = replace(diagnosis, causes=causes, refuted=(), posterior=((ids, 0.9), ((), 0.1)), gain=gain)
    for plot, size in ((plot_posterior, (8.0, 3.2)), (plot_gain, (6.0, 2.8))):
        figure = Figure(figsize=size, layout="constrained")
        ax = figure.add_subplot()
        plot(long, ax)
        figure.draw_without_rendering()
        title = ax._left_title  # type: ignore[attr-defined]
        assert title.get_window_extent().x1 <= figure.bbox.x1


def test_class_and_member_are_told_with_their_questions(diagnosis: echocal.Diagnosis) -> None:
    scale = Cause("clock_error", "effect", 0.9, (), ("oblique_target", "reference_scale"), "far rows")
    told = replace(diagnosis, causes=(replace(scale, probability_alone=0.3),))
    question = "does one of 3 causes act that these data cannot separate? 0.90; clock_error itself? 0.30"
    ax = Figure().add_subplot()
    plot_posterior(told, ax)
    assert question in " ".join(ax.get_title(loc="left").split())
    assert ax.get_xlabel() == "probability that exactly these causes act"
    assert question in " ".join(_summary(told).split())
    plot_gain(told, ax := Figure().add_subplot())
    gain = told.gain
    assert f"removes {100 * gain.variance_removed:.0f} % of the mean square error" in " ".join(
        ax.get_title(loc="left").split()
    )


def logged(random: np.random.Generator, noise: float) -> dict[str, object]:
    """A log of four days, of a sensor with one fixed speed, with two copies of its thermometer."""
    celsius = 15.0 + 8.0 * np.sin(np.arange(600.0) / 23.0) + random.normal(0.0, 0.3, 600)
    distance = np.tile([0.4, 1.0, 1.9], 200)
    reading = distance * 343.0 / (331.4 + 0.6 * celsius) + random.normal(0.0, noise, 600)
    reading[[50, 300]] = np.nan
    return {
        "time_s": 600.0 * np.arange(600.0),
        "reading_m": reading,
        "temperature_C": celsius,
        "temperature_box_K": celsius + 273.15,
        "distance_m": distance,
    }


def test_before_and_after_are_readable_and_the_axis_says_the_sign(random: np.random.Generator) -> None:
    figure = residuals_figure(echocal.diagnose(logged(random, 2e-4), base="343"))
    axes = [ax for ax in figure.axes if ax.has_data()]
    before, after = (
        [ax for ax in axes if ax.get_title(loc="left").startswith(word)] for word in ("before", "after")
    )
    assert len(before) == len(after) >= 2
    assert {" ".join(ax.get_ylabel().split()) for ax in axes} == {"reading minus reference [mm]"}
    assert all("above 0, it reads too far" in ax.get_title(loc="left") for ax in before)
    for ax in after:  # errors of 0.2 mm beside some of 20 mm
        (points, *_) = ax.lines
        low, high = ax.get_ylim()
        assert np.ptp(np.asarray(points.get_ydata())) > 0.4 * (high - low)
        assert "scale of its own" in ax.get_title(loc="left")


def test_the_words_above_a_single_column_fit(diagnosis: echocal.Diagnosis) -> None:
    traces = diagnosis.traces
    one = {"temperature": traces.against["temperature"]}
    figure = residuals_figure(replace(diagnosis, traces=replace(traces, against=one)))
    figure.draw_without_rendering()
    box = figure._suptitle.get_window_extent()  # type: ignore[attr-defined]
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1


def test_a_panel_shows_time_and_none_repeats_another(random: np.random.Generator) -> None:
    figure = residuals_figure(echocal.diagnose(logged(random, 2e-4), base="343"))
    labels = [ax.get_xlabel() for ax in figure.axes if ax.get_title(loc="left").startswith("after")]
    assert sum(label.startswith("time [") for label in labels) == 1
    assert len(labels) == len(set(labels))
    assert sum("temperature" in label for label in labels) == 1  # its copy in kelvin shows nothing new
    (ax, *_) = (ax for ax in figure.axes if ax.get_xlabel().startswith("time ["))
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["2 left out"]


def test_a_worse_model_looks_worse(diagnosis: echocal.Diagnosis) -> None:
    traces = diagnosis.traces
    worse = replace(diagnosis, traces=replace(traces, before=traces.after, after=traces.before))
    limits = []
    chart = column_chart(worse, "temperature")
    for panel in chart.panels:
        draw_panel(panel, chart.x, ax := Figure().add_subplot())
        limits.append(ax.get_ylim())
    assert limits[0] == limits[1]
    assert "same scale" in ax.get_title(loc="left")


def test_the_bar_of_the_reported_cause_is_there_and_dark(diagnosis: echocal.Diagnosis) -> None:
    others = tuple(((f"column_{place}",), 0.13) for place in range(7))
    cause = Cause("zero_error", "effect", 0.09, (), (), "all rows")
    one = replace(diagnosis, causes=(cause,), refuted=(), posterior=(*others, (("zero_error",), 0.09)))
    plot_posterior(one, ax := Figure().add_subplot())
    labels = [label.get_text() for label in ax.get_yticklabels()]
    assert labels[-1] == "zero_error"
    colors = [bar.get_facecolor() for bar in ax.patches]  # type: ignore[attr-defined]
    assert colors[-1] not in colors[:-1]
    assert "in color: sets with a cause that the verdict reports" in ax.get_title(loc="left")


@pytest.mark.parametrize(("form", "start"), [("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_plots_in_other_formats(
    form: str, start: bytes, random: np.random.Generator, run: Callable[..., tuple[int, str]]
) -> None:
    pd.DataFrame(logged(random, 1e-3)).to_csv("log.csv", index=False)
    words = ("diagnose", "log.csv", "--base", "343", "--quiet", "--plots", "plots", "--plot-format")
    assert run(*words, form)[0] == 0
    files = sorted(Path("plots").iterdir())
    assert {file.suffix for file in files} == {f".{form}"}
    assert {"residuals", "gain", "posterior", "next"} <= {file.stem for file in files}
    assert all(file.read_bytes().startswith(start) for file in files)
    assert run(*words, form)[0] == 0  # again, over its own pictures
    code, said = run(*words, "bmp")
    assert (code, "png, svg, pdf" in said) == (2, True)
