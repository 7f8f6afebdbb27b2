"""Logs that were written after the readers, each with its right reading written down before it was tried."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stranger_logs import Expected, logs

import echocal
from echocal.observations.inspection import inspect_log
from echocal.observations.options import ReadOptions

NAMES = tuple(logs(np.random.default_rng(0)))


@pytest.mark.parametrize("name", NAMES)
def test_a_log_of_a_stranger_is_read_right_or_asked_about(
    name: str, random: np.random.Generator, tmp_path: Path
) -> None:
    expected = logs(random)[name]
    path = tmp_path / "log.txt"
    path.write_text("\n".join(expected.lines) + "\n", encoding="utf-8")
    found = inspect_log(path, ReadOptions(columns=expected.column))
    assert not [column for column in expected.never if found.requests.get(column)]
    options: dict[str, Any] = {"columns": found.requests, "reading_speed": 343}
    if not any(column.proposal.request.startswith("temperature") for column in found.columns):
        options["at"] = {"temperature": 20}
    try:
        with warnings.catch_warnings(action="ignore"):
            data = echocal.read_observations(path, **options)
    except echocal.DataError:
        if expected.ask or expected.either:
            return
        raise
    assert not expected.ask, found.requests
    _compare(data, expected)


def _compare(data: echocal.Observations, expected: Expected) -> None:
    usable = np.where(data.usable, 1.0, np.nan)
    for what, got, tolerance in (
        ("reading", data.echo_time * 343 / 2, 2e-3),
        ("echo", data.echo_time, 1e-6),
        ("temperature", data.conditions.get("temperature"), 0.051),
    ):
        wanted = getattr(expected, what)
        if wanted is None:
            continue
        assert got is not None, what
        gone = np.isnan(np.asarray(wanted, dtype=float))
        if what != "temperature":
            got = got * usable
            gone = gone | (np.isnan(expected.temperature) if expected.temperature is not None else False)
        assert np.isnan(got).tolist() == gone.tolist(), what
        np.testing.assert_allclose(
            got[~gone], np.asarray(wanted)[~gone], atol=tolerance, rtol=0, err_msg=what
        )
    if expected.step is not None:
        steps = np.diff(data.conditions["elapsed_time"])
        assert np.nanmedian(steps) == pytest.approx(expected.step, abs=0.01)
    assert not set(expected.noextra) & set(data.extra)
