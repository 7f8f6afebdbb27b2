"""Each part runs on a few cases: `pytest benches/honesty`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import coverage
import nulls
import page
import records
import rotation
import transfer

needs_records = pytest.mark.skipif(records.folder() is None, reason="real records are absent: ../shared/data")


@pytest.mark.slow
@needs_records
def test_transfer() -> None:
    tables = records.windows("ot-hw-2022", 13)[:2]
    answers = [records.ask(table, "ot-hw-2022") for table in tables]
    both = list(zip(tables, answers, strict=True))
    pairs = [transfer._pair(("ot-hw-2022", 0, 1, both)), transfer._pair(("ot-hw-2022", 1, 0, both[::-1]))]
    part = {"extra": False, "windows": [one.said for one in answers], "pairs": pairs}
    summary = transfer.summarize({"ot-hw-2022, 13 d": part})
    worse = summary["figures"]["all but extra"]["worse"]
    assert worse["count"] == 2
    assert summary["windows"]["ot-hw-2022, 13 d"][0]["removed"] == [transfer.removed(pairs[0])]


@pytest.mark.slow
@needs_records
def test_a_turn_keeps_the_residual_and_moves_it() -> None:
    stretch = next(rotation.stretches("ot-hw-2022"))
    turned = stretch.turned(2, whole=True)
    again = rotation.records.corrected(turned, rotation._base(rotation.RECORDS["ot-hw-2022"]), "ot-hw-2022")
    moved = again[2 * stretch.per_day :] - stretch.level
    assert moved == pytest.approx(
        stretch.residual[: -2 * stretch.per_day], abs=0.51 * stretch.step, nan_ok=True
    )
    without = stretch.residual - stretch.mean_day()
    by_hour = without.reshape(stretch.days, stretch.per_day)
    assert rotation.np.ptp(rotation.np.nanmean(by_hour, axis=0)) < 1e-9
    assert 1.0 <= rotation.independent(stretch) <= stretch.days - 1
    answer = rotation._ask(("ot-hw-2022", 2, True, rotation.cut(turned, stretch.per_day, 13)[0]))
    row = rotation.summarize([{"record": "ot-hw-2022", **answer}], {"ot-hw-2022": {}})["figures"][
        "all, whole"
    ]
    assert row["named"]["count"] == 1


@pytest.mark.slow
def test_a_planted_effect_is_judged_on_a_replicate() -> None:
    (task,) = nulls.draw(1, 1, ["white"], ["b"], planted=True)
    null = nulls.draw(1, 1, ["AR 0.6"], ["a"], planted=False)[0]
    found = [nulls.ask(task), nulls.ask(null)]
    assert found[0]["fresh"] < 1.0
    summary = nulls.summarize(found)
    assert summary["planted"]["all"]["named"]["count"] == summary["nulls"]["all"]["named"]["count"] == 1


def test_the_stated_uncertainty_is_compared_with_fresh_rows() -> None:
    found = [coverage.ask(spec) for design in ("a", "outdoors") for spec in coverage.draw(design, 1, 5)]
    figures = coverage.summarize(found)
    assert figures["all"]["count"] == 2
    assert all(0.0 < row["within_1"][0] <= row["within_2"][0] for row in figures.values())


def test_the_page_is_fresh() -> None:
    text = page.page(*(page.json.loads((page.HERE / f"{name}.json").read_text()) for name in page.PARTS))
    assert page.PAGE.read_text(encoding="utf-8") == text, "run: python benches/honesty/page.py --write"
