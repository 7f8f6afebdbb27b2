"""Few rows and slow noise: an effect must be probable under each single autoregression."""

from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

import echocal
from echocal.diagnose.inference.posterior import infer
from echocal.diagnose.pipeline import Examined, examined
from echocal.diagnose.preprocess.reading import read
from echocal.diagnose.progress import Steps
from echocal.diagnose.request import Request
from echocal.diagnose.selection.claims import rank
from echocal.diagnose.selection.slow_noise import least_favorable
from echocal.diagnose.settings import NoiseModelSettings

ROWS, SHOT = 26, 1.5e-3
RHOS = [rho for rho in dict(NoiseModelSettings().autoregressions)[0.0] if rho]
NOTE = "noise that follows the rows before"

Table = dict[str, np.ndarray]


def table(errors: np.ndarray) -> Table:
    """One distance, the temperature swept once."""
    warm = np.linspace(0.0, 50.0, len(errors))
    return {"reading_m": 2.0 + errors, "temperature_C": warm, "distance_m": np.full(len(errors), 2.0)}


def slow(rho: float, rows: int, random: np.random.Generator) -> np.ndarray:
    """Stationary autoregression [m]."""
    shocks = random.normal(size=rows)
    shocks[1:] *= np.sqrt(1 - rho**2)
    return SHOT * np.asarray(lfilter([1.0], [1.0, -rho], shocks))


def inferred(given: Table, rhos: list[float] | None = None) -> Examined:
    """The diagnosis with its inference, under all noises or under a few autoregressions."""
    settings: Any = None
    if rhos is not None:
        settings = {"noise_models": {"autoregressions": [[0.0, [0.0, *rhos]]]}}
    request = Request.of("linear", 0, settings)
    reading = read(given, {"reading_speed": request.base.reading_speed})
    return examined(reading, request, Steps(None))


def test_the_bound_is_the_posterior_under_the_least_favorable_autoregression(
    random: np.random.Generator,
) -> None:
    given = table(slow(0.5, ROWS, random) + SHOT * np.linspace(-1, 1, ROWS))
    case = inferred(given).case
    whole = infer(case)
    found = least_favorable(case, rank(whole.fits, case.found.competing, case.settings), whole.reduced)
    assert found is not None
    none, nothing, total = [], [], []
    for rho in RHOS:
        fits = infer(inferred(given, [rho]).case).fits
        log = np.array([fit.log_posterior for fit in fits])
        share = np.exp(log - log.max()) / np.exp(log - log.max()).sum()
        total.append(np.logaddexp.reduce(log))
        of = [fit.hypothesis for fit in fits]
        none.append(share[[not one.effects for one in of]].sum())
        nothing.append(share[[not one.variants for one in of]].sum())
    limit = max(total) - case.settings.claims.strong
    expected = [  # an autoregression may be on the very limit
        (np.array(none)[counts].max(), np.array(nothing)[counts].max())
        for counts in (np.array(total) > limit + 0.05, np.array(total) > limit - 0.05)
    ]
    values = found.no_effect, found.nothing
    assert any(values == pytest.approx(one, abs=0.02) for one in expected), (values, expected)
    assert total[RHOS.index(found.rho)] > limit - 0.05


@pytest.mark.statistical
def test_a_walk_is_no_effect(random: np.random.Generator) -> None:
    """Without the bound, 0.14 of such tables have another verdict; with it, 0.05."""
    verdicts = [echocal.diagnose(table(slow(0.98, ROWS, random))) for _ in range(80)]
    assert sum(one.verdict != "nothing" for one in verdicts) <= 12
    assert sum(bool(one.model.effects) for one in verdicts) <= 6


def test_a_note_says_where_slow_noise_decides(random: np.random.Generator) -> None:
    answers = [inferred(table(slow(0.95, ROWS, random))) for _ in range(150)]
    limit = 0.44
    decided = 0
    for one in answers:
        bound = one.selection.slow
        assert bound is not None
        held = one.ranking.of_set(()) < limit <= bound.no_effect
        assert any(NOTE in note for note in one.diagnosis.notes) == held
        assert not (held and one.diagnosis.model.effects)
        decided += held
    assert decided > 0


@pytest.mark.statistical
def test_an_effect_in_white_noise_is_found(random: np.random.Generator) -> None:
    trend = 4.0 * SHOT * np.linspace(-1, 1, ROWS)
    answers = [echocal.diagnose(table(trend + SHOT * random.normal(size=ROWS))) for _ in range(20)]
    assert sum(one.verdict != "nothing" for one in answers) >= 12


def test_many_rows_need_no_bound(random: np.random.Generator) -> None:
    assert inferred(table(slow(0.9, 200, random))).selection.slow is None
