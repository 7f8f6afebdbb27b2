"""Leaving out what is hopeless changes no probability that is told."""

import numpy as np
import pytest
from hidden_effects.cases import Spec, build

import echocal
from echocal.diagnose.inference import hypotheses

CASES = (
    ("a", ()),
    ("a", ("fixed_delay", "humidity")),
    ("c", ("step_change", "humidity")),
)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("design", "causes"), CASES)
def test_as_if_nothing_were_left_out(
    design: str, causes: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    table = build(Spec(design, "test", causes, "normal", 0.0, 71)).table
    pruned = dict(echocal.diagnose(table).posterior)
    monkeypatch.setattr(hypotheses, "HOPELESS", np.inf)
    whole = dict(echocal.diagnose(table).posterior)
    for ids in pruned.keys() | whole.keys():
        assert pruned.get(ids, 0.0) == pytest.approx(whole.get(ids, 0.0), abs=1e-6), ids
