"""The bench beside real records, by the same functions; docs/virtual-bench.md tells how far they are apart.

The bounds are those that the page states. They do not say that the bench is right: they say that it has what
the record shows, and that the page is true.
"""

from pathlib import Path

import bench_anchors as anchors
import bench_anchors_page as page
import numpy as np
import pandas as pd
import pytest

from echocal.virtual_bench import Sensor

TRUE_PERIOD = 25.0  # us


@pytest.fixture(scope="module")
def real(shared: Path) -> pd.DataFrame:
    return anchors.desk(shared / "data")


@pytest.fixture
def bench(random: np.random.Generator) -> pd.DataFrame:
    return anchors.desk_on_the_bench(random, times=2)


def test_slips_of_the_record_and_of_the_bench(real: pd.DataFrame, bench: pd.DataFrame) -> None:
    """Shares within a factor of three and what chance adds; a cycle shorter than that of the carrier."""
    theirs, ours = anchors.shares(real), anchors.shares(bench)
    chance = 3 * np.hypot(theirs["error"], ours["error"])
    assert (ours["share"] < 3 * theirs["share"] + chance).all()
    assert (ours["share"] > theirs["share"] / 3 - chance).all()
    for record in (real, bench):
        mean, error, _ = anchors.spacing(record)
        assert 22.0 < mean < TRUE_PERIOD - 2 * error


def test_a_placement_holds_its_cycle(real: pd.DataFrame, bench: pd.DataFrame) -> None:
    """Two branches share nearly all near placements; without differences between placements there is one."""
    for record in (real, bench):
        _, numbers = anchors.branches(record)
        assert 0.15 < numbers["other"] < 0.5
        assert numbers["main"] + numbers["other"] > 0.9
        assert 22.5 < numbers["period"] < 26.5
        assert 0.2 < anchors.neighbors(record) < 0.5


def test_placements_that_are_alike_hold_one_cycle(
    random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So it is the placement that makes the branches, not the noise."""
    monkeypatch.setattr(anchors, "HAND", 0.0)
    monkeypatch.setattr(anchors, "TILT", 0.0)
    monkeypatch.setattr(anchors, "PLACED", 0.0)
    alike = anchors.delays(anchors.desk_on_the_bench(random))
    near = alike[alike["distance"].between(0.035, 0.205)]
    spread = near.groupby("distance")["delay"].agg(lambda one: (one - one.median()).abs().gt(12.0).mean())
    assert spread.mean() < 0.2


def test_the_walk_falls_and_then_stands(real: pd.DataFrame, bench: pd.DataFrame) -> None:
    """The bench differs by a constant and 20 us; a threshold that does not sink would rise instead."""
    walks = [anchors.walk(record)["mean"] for record in (real, bench)]
    for walk in walks:
        assert -110.0 < walk[1.0] - walk[0.05] < -50.0
        assert abs(walk[1.4] - walk[1.0]) < 25.0
    apart = walks[1] - walks[0]
    assert (apart - apart.mean()).abs().max() < 30.0


def test_without_noise_nothing_slips(random: np.random.Generator) -> None:
    """The share of slips tells of noise and bursts, not of the functions that count."""
    still = anchors.desk_on_the_bench(random, Sensor(noise=0.0, burst_scatter=0.0))
    assert anchors.shares(still)["share"].max() == 0.0


def test_the_page_has_the_numbers_of_the_record(real: pd.DataFrame) -> None:
    """Those of the bench depend on the processor's last digits; the record's do not."""
    text = page.PAGE.read_text(encoding="utf-8")
    for row in page.rows(real, real):
        assert f"| {row[0]} | {row[1]} |" in text, "run: python tests/reference/bench_anchors_page.py --write"


def test_absent_records_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(page, "SHARED", tmp_path)
    with pytest.raises(SystemExit, match="the real records are absent: no folder"):
        page.main()
