"""The numbers that decide a verdict: given, recorded, and each with its source."""

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest
import settings_page

import echocal
from echocal.diagnose import Settings
from echocal.diagnose.settings import table

TABLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"
NAMES = [name for name, *_ in table()]


def test_every_group_is_listed_and_every_number_says_what_it_is_and_where_it_comes_from() -> None:
    assert {name.partition(".")[0] for name in NAMES} == {group.name for group in fields(Settings)}
    assert len(set(NAMES)) == len(NAMES)
    for name, _, unit, source in table():
        assert unit, name
        assert len(source.split()) >= 5, f"{name}: {source}"


def test_a_diagnosis_records_its_settings_and_they_can_be_given_again() -> None:
    said = echocal.diagnose(TABLE).to_dict()
    recorded = json.loads(json.dumps(said["settings"], allow_nan=False))
    assert Settings.of(recorded) == Settings()
    again = echocal.diagnose(TABLE, settings=recorded).to_dict()
    said.pop("seconds"), again.pop("seconds")
    assert again == said


def test_another_number_decides_another_verdict() -> None:
    usual = echocal.diagnose(TABLE)
    certain = usual.causes[0].probability
    assert usual.verdict == "named"
    changed = {"claims": {"named": (1 + certain) / 2}, "noises": {"priors": {"reading_quantization": 1e-9}}}
    strict = echocal.diagnose(TABLE, settings=changed)
    assert strict.verdict == "ambiguous"
    assert strict.settings.claims.named > certain
    assert strict.causes[0].probability == pytest.approx(certain, abs=1e-6)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"claim": {}}, "'claim' is not one of the settings; there are rows, priors"),
        ({"claims": {"name": 1}}, "'name' is not one of the claims; there are claim_below"),
        ({"claims": {"named": "high"}}, "settings give claims.named the value 'high'; give one like 0.9"),
        ({"rows": {"folds": 2.5}}, "settings give rows.folds the value 2.5; give one like 5"),
        ({"terms": {"degrees": 4}}, "settings give terms.degrees the value 4; give one like (4, 16)"),
        ([], "settings map names to numbers"),
        ({"claims": 0.9}, "claims map names to numbers"),
    ],
)
def test_what_is_no_setting_is_refused(given: object, says: str) -> None:
    with pytest.raises(echocal.UsageError, match=re.escape(says)):
        echocal.diagnose(TABLE, settings=given)  # type: ignore[arg-type]


def test_the_page_is_fresh() -> None:
    assert settings_page.PAGE.read_text(encoding="utf-8") == settings_page.page(), (
        "run: python tests/reference/settings_page.py --write"
    )
