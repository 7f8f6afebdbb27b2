"""Where an effect may begin: places along a column, closer where it explains most."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from echocal.diagnose import places as module
from echocal.diagnose.base import Base
from echocal.diagnose.candidates import Scene
from echocal.diagnose.places import places
from echocal.registry import find_effect

ROWS, BUMPED = 3000, 1891


def scene(order: np.ndarray) -> Scene:
    """A table whose sensor was bumped, its rows in some order."""
    random = np.random.default_rng(5)
    time = 60.0 * np.arange(ROWS)
    distance = random.uniform(0.3, 3.0, ROWS)
    temperature = 20 + 8 * np.sin(time * 2 * np.pi / 86400)
    residual = random.normal(0.0, 1e-3, ROWS) + 2e-3 * (np.arange(ROWS) >= BUMPED)
    conditions = {"temperature": temperature[order], "elapsed_time": time[order]}
    return Scene(
        Base.of("linear"), distance[order], conditions, lambda _: distance[order], None, residual[order]
    )


def found(id_: str, order: np.ndarray) -> list[tuple[float, float]]:
    effect = find_effect(id_)
    (place,) = (p for p in effect.parameters if p.tried_along)
    return places(effect, place, {}, scene(order))


@pytest.mark.parametrize("id_", ["step_change", "beam_edge"])
def test_the_order_of_the_rows_does_not_matter(id_: str) -> None:
    """Rows in order are looked at between places alone, others all over again."""
    in_order = found(id_, np.arange(ROWS))
    shuffled = found(id_, np.random.default_rng(2).permutation(ROWS))
    np.testing.assert_allclose(in_order, shuffled, rtol=1e-12)


def test_a_step_is_found_to_the_row() -> None:
    near = min(abs(time - 60.0 * (BUMPED - 0.5)) for time, _ in found("step_change", np.arange(ROWS)))
    assert near <= 60.0


def test_rows_are_not_looked_at_again_where_the_place_changes_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked: list[int] = []
    plain = module._Look._products

    def counted(self: Any, values: Sequence[float], rows: slice) -> Any:
        looked.append(len(self.of[0][rows]))
        return plain(self, values, rows)

    monkeypatch.setattr(module._Look, "_products", counted)
    found("step_change", np.arange(ROWS))
    assert looked.count(ROWS) == 1  # what a scale and the temperature leave, and all that is left, at once
    assert sum(looked) < (1 + 2 * 0.6) * ROWS
