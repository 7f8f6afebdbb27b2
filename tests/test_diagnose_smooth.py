"""The smooth correction of a diagnosis: its gain is that of fresh rows, and noise earns none."""

import importlib
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from method_page import precision
from scipy.interpolate import BSpline
from scipy.signal import lfilter
from scipy.stats import f as variance_ratio

import echocal
from echocal.diagnose.inference.smoothing import least
from echocal.diagnose.validation.remainder import explained

Table = dict[str, Any]


def noise(random: np.random.Generator, rows: int, rho: float) -> np.ndarray:
    """Autoregressive noise of 1 mm."""
    steps = random.normal(0.0, 1e-3 * np.sqrt(1 - rho**2), rows + 300)
    return np.asarray(lfilter([1.0], [1.0, -rho], steps)[300:])


def logged(random: np.random.Generator, rows: int = 500, rho: float = 0.0, day: str = "2024-05-01") -> Table:
    """Five days before a wall at 1.5 m, without an effect."""
    seconds = 432e3 / rows * np.arange(rows)
    celsius = 15.0 + 8.0 * np.sin(2 * np.pi * seconds / 86400) + 3e3 * noise(random, rows, 0.98)
    light = np.maximum(0.0, np.sin(2 * np.pi * seconds / 86400)) * random.uniform(0.3, 1.0, rows)
    return {
        "time": (np.datetime64(f"{day}T00:00") + seconds.astype("timedelta64[s]")).astype(str),
        "reading_m": 1.5 + noise(random, rows, rho),
        "distance_m": np.full(rows, 1.5),
        "temperature_C": celsius,
        "light": 500.0 * light,
    }


def planted(random: np.random.Generator, rows: int = 500, rho: float = 0.0, day: str = "2024-05-01") -> Table:
    """The same with an error that no effect of the catalogue has, against two columns."""
    table = logged(random, rows, rho, day)
    bump = np.exp(-(((table["temperature_C"] - 12.0) / 3.0) ** 2))
    table["reading_m"] += 8e-3 * bump - 5e-3 * np.sqrt(table["light"] / 500.0)
    return table


def rms(model: echocal.Model, table: Table, inside: echocal.Model | None = None) -> float:
    """Error of all rows, or of those for which another model's smooth correction holds [m]."""
    from echocal.observations.correction import corrected_distance, outside_smooth

    observations = echocal.read_observations(table)
    error = corrected_distance(observations, model) - table["distance_m"]
    if inside is not None:
        error = error[outside_smooth(observations, inside) == ""]
    return float(np.sqrt(np.mean(error**2)))


@pytest.mark.slow
def test_on_a_roof_what_does_not_recur_is_not_offered(shared: Path) -> None:
    """By hand: 7 % of July beyond humidity; the sun of June has the other sign in July."""
    from test_diagnose_roof import COLUMNS

    data = shared / "data" / "roof-sr50" / "roof_fixed_target_tidy.csv"
    options = {"columns": COLUMNS, "constant_distance": True, "reading_speed": "331.4"}
    with pytest.warns(echocal.DataWarning):
        july = echocal.diagnose(data, since="2022-07-05", until="2022-08-03", **options).smooth
    with pytest.warns(echocal.DataWarning):
        june = echocal.diagnose(data, since="2022-06-09", until="2022-06-24", **options).smooth
    assert 0.0 < july.variance_removed < 0.3
    assert not june.offered


