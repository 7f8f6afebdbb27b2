"""The certificate: what it says, what it decides, and that it prints on two pages."""

import re
from collections.abc import Callable
from pathlib import Path

import browsed
import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.model import ResidualUncertainty
from echocal.report.html.certificate import certificate_page, certify, sha256_of

Seeded = Callable[..., np.random.Generator]
STATED = ("--uncertainty", "thermometer=DHT22", "--uncertainty", "tape=II")
DISTANCES = (0.3, 0.5, 0.8, 1.2, 1.6, 2.0, 2.5, 3.0)


@pytest.fixture(scope="module")
def bench(request: pytest.FixtureRequest, seeded: Seeded, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a fitted model, and new tables of its device with and without references."""
    random, folder = seeded(request), tmp_path_factory.mktemp("bench")
    distance = np.repeat(DISTANCES, 20)
    celsius = np.tile(np.linspace(15.0, 28.0, 20), len(DISTANCES))

    def table() -> pd.DataFrame:
        echo = (
            2 * distance / echocal.speed_of_sound(celsius, 0.45)
            + 85e-6
            + random.normal(0, 2e-6, len(distance))
        )
        columns = {"echo_us": 1e6 * echo, "temperature_C": celsius, "humidity_percent": 45.0}
        return pd.DataFrame({"time": pd.date_range("2026-03-01", periods=160, freq="min"), **columns})

    fitted = echocal.calibrate(
        table().assign(distance_m=distance), echocal.Model("cramer"), fit=["fixed_delay"]
    )
    fitted.model.save(folder / "model.json")
    table().assign(distance_m=distance).to_csv(folder / "new.csv", index=False)
    table().iloc[::14].to_csv(folder / "bare.csv", index=False)
    return folder


def run(folder: Path, *words: str) -> str:
    done = CliRunner().invoke(app, ["certificate", str(folder / "model.json"), *words])
    assert done.exit_code in (0, 1, 5), done.output  # what is decided
    return done.output


def test_it_says_what_it_is_about(bench: Path) -> None:
    out = bench / "certificate.html"
    run(
        bench,
        str(bench / "new.csv"),
        "-o",
        str(out),
        *STATED,
        "--device",
        "HC-SR04 <17>",
        "--issued-by",
        "me",
    )
    page = out.read_text()
    text = browsed.Text(page).seen
    model = echocal.Model.load(bench / "model.json")
    for told in (
        "HC-SR04 <17>", model.hash, sha256_of(bench / "new.csv"), "15 to 28 degC", "2026-03-01 00:00",
        "160 of 160", "fixed_delay.delay", "thermometer DHT22, limits of error", "tape of class II",
        "Aosong", "JCGM 106:2012", "Monte Carlo", "name and signature",
    ):  # fmt: skip
        assert told in text, told
    assert not [url for url in browsed.Text(page).fetched if not url.startswith("data:")]
    assert len(page) < 50_000
    run(bench, str(bench / "new.csv"), "-o", str(out), *STATED)  # its own file may be replaced


@pytest.mark.parametrize("name", ["new.csv", "bare.csv"])
def test_it_prints_on_two_pages(bench: Path, name: str) -> None:
    pypdf = pytest.importorskip("pypdf")
    pytest.importorskip("weasyprint")
    out = bench / f"{name}.pdf"
    for _ in range(2):  # its own file may be replaced
        run(bench, str(bench / name), "-o", str(out), *STATED)
    pages = [page.extract_text() for page in pypdf.PdfReader(out).pages]
    assert len(pages) == 2
    assert "Conformity" in pages[0]
    assert "Uncertainty budget" in pages[1]
    assert "signature" in pages[1]


def test_the_longest_one_prints_on_two_pages(tmp_path: Path) -> None:
    """Seven parameters, fourteen stated sources, six columns and twelve rows."""
    pypdf = pytest.importorskip("pypdf")
    pytest.importorskip("weasyprint")
    own = "fixed_delay zero_error clock_error temperature_offset dispersion supply_voltage"
    effects: dict[str, dict[str, float]] = {id_: {} for id_ in own.split()}
    names = echocal.Model("cramer", effects).parameter_names
    residual = ResidualUncertainty(3e-4, 4e-4, 480, 0.5, 2.5, "blocked by time, 5 folds")
    model = echocal.Model(
        "cramer", effects, covariance=1e-14 * np.eye(len(names)), residual_uncertainty=residual
    )
    model.save(tmp_path / "model.json")
    column = np.linspace(0.0, 1.0, 12)
    table = {
        "time": pd.date_range("2026-03-01", periods=12, freq="h"),
        "reading_mm": 300.0 + 3700.123 * column,
        "temperature_C": 5.0 + 30.0 * column,
        "humidity_percent": 20.0 + 60.0 * column,
        "pressure_hPa": 980.0 + 40.0 * column,
        "co2_ppm": 400.0 + 500.0 * column,
        "supply_V": 4.9,
        "distance_m": 0.3 + 3.7 * column,
    }
    pd.DataFrame(table).to_csv(tmp_path / "new.csv", index=False)
    known = "thermometer=DHT22 hygrometer=DHT22 barometer=BME280 tape=III timer_us=4 resolution_mm=10"
    known += " law=published echo_us=2 co2_ppm=50 supply_V=0.05"
    words = [word for one in known.split() for word in ("--uncertainty", one)]
    out = tmp_path / "out.pdf"
    run(
        tmp_path,
        str(tmp_path / "new.csv"),
        "-o",
        str(out),
        *words,
        "--reading-speed",
        "343",
        "--device",
        40 * "x ",
    )
    pages = [page.extract_text() for page in pypdf.PdfReader(out).pages]
    assert len(pages) == 2
    assert "signature" in pages[1]


def test_a_browser_shows_it(bench: Path, tmp_path: Path) -> None:
    out = tmp_path / "certificate.html"
    run(bench, str(bench / "new.csv"), "-o", str(out), *STATED)
    told = browsed.browsed(out.read_text(), tmp_path)
    assert (told["said"], told["wide"], told["asked"]) == ([], False, [])


def test_results_are_those_of_the_budget(bench: Path) -> None:
    model, table = echocal.Model.load(bench / "model.json"), echocal.read_observations(bench / "bare.csv")
    stated = {"thermometer": "DHT22", "tape": "II"}
    own = certify(model, table, maximum_permissible_error=3e-3, uncertainties=stated)
    found = echocal.budget(model, table, uncertainties=stated, trials=0)
    page = certificate_page(own, {})
    shown = re.findall(r"<td>([\d.]+) ± ([\d.]+)</td>", page)
    assert len(shown) == len(found.distance) == 12
    for (distance, expanded), d, big in zip(shown, found.distance, found.expanded_uncertainty, strict=True):
        assert float(distance) == pytest.approx(1e3 * d, abs=0.06 * 1e3 * big)
        assert 0.99 * 1e3 * big <= float(expanded) <= 1.1 * 1e3 * big
        assert len(expanded.replace(".", "").lstrip("0")) == 2


def test_what_it_decides(bench: Path) -> None:
    model = echocal.Model.load(bench / "model.json")
    new, bare = (echocal.read_observations(bench / name) for name in ("new.csv", "bare.csv"))
    stated = {"tape": "II"}
    for table, bound, decision in (
        (new, 5e-3, "conforms"), (new, 1.6e-3, "undecided"), (new, 1e-5, "does not conform"),
        (bare, 5e-3, "conforms"), (bare, 1e-4, "undecided"),
    ):  # fmt: skip
        found = certify(model, table, maximum_permissible_error=bound, uncertainties=stated)
        if decision == "undecided" and table is new:
            assert found.decision != "conforms" or found.conformity.expanded_uncertainty.max() < bound
            continue
        assert found.decision == decision, bound
    # the same guard band and the same decision as those of a verification
    own = certify(model, new, maximum_permissible_error=2e-3, uncertainties=stated)
    same = echocal.verify(new, model=model, maximum_permissible_error=2e-3, uncertainties=stated)
    assert same.guard_band == pytest.approx(own.conformity.expanded_uncertainty.max())
    assert same.undecided == (own.conformity.decision == 1).sum()
    assert same.passed == (own.decision == "conforms")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "c.txt"], "a certificate is .html or .pdf"),
        (["-o", "c.html", "--mpe-mm", "0"], "--mpe-mm 0"),
        (["-o", "c.html", "--uncertainty", "tape=V"], "no such tape"),
    ],
)
def test_mistakes_are_told(
    bench: Path, words: list[str], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(bench)
    done = CliRunner().invoke(app, ["certificate", "model.json", "new.csv", *words])
    assert message in str(done.exception)


def test_a_missing_library_is_told(bench: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "weasyprint", None)
    done = CliRunner().invoke(
        app, ["certificate", str(bench / "model.json"), str(bench / "new.csv"), "-o", "c.pdf"]
    )
    assert "pip install 'echocal[pdf]'" in str(done.exception)


def test_the_join_of_a_reference_is_a_line_of_the_budget_of_the_errors() -> None:
    seconds = np.arange(0.0, 6000.0, 60.0)
    distance = 1.5 + 0.3 * np.sin(seconds / 900.0)
    table = {"reading_m": distance, "time_s": seconds, "temperature_C": np.full(100, 20.0)}
    gauge = {"distance_m": 1.5 + 0.3 * np.sin(seconds[::5] / 900.0), "time_s": seconds[::5]}
    read = echocal.read_observations(pd.DataFrame(table), reference=pd.DataFrame(gauge))
    assert read.reference_join_uncertainty
    model = echocal.Model("linear", residual_uncertainty=ResidualUncertainty(1e-3))
    found = certify(model, read, maximum_permissible_error=5e-3, uncertainties={"tape": "II"})
    page = certificate_page(found, {})
    assert "reference distance, joined by time" in page
    assert "tape of class II" in page
    lines = [entry.words for entry in found.of_errors.entries]
    assert lines == ["tape of class II", "reference distance, joined by time"]
    assert found.of_errors.rows(found.rows).standard_uncertainty == pytest.approx(
        found.conformity.standard_uncertainty
    )
