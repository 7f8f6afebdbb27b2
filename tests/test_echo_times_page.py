"""The tables of docs/echo-times.md are those of the last measurement, and its claims hold in them."""

import json

import echo_times_page

RESULTS = json.loads(echo_times_page.RESULTS.read_text())
POINTS = RESULTS["points"]


def test_the_page_is_fresh() -> None:
    text = echo_times_page.PAGE.read_text()
    assert echo_times_page.page(text) == text, "run: python tests/reference/echo_times_page.py --write"


def test_the_matched_filter_is_within_1_2_times_the_bound_from_15_db_on() -> None:
    for one in POINTS:
        if one["ratio_dB"] >= 15.0:
            assert one["matched_filter"]["right_rms_s"] < 1.2 * one["cramer_rao_s"], one["ratio_dB"]
        if one["ratio_dB"] >= 40.0:
            assert one["matched_filter"]["rms_s"] < 1.2 * one["cramer_rao_s"], one["ratio_dB"]


def test_no_method_is_better_than_the_bounds_allow() -> None:
    for one in POINTS:
        for method in ("matched_filter", "phase", "envelope", "threshold"):
            if one[method]["found"] == 1.0:  # below, the captures with an echo time are a choice
                bound = one["cramer_rao_s"] if one["ratio_dB"] > 35.0 else one["ziv_zakai_s"]
                assert one[method]["rms_s"] > 0.9 * bound, (one["ratio_dB"], method)
