"""Leaving a law's domain is loud, once, or a mask as long as the input."""

import inspect
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import echocal
from echocal import domain
from echocal.domain import warn_outside
from echocal.quantities import QUANTITIES


def names(codes: np.ndarray) -> list[str]:
    return [echocal.DOMAIN_VIOLATIONS[code] for code in codes.ravel()]


def test_mask_has_the_broadcast_shape() -> None:
    codes = echocal.domain_violations([[20.0], [60.0]], [0.1, 0.5, 1.0], law="cramer")
    assert codes.shape == (2, 3)
    assert names(codes) == ["", "", "", "", "water_vapor_mole_fraction", "water_vapor_mole_fraction"]


def test_reasons() -> None:
    assert names(echocal.domain_violations([-21.0, np.nan, 20.0], law="virial")) == [
        "temperature",
        "not_a_number",
        "",
    ]
    assert names(echocal.domain_violations(20.0, [0.5, 1.43], law="virial")) == ["", "relative_humidity"]
    assert names(echocal.domain_violations(20.0, 0.5, [1013.25, 101325.0], law="virial")) == ["pressure", ""]
    assert names(echocal.domain_violations(20.0, 0.5, co2_mole_fraction=400.0)) == ["co2_mole_fraction"]
    codes = echocal.domain_violations(55.0, 0.5, law="virial", frequency=[0.0, 40e3])
    assert names(codes) == ["", "temperature"]
    assert names(echocal.domain_violations(20.0, 0.5, law=None, frequency=[40e3, 2e6])) == [
        "",
        "frequency_over_pressure",
    ]
    assert names(echocal.domain_violations(20.0, np.nan, np.nan, law="linear")) == [""]


def test_one_warning_with_both_sides() -> None:
    temperature = np.full(1000, 20.0)
    temperature[[812, 900]] = 48.0
    with pytest.warns(echocal.DomainWarning) as caught:
        warn_outside(temperature, 0.9, law="cramer")
    assert len(caught) == 1
    text = str(caught[0].message)
    assert "water_vapor_mole_fraction 0 .. 0.06: 2 of 1000 rows lie outside" in text
    assert "first at row 813 (row 1 is the first): 0.099" in text
    assert "'virial'" in text
    assert caught[0].filename == __file__


def test_where_nobody_listens_no_row_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[object] = []
    plain = domain._extreme
    monkeypatch.setattr(domain, "_extreme", lambda *given: looked.append(given) or plain(*given))
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        warn_outside([20.0, 99.0])
        assert not looked
        warnings.filterwarnings("ignore", message="another", category=UserWarning)  # not of this one, perhaps
        warn_outside([20.0, 99.0])
        assert looked
        warnings.simplefilter("error", echocal.DomainWarning)
        with pytest.raises(echocal.DomainWarning):
            warn_outside([20.0, 99.0])


def test_silent_inside_and_for_rows_without_a_number() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_outside([20.0, np.nan], 0.5)
        warn_outside([], 0.5)
        warn_outside(np.linspace(-20, 60, 81)[:, None], np.linspace(0, 1, 11), law="virial")
        # the corner of the columns is wet, no row is
        warn_outside([45.0, 10.0], [0.1, 1.0], law="cramer")


COLUMN = {
    "temperature": st.floats(-40.0, 80.0) | st.just(np.nan),
    "relative_humidity": st.floats(-0.1, 1.2),
    "pressure": st.floats(50e3, 120e3),
    "frequency": st.sampled_from([0.0, 10.0, 40e3, 2e6]),
}


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(
    st.sampled_from(["linear", "ideal_gas", "cramer", "virial"]),
    st.lists(st.fixed_dictionaries(COLUMN), min_size=1, max_size=4),
)
@example(  # the dry row is the only one with a sound to disperse
    "linear",
    [
        {"temperature": 0.0, "relative_humidity": 1.0, "pressure": 1e5, "frequency": 0.0},
        {"temperature": 0.0, "relative_humidity": 0.0, "pressure": 1e5, "frequency": 40e3},
    ],
)
def test_warns_exactly_where_the_mask_says(law: str, rows: list[dict[str, float]]) -> None:
    """The corners of the columns never clear a row that the mask would not."""
    columns = {name: np.array([row[name] for row in rows]) for name in COLUMN}
    codes = echocal.domain_violations(**columns, law=law)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warn_outside(**columns, law=law)
    counted = int(np.sum(codes > echocal.DOMAIN_VIOLATIONS.index("not_a_number")))
    assert len(caught) == min(counted, 1)
    if counted:
        assert f"{counted} of {len(rows)} rows" in str(caught[0].message)


def test_unknown_law_and_shapes() -> None:
    with pytest.raises(echocal.ModelError, match="cramer"):
        echocal.domain_violations(20.0, law="cramr")
    with pytest.raises(echocal.UsageError, match=r"\(2,\).*\(3,\)"):
        echocal.domain_violations([1.0, 2.0], [0.1, 0.2, 0.3])


@pytest.mark.parametrize("function", [echocal.domain_violations, warn_outside])
def test_defaults_are_those_of_the_core(function: Callable[..., object]) -> None:
    given = inspect.signature(function).parameters
    for name in ("relative_humidity", "pressure", "co2_mole_fraction"):
        assert given[name].default == QUANTITIES[name].default


def test_a_masked_value_is_not_taken_for_measured() -> None:
    masked = np.ma.masked_array([20.0, 999.0], mask=[False, True])
    assert names(echocal.domain_violations(masked)) == names(echocal.domain_violations([20.0, np.nan]))
