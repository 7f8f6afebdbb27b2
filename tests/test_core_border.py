"""What Python gives the core: wrong lengths, positions and labels are refused by name, never a panic."""

import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import core_fuzz_calls as calls
import numpy as np
import pytest

from echocal import _core

HERE = Path(__file__).parent


def test_everything_has_a_call() -> None:
    """A function that is new to the core gets a call in core_fuzz_calls.py, or is not tried below."""
    assert calls.public_names() == set(calls.CALLS)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="guards memory and time as Linux does")
def test_wrong_arguments_of_everything(tmp_path: Path, random: np.random.Generator) -> None:
    place = tmp_path / "under_way"
    command = [sys.executable, str(HERE / "core_fuzz.py"), str(random.integers(2**32)), "8", str(place)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    except subprocess.TimeoutExpired:
        pytest.fail(f"never ends: {place.read_text().strip()}")
    under_way = place.read_text().strip() if place.exists() else "nothing"
    assert done.returncode >= 0, f"signal {-done.returncode} at: {under_way}"
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr[-2000:]}"
    assert int(done.stdout.split()[0]) > 4000


def _departures() -> Any:
    return _core.departures("linear", [np.zeros(3), *[np.zeros(4)] * 4])


def _columns(groups: Any) -> _core.Columns:
    recorded = [20.0] * len(calls.QUANTITIES)
    return _core.Columns(calls.model(), np.ones(3), recorded, np.array(groups, np.uint32))


def _changed_in_place() -> Any:
    """Half the memory that a column had, with the length that it has now."""
    distance = np.ones(calls.ROWS)
    made = _core.Columns(calls.model(), distance, calls.recorded(), None)
    made.slope()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        distance.dtype = np.float32
    return made.gram()


def _products(**other: Any) -> Any:
    names = ("starts", "blocks", "cells", "distance", "places", "series", "correlations", "flat_level")
    return calls.columns().products(**{**dict(zip(names, calls.layout(), strict=True)), **other})


def _whiten(noise: int = 0, used: int = 2) -> Any:
    return calls.sums().whiten([_core.NoiseModel(noise, 0.0, 0.1, 1.0, 0.0)], [True] * used)


def _other_cells() -> Any:
    places = [(0, 0), (0, 1), (1, 2), (1, 2)]
    return calls.sums().joined(_products(places=places))


def _evaluate(*codes: Any) -> Any:
    return calls.CALLS["Firmware.evaluate"]().function([np.asarray(code) for code in codes])


def _designed() -> Any:
    return _core.design_firmware(calls.model(), {**calls.firmware_request(), "assumed": [20.0]}, None)


def _fit(products: Any, forms: int = 3, **given: Any) -> Any:
    some = [[_core.Form(*calls.form(0, given.get("free", [1])))] * forms]
    weight = np.zeros(given.get("noises", 3))
    return _core.fit_hypotheses(products, weight, given.get("degrees", 50.0), 1e-12, some, False)


