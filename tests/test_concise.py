"""Numbers as people read them."""

import math

import numpy as np
import pytest

from echocal.concise import concise, decimal, percent


@pytest.mark.parametrize(
    ("value", "uncertainty", "shown"),
    [
        (100.02147, 0.00035, "100.02147(35)"),  # GUM 7.2.2, in grams
        (79.92, 0.51, "79.9(5)"),
        (0.827, 0.119, "0.83(12)"),  # Review of Particle Physics, introduction, 5.3
        (0.827, 0.367, "0.8(4)"),  # the same
        (14.674, 0.964, "14.7(1.0)"),
        (78.57, 7.2, "79(7)"),
        (12345.0, 678.0, "12300(700)"),
        (0.6749, 2.2e-16, "0.6749"),
        (1.0, 0.0, "1"),
        (-0.0, 0.03, "0.000(30)"),
        (1.0, math.inf, "1(?)"),
    ],
)
def test_published_examples_and_edges(value: float, uncertainty: float, shown: str) -> None:
    assert concise(value, uncertainty) == shown


def test_what_is_shown_is_what_was_given(random: np.random.Generator) -> None:
    """Read back, the value is within half an uncertainty, and the uncertainty within 15 %."""
    for _ in range(2000):
        uncertainty = 10.0 ** random.uniform(-9, 9)
        value = uncertainty * random.normal() * 10.0 ** random.uniform(-2, 4)
        text = concise(value, uncertainty)
        mantissa, _, power = text.partition("e")
        number, _, digits = mantissa.rstrip(")").replace(")", "").partition("(")
        unit = 1.0 if "." in digits or "." not in number else 10.0 ** -len(number.partition(".")[2])
        scale = 10.0 ** int(power or 0)
        assert float(digits) * unit * scale == pytest.approx(uncertainty, rel=0.15), text
        assert abs(float(number) * scale - value) <= 0.51 * uncertainty, text
        assert len(digits.replace(".", "").strip("0")) <= 2


def test_no_power_of_ten_where_people_read_none() -> None:
    assert (decimal(1013.25), decimal(99.96, 2), decimal(23337.2, 6)) == ("1013", "100", "23337.2")
    assert (percent(0.996), percent(0.0042), percent(0.0)) == ("100 %", "0.4 %", "0 %")
