"""What the diagnosis says of three hundred tables; see tests/frozen.

A change that is meant to change an answer freezes it anew (`python tests/frozen/check.py --write`) and
explains the difference in its commit.
"""

import json
from collections import defaultdict

import pytest
from frozen.check import FROZEN, SHARED, diagnosed
from frozen.record import differences
from frozen.tables import tables

EXPECTED = json.loads(FROZEN.read_text())
NAMES = list(tables(SHARED))
GROUPS: dict[str, list[str]] = defaultdict(list)
for _name in NAMES:
    GROUPS["/".join(_name.split("/")[: 3 if _name.startswith("drawn") else 1])].append(_name)


def test_every_table_is_frozen() -> None:
    assert set(NAMES) <= set(EXPECTED)
    if SHARED.is_dir():
        assert set(EXPECTED) == set(NAMES)
        assert len(NAMES) >= 300


@pytest.mark.slow
@pytest.mark.parametrize("group", GROUPS)
def test_no_answer_has_changed(group: str) -> None:
    changed = {name: list(differences(EXPECTED[name], diagnosed(name)))[:5] for name in GROUPS[group]}
    changed = {name: lines for name, lines in changed.items() if lines}
    assert not changed, f"{len(changed)} of {len(GROUPS[group])}: {changed}"


def test_a_few_answers_have_not_changed() -> None:
    changed = {name: list(differences(EXPECTED[name], diagnosed(name)))[:5] for name in NAMES[::40]}
    assert not any(changed.values()), changed
