"""What printed numbers can stand for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echocal.study.tables import Printed, reach


@given(st.integers(-10_000, 10_000), st.integers(0, 4), st.floats(-0.499, 0.499))
def test_holds_what_rounds_to_it(digits: int, decimals: int, within: float) -> None:
    unit = 10.0**-decimals
    printed = Printed(f"{digits * unit:.{decimals}f}")
    assert printed.half == pytest.approx(0.5 * unit)
    assert printed.holds(printed.value + within * unit)
    assert not printed.holds(printed.value + (1.01 + within) * unit)


def test_exponents_and_edges() -> None:
    assert Printed("6.13e-6").half == pytest.approx(0.5e-8)
    assert Printed("53.50").low == 53.495
    assert Printed("53.50").holds(53.505)  # an edge rounds either way
    assert not Printed("53.50").holds(53.5051)
    assert Printed("2.000").meets(1.9, 1.9996)
    assert not Printed("2.000").meets(1.9, 1.9994)


@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=6))
def test_reach_is_a_range_of_values_that_occur(center: list[float]) -> None:
    middle, half = np.array(center), np.full(len(center), 0.05)

    def spread(x: np.ndarray) -> float:
        return float(np.sqrt(np.mean((x - 10.0) ** 2)))

    low, high = reach(spread, middle, half)
    # independent: the root mean square of differences of one sign is monotone in each argument
    assert low == pytest.approx(spread(middle + half))
    assert high == pytest.approx(spread(middle - half))