_HUGE = np.full(calls.ROWS, 2**32 - 1, np.uint32)
_LAST = np.where(np.arange(calls.ROWS) == 47, 2, 0)
REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "a shorter column of air": (_departures, ValueError, "temperature has 3 rows, relative_humidity has 4"),
    "columns of a Jacobian": (
        lambda: calls.model().jacobian(np.ones(3), [np.ones(2)] * len(calls.QUANTITIES)),
        ValueError,
        "distance has 3 rows, temperature has 2",
    ),
    "groups of other rows": (lambda: _columns([0, 1]), ValueError, "distance has 3 rows, groups has 2"),
    "a group far away": (lambda: _columns([0, 0, 2**32 - 1]), ValueError, "groups has label 4294967295"),
    "more groups than rows": (
        lambda: _columns([0, 1, 3]),
        ValueError,
        "groups has label 3; labels of 3 rows are 0 to 2",
    ),
    "a column changed in place": (
        _changed_in_place,
        TypeError,
        "expected a NumPy array of float64 of 1 dimensions",
    ),
    "a stored column": (
        lambda: calls.columns().store(np.ones(5)),
        ValueError,
        "column has 5 rows, distance has 48",
    ),
    "levels of other groups": (
        lambda: calls.columns().shift("zero_error", [], [1.0]),
        ValueError,
        "levels has 1 rows, groups has 4",
    ),
    "a polynomial for ever": (
        lambda: calls.columns().legendre(np.ones(calls.ROWS), 0.0, 1.0, 2**63, [1.0], calls.LINES[:1]),
        ValueError,
        "9223372036854775809 degrees from 0 on; at most 1000",
    ),
    "a polynomial without its line": (
        lambda: calls.columns().legendre(np.ones(calls.ROWS), 0.0, 1.0, 1, [1.0], []),
        ValueError,
        "scales has 1 rows, lines has 0",
    ),
    "a wave without its means": (
        lambda: calls.columns().waves(np.ones(calls.ROWS), 1.0, [1.0], calls.LINES),
        ValueError,
        "scales has 1 rows, means has 2",
    ),
    "a polynomial too many": (
        lambda: calls.columns().legendre(np.ones(calls.ROWS), 0.0, 1.0, 1000, [1.0], calls.LINES[:1]),
        ValueError,
        "1001 degrees from 0 on; at most 1000",
    ),
    "a wave too many": (
        lambda: calls.columns().waves(np.ones(calls.ROWS), 1.0, [1.0] * 1001, [(0.0, 0.0)] * 1001),
        ValueError,
        "1001 multiples of a wave; at most 1000",
    ),
    "a column that is not there": (lambda: calls.columns().made([5]), IndexError, "no column 5: there are 5"),
    "a row that is not there": (
        lambda: calls.columns().made([0], np.array([48], np.uintp)),
        IndexError,
        "no row 48: there are 48",
    ),
    "rows that go back": (
        lambda: calls.columns().made([0], np.array([9, 3], np.uintp)),
        ValueError,
        "rows must ascend, but 3 follows 9",
    ),
    "a block that is not there": (lambda: _products(blocks=_HUGE), IndexError, "no block 4294967295"),
    "a cell that is not there": (lambda: _products(cells=_HUGE), IndexError, "no cell 4294967295"),
    "a cell of another block": (
        lambda: _products(cells=_LAST.astype(np.uint32)),
        ValueError,
        "row 24 is of block 1 and of cell 0, which lies in another",
    ),
    "no correlations": (
        lambda: _products(correlations=[]),
        ValueError,
        "no columns or no correlations",
    ),
    "a correlation that is not there": (
        lambda: _whiten(noise=3),
        IndexError,
        "no correlation 3: there are 3",
    ),
    "blocks of other sums": (lambda: _whiten(used=3), ValueError, "used has 3 rows, series has 2"),
    "sums of other groups": (_other_cells, ValueError, "the sums are of other rows"),
    "codes too few": (lambda: _evaluate([1, 2]), ValueError, "takes 2 codes, but got 1"),
    "codes too many": (lambda: _evaluate([1], [1], [1]), ValueError, "takes 2 codes, but got 3"),
    "codes too short": (
        lambda: _evaluate([1, 2], [1]),
        ValueError,
        "echo_code has 2 rows, temperature_code has 1",
    ),
    "codes in the other byte order": (lambda: _evaluate(np.array([1], ">i8"), [1]), TypeError, "int64"),
    "air of one number": (_designed, TypeError, "FirmwareRequest.assumed"),
    "combinations for ever": (
        lambda: _fit(calls.products(), 40),
        ValueError,
        "a hypothesis has 40 forms",
    ),
    "series that no row begins": (
        lambda: _products(series=np.array([2.0, 3.0])),
        ValueError,
        "block 1 has 3 series, but 2 of its rows begin one",
    ),
    "convection at no distance": (
        lambda: _products(distance=np.full(calls.ROWS, np.nan)),
        ValueError,
        "the distance of row 0 in convection must be finite and 0 or more, but is NaN",
    ),
    "an autoregression that explodes": (
        lambda: _core.NoiseModel(0, 1.0, 0.0, 1.0, 0.0),
        ValueError,
        "rho must be between -1 and 1, but is 1",
    ),
    "a negative variance of stations": (
        lambda: _core.NoiseModel(0, 0.5, -0.1, 1.0, 0.0),
        ValueError,
        "station_ratio must be 0 or more, but is -0.1",
    ),
    "a moving average that explodes": (
        lambda: _products(correlations=[None, 1.5]),
        ValueError,
        "a moving average must be between -1 and 1, but is 1.5",
    ),
    "bounds of other columns": (
        lambda: _core.Form(0, [], [1, 2], [(0.0, 1.0)], 1.0),
        ValueError,
        "free has 2 rows, bounds has 1",
    ),
    "bounds turned round": (
        lambda: _core.Form(0, [], [1], [(1.0, 0.0)], 1.0),
        ValueError,
        "a lower bound and an upper one, but has 1 and 0",
    ),
    "a bound that is no number": (
        lambda: _core.Form(0, [], [1], [(np.nan, 0.0)], 1.0),
        ValueError,
        "but has NaN and 0",
    ),
    "a weight above one": (
        lambda: _core.Form(0, [], [], [], 1.5),
        ValueError,
        "the weight of a form must be from 0 to 1, but is 1.5",
    ),
    "a prior that is no probability": (
        lambda: _core.Prior([0.4, 0.3, 0.2, np.nan], 0.1),
        ValueError,
        "the prior of a number of causes must be from 0 to 1, but is NaN",
    ),
    "a column of a form that is not there": (
        lambda: _fit(calls.products(), free=[6]),
        IndexError,
        "no column 6: there are 6",
    ),
    "weights of other noises": (
        lambda: _fit(calls.products(), noises=2),
        ValueError,
        "products has 3 rows, log_weight has 2",
    ),
    "products that are not square": (
        lambda: _fit(calls.products()[:, :5]),
        ValueError,
        "but are 3 of 5 by 6",
    ),
    "no degrees of freedom": (
        lambda: _fit(calls.products(), degrees=0.0),
        ValueError,
        "degrees must be finite and above 0, but is 0",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_name(case: str) -> None:
    call, error, message = REFUSED[case]
    with pytest.raises(error, match=message):
        call()


def test_joining_changes_neither_sum() -> None:
    """A frozen case stays as it is when another one is made from it."""
    one, other = calls.sums(), calls.sums()
    before = one.whiten([_core.NoiseModel(0, 0.0, 0.1, 1.0, 0.0)], [True, True])
    joined = one.joined(other)
    for sums in (one, other):
        assert "there are 3" in _message(lambda sums=sums: sums.whiten(_LAST_OF_SIX, [True, True]))
    after = joined.whiten([_core.NoiseModel(3, 0.0, 0.1, 1.0, 0.0)], [True, True])
    np.testing.assert_array_equal(before[0], after[0])
    joined.whiten(_LAST_OF_SIX, [True, True])


_LAST_OF_SIX = [_core.NoiseModel(5, 0.0, 0.1, 1.0, 0.0)]


def _message(call: Callable[[], Any]) -> str:
    with pytest.raises(IndexError) as caught:
        call()
    return str(caught.value)


def test_columns_that_are_not_finite_are_zero_in_other_sums_alone() -> None:
    columns = calls.columns()
    columns.store(np.where(np.arange(calls.ROWS) == 7, np.inf, 1.0))
    columns.settle()
    sums = columns.products(*calls.layout())
    white = [_core.NoiseModel(0, 0.0, 0.1, 1.0, 0.0)]
    cleared, finite = sums.without_infinite()
    assert finite == [True] * 5 + [False]
    assert not np.isfinite(sums.whiten(white, [True, True])[0]).all()
    products = cleared.whiten(white, [True, True])[0]
    assert np.isfinite(products).all()
    assert (products[0, 5] == 0.0).all()
    joined = cleared.joined(sums)
    again = joined.whiten([_core.NoiseModel(3, 0.0, 0.1, 1.0, 0.0)], [True, True])[0]
    np.testing.assert_array_equal(again, products)


def test_what_the_core_found_cannot_be_changed() -> None:
    (fit,) = _fit(calls.products())
    with pytest.raises(AttributeError):
        fit.log_evidence = 0.0
    for array in (fit.mean, fit.covariance, fit.noise):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_a_refused_column_leaves_the_others_alone() -> None:
    columns = calls.columns()
    before = columns.gram()
    for call in (columns.store, lambda c: columns.legendre(c, 0.0, 1.0, 1, [1.0], calls.LINES[:1])):
        with pytest.raises(ValueError, match="column has 5 rows"):
            call(np.ones(5))
    np.testing.assert_array_equal(columns.gram(), before)


def test_the_last_degree_and_wave_are_allowed() -> None:
    columns = calls.columns()
    before = len(columns)
    values = np.linspace(0.0, 1.0, calls.ROWS)
    columns.legendre(values, 0.0, 1.0, 999, [1.0], calls.LINES[:1])
    columns.waves(values, 1.0, [1.0] * 1000, [(0.0, 0.0)] * 1000)
    assert len(columns) == before + 1 + 2 * 1000


def test_labels_of_a_larger_table_keep_their_meaning() -> None:
    """Of some rows of a table, groups keep the labels that they have in all of it."""
    plain = _whiten()
    far = _products(places=[(0, 2**40), (0, 2**50), (1, 2**60), (1, 2**63)])
    moved = far.whiten([_core.NoiseModel(0, 0.0, 0.1, 1.0, 0.0)], [True, True])
    np.testing.assert_array_equal(moved[0], plain[0])


def test_an_array_in_another_order_has_the_same_numbers() -> None:
    """NumPy calls an array contiguous that lies in memory the other way round; it was read as it lay."""
    products = calls.products()
    found = (_fit(products), _fit(np.asfortranarray(products)))
    np.testing.assert_array_equal(*(fits[0].mean for fits in found))
    table = np.zeros(5, [("flag", "i1"), ("echo", "i8"), ("temperature", "i8")])
    table["echo"], table["temperature"] = np.arange(5), [0, 1, 2, 1, 0]
    expected = _evaluate(np.arange(5), np.array([0, 1, 2, 1, 0]))
    np.testing.assert_array_equal(_evaluate(table["echo"], table["temperature"]), expected)


def test_products_that_are_no_numbers_have_no_evidence() -> None:
    for forms in (calls.FORMS[:1], calls.FORMS):
        products = np.full((3, 6, 6), np.nan)
        (fit,) = _core.fit_hypotheses(products, np.zeros(3), 50.0, 1e-12, [calls.forms(forms)], False)
        assert not np.isfinite(fit.log_evidence)
