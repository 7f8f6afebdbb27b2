import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import echocal

MODELS = [
    echocal.Model("linear"),
    echocal.Model("cramer", {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": 2e-3}}),
    echocal.Model("linear", {"humidity": {"coefficient": 0.8}, "clock_error": {"frequency_error": 1e-3}}),
    echocal.Model("virial", {"temperature_gain": {"gain": 0.02}, "fixed_speed": {"weight": 1.0}}),
]
MOIST = {"temperature": np.linspace(-10.0, 30.0, 5), "relative_humidity": 0.4}


@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_round_trip_over_arrays(model: echocal.Model) -> None:
    distance = np.linspace(0.02, 4.0, 7)[:, None]
    indication = model.indicate(distance, **MOIST)
    assert indication.shape == (7, 5)
    everywhere = np.broadcast_to(distance, (7, 5))
    np.testing.assert_allclose(model.correct(indication, **MOIST), everywhere, rtol=0, atol=1e-12)
    time = model.time_of_flight(distance, **MOIST)
    np.testing.assert_allclose(model.distance(time, **MOIST), everywhere, rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ["indicate", "time_of_flight", "correct", "distance", "jacobian"])
@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_an_array_is_a_loop_over_scalars(
    model: echocal.Model, method: str, random: np.random.Generator
) -> None:
    rows = {
        "temperature": random.uniform(-20.0, 30.0, 40),
        "relative_humidity": random.uniform(0.0, 1.0, 40),
        "pressure": random.uniform(80e3, 105e3, 40),
    }
    first = random.uniform(0.02, 4.0, 40) * (6e-3 if method == "distance" else 1.0)
    together = getattr(model, method)(first, **rows)
    each = [
        getattr(model, method)(float(x), **{name: float(column[i]) for name, column in rows.items()})
        for i, x in enumerate(first)
    ]
    np.testing.assert_array_equal(together, each)


def test_scalars_give_a_float() -> None:
    for method in ("indicate", "time_of_flight", "correct", "distance"):
        assert type(getattr(echocal.Model("linear"), method)(0.01, temperature=20)) is float
    assert echocal.Model("linear").jacobian(2.0, temperature=20).shape == (1,)


def test_empty_in_empty_out() -> None:
    assert echocal.Model("linear").indicate([], temperature=[]).shape == (0,)


def test_nan_in_nan_out_in_its_row_only() -> None:
    result = echocal.Model("linear").correct([1.0, np.nan, 1.0, 2.0], temperature=[20.0, 20.0, np.nan, 20.0])
    np.testing.assert_array_equal(np.isnan(result), [False, True, True, False])


@given(st.floats(0.02, 10.0), st.floats(-20.0, 60.0), st.floats(-3.0, 3.0))
def test_jacobian_is_the_slope_of_the_indication(distance: float, temperature: float, offset: float) -> None:
    def model(offset: float) -> echocal.Model:
        return echocal.Model("linear", {"temperature_offset": {"offset": offset}})

    to_distance, to_offset = model(offset).jacobian(distance, temperature=temperature)
    here = model(offset).indicate(distance, temperature=temperature)
    assert to_distance * distance == pytest.approx(here, rel=1e-12)
    step = 0.01
    up, down = (model(offset + s).indicate(distance, temperature=temperature) for s in (step, -step))
    assert to_offset == pytest.approx((up - down) / (2 * step), rel=1e-6)


def test_effects_and_names_are_in_the_order_of_the_chain() -> None:
    model = echocal.Model("linear", {"fixed_speed": {"weight": 1.0}, "speed_slope": {}})
    assert model.parameter_names == ("speed_slope.slope", "fixed_speed.weight", "fixed_speed.speed")
    assert model.effects["fixed_speed"] == {"weight": 1.0, "speed": 343.0}


def test_air_is_assumed_where_nothing_is_given() -> None:
    assumed = echocal.Model("cramer", air={"relative_humidity": 0.5, "temperature": 20.0})
    plain = echocal.Model("cramer")
    given = plain.time_of_flight(2.0, temperature=20.0, relative_humidity=0.5)
    assert assumed.time_of_flight(2.0) == given
    assert assumed.time_of_flight(2.0, temperature=None) == given
    dry = plain.time_of_flight(2.0, temperature=20.0)
    assert assumed.time_of_flight(2.0, relative_humidity=0.0) == dry


def test_a_quantity_that_is_needed_and_lacking_is_named_with_who_needs_it() -> None:
    with pytest.raises(echocal.DataError, match=r"law 'linear' needs temperature \[degC\]"):
        echocal.Model("linear").indicate(2.0)
    humid = echocal.Model("linear", {"humidity": {"coefficient": 1.0}})
    with pytest.raises(echocal.DataError, match="effect 'humidity' needs relative_humidity"):
        humid.indicate(2.0, temperature=20.0)
    offset = echocal.Model("343", {"temperature_offset": {"offset": 1.0}})
    with pytest.raises(echocal.DataError, match="effect 'temperature_offset' needs temperature"):
        offset.indicate(2.0)


def test_a_fixed_speed_needs_no_thermometer() -> None:
    assert echocal.Model("343").time_of_flight(34.3) == pytest.approx(0.2, rel=1e-15)


def test_humidity_counts_once() -> None:
    with pytest.raises(echocal.ModelError, match="count it twice"):
        echocal.Model("cramer", {"humidity": {}})
    both = {"humidity": {}, "unrecorded_humidity": {}}
    with pytest.raises(echocal.ModelError, match="exclude each other"):
        echocal.Model("linear", both)
    unrecorded = echocal.Model("cramer", {"unrecorded_humidity": {"relative_humidity": 0.5}})
    moist = echocal.Model("cramer").time_of_flight(2.0, temperature=20.0, relative_humidity=0.5)
    assert unrecorded.time_of_flight(2.0, temperature=20.0) == pytest.approx(moist, rel=1e-15)
    with pytest.raises(echocal.DataError, match=r"relative_humidity.*count twice"):
        unrecorded.time_of_flight(2.0, temperature=20.0, relative_humidity=0.5)


@pytest.mark.parametrize(
    ("effects", "message"),
    [
        ({"fixed_dely": {}}, "fixed_delay"),
        ({"fixed_delay": {"dealy": 1e-6}}, "it has: delay"),
        ({"fixed_delay": {"delay": 1.0}}, "outside its bounds"),
        ({"fixed_delay": {"delay": np.nan}}, "NaN"),
    ],
)
def test_wrong_effects_say_what_would_be_right(effects: dict[str, dict[str, float]], message: str) -> None:
    with pytest.raises(echocal.ModelError, match=message):
        echocal.Model("linear", effects)


@pytest.mark.parametrize(("name", "value"), [("humidity", 0.5), ("pressure", np.nan)])
def test_wrong_air(name: str, value: float) -> None:
    with pytest.raises(echocal.ModelError, match=rf"air.*{name}"):
        echocal.Model("cramer", air={name: value})


def test_leaving_the_domain_of_a_law_is_loud() -> None:
    with pytest.warns(echocal.DomainWarning, match="temperature"):
        echocal.Model("cramer").indicate(2.0, temperature=90.0)


@pytest.mark.parametrize(
    ("effects", "conditions"),
    [
        ({"humidity": {"coefficient": 1.0}}, {"relative_humidity": 1.0}),
        ({"unrecorded_humidity": {"relative_humidity": 1.0}}, {}),
    ],
)
def test_an_effect_holds_where_the_law_that_it_calls_holds(
    effects: dict[str, dict[str, float]], conditions: dict[str, float]
) -> None:
    with pytest.warns(echocal.DomainWarning, match="water_vapor_mole_fraction"):
        echocal.Model("linear", effects).indicate(2.0, temperature=45.0, **conditions)


def test_what_belongs_to_one_campaign_stays_there() -> None:
    effects = {"drift": {"rate": 1e-8}, "zero_error": {"offset": 2e-3}, "step_change": {"offset": 5e-3}}
    names = echocal.Model("linear", effects).parameter_names
    spread = {name: 1.0 + i for i, name in enumerate(names)}
    model = echocal.Model("linear", effects, covariance=np.diag([spread[name] ** 2 for name in names]))
    assert set(model.campaign_effects) == {"drift", "step_change"}
    lasting = model.transferable()
    assert lasting.campaign_effects == ()
    assert lasting.effects == {"zero_error": {"offset": 2e-3}}
    assert lasting.standard_uncertainties == {"zero_error.offset": spread["zero_error.offset"]}
    assert lasting.correct(1.0, temperature=20.0) == echocal.Model(
        "linear", {"zero_error": {"offset": 2e-3}}
    ).correct(1.0, temperature=20.0)