@pytest.mark.statistical
@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_the_gain_is_that_of_fresh_rows(rho: float, random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(planted(random, rho=rho))
    found = diagnosis.smooth
    assert diagnosis.verdict == "unknown"
    assert found is not None
    assert found.offered
    assert {"temperature", "light"} <= set(found.smooth.columns)
    fresh = planted(random, rows=2000, rho=rho, day="2024-06-10")
    model = diagnosis.model_with_smooth
    assert rms(model, fresh) < rms(diagnosis.model, fresh)
    assert rms(model, fresh, model) < 0.6 * rms(diagnosis.model, fresh, model)
    assert rms(model, fresh, model) == pytest.approx(found.rms_after_m, rel=0.35)
    assert found.rms_before_m == pytest.approx(diagnosis.gain.rms_after_m)
    low, high = found.interval_95
    assert 0.0 < low < found.rms_before_m - found.rms_after_m < high
    assert "without a known cause" in diagnosis.explain()
    assert diagnosis.to_dict()["smooth"]["offered"]


@pytest.mark.statistical
def test_it_follows_the_hour_of_the_day_on_other_days(random: np.random.Generator) -> None:
    def daily(day: str) -> Table:
        table = logged(random, day=day)
        table["temperature_C"] = random.uniform(10.0, 20.0, 500)
        del table["light"]
        hour = np.arange(500) * 0.24 % 24
        table["reading_m"] += 6e-3 * np.exp(-(((hour - 14.0) / 2.0) ** 2))
        return table

    diagnosis = echocal.diagnose(daily("2024-05-01"))
    assert diagnosis.smooth.smooth.columns[0] == "hour_angle"
    later = daily("2024-07-09")
    assert rms(diagnosis.model_with_smooth, later) < 0.75 * rms(diagnosis.model, later)


def test_columns_that_later_rows_do_not_share_take_no_part(random: np.random.Generator) -> None:
    table = logged(random)
    table["reading_m"] += 5e-3 * np.sin(np.arange(500) / 80.0)
    diagnosis = echocal.diagnose(table)
    assert diagnosis.smooth is not None
    assert not {"time", "row", "elapsed_time"} & set(diagnosis.smooth.tried)


@pytest.mark.parametrize("known", [True, False])
def test_nothing_sees_the_rows_that_a_user_holds_out(known: bool, random: np.random.Generator) -> None:
    table = planted(random)
    if not known:
        del table["distance_m"]
    corrupted = {name: column.copy() for name, column in table.items()}
    corrupted["reading_m"][400:] += random.normal(0.0, 0.02, 100)
    corrupted["light"][400:] = random.uniform(0.0, 9e3, 100)
    first, second = (
        echocal.diagnose(one, constant_distance=not known, hold_out_after="2024-05-05").smooth
        for one in (table, corrupted)
    )
    whose = first.smooth.residual_uncertainty  # which they alone are to tell
    assert first.smooth == replace(second.smooth, residual_uncertainty=whose)
    assert whose != second.smooth.residual_uncertainty
    assert first.held_out_rows == 100
    assert first.rms_after_m < 0.7 * first.rms_before_m
    assert second.rms_before_m > 2 * first.rms_before_m  # they do judge


@pytest.mark.statistical
@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.0, 0.6, 0.95])
def test_noise_earns_no_correction(rho: float, random: np.random.Generator) -> None:
    """In 1,300 such tables of four designs one was offered."""
    offered, far = 0, 0
    for i in range(40):
        known = i % 2 == 0
        table = logged(random, 300, rho)
        if not known:
            del table["distance_m"]
        diagnosis = echocal.diagnose(table, constant_distance=not known)
        offered += diagnosis.smooth is not None and diagnosis.smooth.offered
        far += diagnosis.remainder is not None and not diagnosis.remainder.by_chance
    assert offered <= 1
    assert far <= 1


def many(random: np.random.Generator, share: float) -> Table:
    """Twelve columns of six values; together they have this part of the variance, each a twelfth of it."""
    columns = random.permuted(np.tile(np.arange(6.0), (12, 40)), axis=1)
    signal = random.choice([-1.0, 1.0], 12) @ (columns - 2.5) / np.sqrt(12 * 35 / 12)
    reading = 1.5 + 3e-3 * (np.sqrt(share) * signal + np.sqrt(1 - share) * random.normal(size=240))
    own = {f"column {i}": column for i, column in enumerate(columns)}
    celsius = random.uniform(18.0, 22.0, 240)
    return {"reading_m": reading, "distance_m": np.full(240, 1.5), "temperature_C": celsius, **own}


NO_TERMS = {"priors": {"unexplained_term": 1e-30}}


