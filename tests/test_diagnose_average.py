"""What possible sets of causes say together, where some need more than is given."""

import pytest

import echocal
from echocal.diagnose.experiment_design.average import Member, averaged

LATE = echocal.Model("linear", effects={"fixed_delay": {"delay": 30e-6}})
WARMING = echocal.Model("linear", effects={"temperature_self_heating": {"rise": 0.5}})


def test_a_set_that_needs_what_nobody_gave_is_left_out_and_told() -> None:
    members = [
        Member(("temperature_self_heating",), 0.6, WARMING),
        Member(("fixed_delay",), 0.3, LATE),
        Member((), 0.1, echocal.Model("linear")),
    ]
    with pytest.warns(
        echocal.DataWarning, match=r"1 of 3 .* left out; .*probability of 0.60: .*needs elapsed_time"
    ):
        found = averaged(members, "indicate", 2.0, {"temperature": 20.0}, 1.0)
    late = LATE.indicate(2.0, temperature=20.0)
    assert set(found.by_cause) == {("fixed_delay",), ()}
    assert found.value == pytest.approx(0.75 * late + 0.25 * 2.0, abs=1e-12)


def test_where_no_set_can_be_asked_the_error_says_what_is_missing() -> None:
    members = [Member(("temperature_self_heating",), 1.0, WARMING)]
    with pytest.raises(echocal.DataError, match="needs elapsed_time"):
        averaged(members, "indicate", 2.0, {"temperature": 20.0}, 1.0)


@pytest.mark.filterwarnings("ignore::echocal.DisagreementWarning")
def test_sets_that_disagree_are_uncertain_by_their_spread() -> None:
    """10 mm, probable to 0.8, or nothing: the standard deviation is 4 mm."""
    off = echocal.Model("linear", effects={"zero_error": {"offset": 0.010}})
    members = [Member(("zero_error",), 0.8, off), Member((), 0.2, echocal.Model("linear"))]
    found = averaged(members, "indicate", 2.0, {"temperature": 20.0}, 1e-3)
    assert found.value == pytest.approx(2.008, abs=1e-12)
    assert found.standard_uncertainty == pytest.approx(0.004, abs=1e-12)
    assert not found.agreed
