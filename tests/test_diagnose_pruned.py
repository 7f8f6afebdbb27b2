"""Pruning changes no reported probability."""

import sys

import numpy as np
import pytest
from hidden_effects.cases import Spec, build

import echocal
from echocal.diagnose.inference.posterior import posterior

CASES = (
    ("a", ()),
    ("a", ("fixed_delay", "humidity")),
    ("c", ("step_change", "humidity")),
)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("design", "causes"), CASES)
def test_the_posterior_is_that_without_pruning(
    design: str, causes: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    table = build(Spec(design, "test", causes, "normal", 0.0, 71)).table
    pruned = dict(echocal.diagnose(table).posterior)
    monkeypatch.setattr(sys.modules[posterior.__module__], "PRUNED", np.inf)
    whole = dict(echocal.diagnose(table).posterior)
    for ids in pruned.keys() | whole.keys():
        assert pruned.get(ids, 0.0) == pytest.approx(whole.get(ids, 0.0), abs=1e-6), ids