@pytest.mark.statistical
def test_an_error_far_above_the_floor_is_not_nothing(
    random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing that is tried alone is probable, but the columns together leave a quarter of the error."""
    monkeypatch.setattr(sys.modules[least.__module__], "_GAIN", 1e9)
    diagnosis = echocal.diagnose(many(random, 0.93), settings=NO_TERMS)
    assert diagnosis.verdict == "unknown"
    assert diagnosis.unexplained is None
    assert diagnosis.remainder.p_value < 1e-12
    assert not diagnosis.remainder.by_chance
    said = diagnosis.explain()
    assert said.startswith("The data show an effect, but no cause and no smooth function of one column")
    assert f"RMS error of the model is {1e3 * diagnosis.gain.rms_after_m:.2f} mm" in said
    assert "column 11" in said.partition("Tried: ")[2]
    assert diagnosis.to_dict()["remainder"]["against"]


@pytest.mark.statistical
def test_noise_that_the_columns_follow_is_told_beside_nothing(random: np.random.Generator) -> None:
    """Autocorrelated noise in a short log: the columns can follow most of it, and that is no evidence."""
    told = 0
    for _ in range(4):
        diagnosis = echocal.diagnose(logged(random, 300, 0.95))
        left = diagnosis.remainder
        if diagnosis.verdict == "nothing" and left is not None:
            assert left.by_chance
            assert left.p_value > 1e-5
            assert 0.0 < left.no_effect <= 1.0
            assert "So this is no evidence of an effect" in diagnosis.explain()
            told += 1
    assert told >= 1


@pytest.mark.statistical
def test_where_the_columns_explain_little_it_is_nothing(random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(many(random, 0.0), settings=NO_TERMS)
    assert diagnosis.remainder is None
    assert diagnosis.verdict == "nothing" or diagnosis.causes


def test_the_remainder_is_an_f_test(random: np.random.Generator) -> None:
    """With a wide prior it is the F test of ordinary least squares; docs/method/checks.md, Eq. 34."""
    columns = random.normal(size=(8, 60))
    columns[0] = 1.0
    columns[-1] += 0.4 * columns[3]
    p_value, degrees = explained(columns @ columns.T, 60, 1e6)
    design, y = columns[1:-1].T, columns[-1]
    left = y - design @ np.linalg.lstsq(design, y)[0]
    ratio = (y @ y - left @ left) / 6 / (left @ left / 54)
    assert degrees == pytest.approx((6.0, 54.0))
    assert p_value == pytest.approx(variance_ratio.sf(ratio, 6, 54), rel=1e-6)


def whitening(model: Any, starts: np.ndarray) -> np.ndarray:
    """W of Eq. 3: a line for each row, which a block of rows has a part of."""
    rows, rho, theta = len(starts), model.rho, model.moving_average
    z, white = np.eye(rows), np.zeros((rows, rows))
    for i in range(rows):
        if starts[i]:
            white[i] = np.sqrt((1 - rho**2) / (1 - 2 * rho * theta + theta**2)) * z[i]
            continue
        z[i] += theta * z[i - 1]
        white[i] = z[i] - rho * z[i - 1]
    return white


def test_the_curve_is_that_of_the_page(random: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    """docs/method/checks.md, Eq. 32 and 33, with whole matrices, under the noise of the engine."""
    stage = importlib.import_module("echocal.diagnose.validation.smooth")
    seen: list[Any] = []
    original = stage.Smoother.of
    monkeypatch.setattr(
        stage.Smoother,
        "of",
        lambda case, *given: seen.append((case, *given, original(case, *given))) or seen[-1][-1],
    )
    table = planted(random, 150, 0.6)
    table["time_s"] = 2880.0 * np.arange(150)  # no clock of the day
    del table["time"]
    diagnosis = echocal.diagnose(table)
    case, splines, residuals, model, smoother = seen[0]
    weights = smoother.chosen(case.folds.fit, case.folds.held, smoother.places[-1].stop)
    assert weights
    fitted = smoother.fitted(case.folds.fit, weights, smoother.places[-1].stop)
    white = whitening(model, case.sums.order.starts)
    inverse, _ = precision(model, case.sums.order.starts, case.sums.order.groups)
    np.testing.assert_allclose(white.T @ white, inverse, atol=1e-9)
    designs = [np.ones((150, 1))]
    penalties = [np.zeros((1, 1))]
    for place, weight in weights.items():
        spline = splines[place]
        own = {"light": case.table.extra.get("light"), **case.table.conditions}[spline.against]
        step = (spline.high - spline.low) / spline.pieces
        knots = spline.low + step * np.arange(-3, spline.pieces + 4)
        inside = np.clip(own, knots[3], knots[-4])
        basis = BSpline(knots, np.eye(spline.pieces + 3), 3)(inside)
        designs.append(basis - basis.mean(axis=0))
        second = np.diff(np.eye(basis.shape[1]), 2, axis=0)
        penalties.append(weight * second.T @ second)
    z = np.hstack(designs)
    penalty = np.zeros((z.shape[1], z.shape[1]))
    first = 0
    for one in penalties:
        penalty[first : first + len(one), first : first + len(one)] = one
        first += len(one)

    def whitened(rows: np.ndarray) -> np.ndarray:
        """Of rows that follow none of them, each begins a series."""
        begins = case.sums.order.starts | (rows & ~np.append(False, rows[:-1]))
        return whitening(model, begins)[rows]

    def curve(rows: np.ndarray) -> np.ndarray:
        among, own = whitened(rows) @ z, whitened(rows) @ residuals[0]
        return z @ np.linalg.lstsq(among.T @ among + penalty, among.T @ own, rcond=1e-9)[0]

    expected = curve(np.ones(150, dtype=bool))
    found = fitted.offset + sum(
        (smoother.splines[place].at(values(case, smoother.splines[place])) - smoother.means[place]) @ mean
        for place, mean, _ in fitted.splines
    )
    np.testing.assert_allclose(found, expected, atol=2e-6)
    assert diagnosis.smooth is not None

    if model.moving_average:  # the whole agrees, above; the beginning of a part left out is approximate
        return
    expected_gains = []
    for out in case.folds.held:
        rows = out[case.folds.blocks]
        before, after = (whitened(rows) @ left for left in (residuals[0], residuals[0] - curve(~rows)))
        expected_gains.append(rows.sum() / 2 * np.log(before @ before / (after @ after)))
    *others, last = weights
    gains, squares = smoother._gains(
        case.folds.fit,
        case.folds.held,
        {place: weights[place] for place in others},
        last,
        smoother.places[-1].stop,
    )
    which = int(np.argmin(np.abs(smoother._weights(case.folds.fit, last) - weights[last])))
    assert gains[:, which] == pytest.approx(expected_gains, rel=1e-3, abs=1e-3)
    errors = [
        residuals[0][rows] - curve(~rows)[rows]
        for rows in (out[case.folds.blocks] for out in case.folds.held)
    ]
    assert squares[which] == pytest.approx(float(sum(one @ one for one in errors)), rel=1e-3)


def test_one_part_alone_does_not_choose_a_column(random: np.random.Generator) -> None:
    """What a column adds must be more than its scatter over the parts left out: one standard error."""
    alike, one = 4.0 + random.uniform(0.0, 0.1, 5), np.array([20.0, 0.0, 0.0, 0.0, 0.0])
    assert alike.sum() > least(alike)
    assert one.sum() < least(one)


def test_columns_may_be_odd(random: np.random.Generator) -> None:
    """One that varies in the last block alone, one of few values, one far from zero, one with a wild row."""
    table = planted(random, 200)
    table["late"] = np.where(np.arange(200) < 160, 0.0, random.normal(size=200))
    table["few"] = random.integers(0, 7, 200).astype(float)
    table["far"] = 1e9 + random.normal(size=200)
    table["wild"] = np.where(np.arange(200) == 9, 1e12, random.normal(size=200))
    table["reading_m"] += 4e-3 * np.tanh(table["late"]) + 3e-3 * np.sin(table["wild"])
    found = echocal.diagnose(table).smooth
    assert found is not None
    assert found.held_out_rows > 150
    assert np.isfinite([found.rms_before_m, found.rms_after_m]).all()


@pytest.mark.parametrize("rows", [8, 12, 26])
def test_few_rows_are_no_error(rows: int, random: np.random.Generator) -> None:
    celsius = random.uniform(0.0, 40.0, rows)
    reading = 1.0 + 5e-3 * np.tanh(celsius - 20.0)
    table = {"reading_m": reading, "temperature_C": celsius, "distance_m": np.ones(rows)}
    diagnosis = echocal.diagnose(table)
    assert diagnosis.to_dict()["schema"]
    assert diagnosis.explain()


def values(case: Any, spline: Any) -> np.ndarray:
    from echocal.diagnose.inference.smoothing import values_of

    return values_of(case.table, spline.against)


def test_the_command_writes_it(
    random: np.random.Generator, tmp_path: Path, run: Callable[..., tuple[int, str]]
) -> None:
    data, null, model = tmp_path / "data.csv", tmp_path / "null.csv", tmp_path / "model.json"
    pd.DataFrame(planted(random)).to_csv(data, index=False)
    pd.DataFrame(logged(random)).to_csv(null, index=False)
    assert run("diagnose", str(data), "--save-model", str(model), "--with-smooth", "-q") == (0, "")
    assert set(echocal.Model.load(model).shape.columns) & {"temperature", "light"}
    code, said = run("diagnose", str(null), "--save-model", "other.json", "--with-smooth", "-q")
    assert code == 2
    assert "offers no smooth correction" in said
    assert run("diagnose", str(data), "--with-smooth")[0] == 2
    assert run("diagnose", str(data), "--with-smooth", "--with-shape", "--save-model", "other.json")[0] == 2
    out = tmp_path / "corrected.csv"
    assert run("correct", str(data), "-o", str(out), "--model", str(model), "-q")[0] == 0
    marked = pd.read_csv(out)["unusable"].dropna()
    assert 0 < len(marked) < 30
    assert marked.str.endswith("outside of the smooth correction").all()
