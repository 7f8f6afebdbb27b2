"""Where an effect may begin: places along a column, closer where it explains most."""

from types import SimpleNamespace

import numpy as np
import pytest

from echocal.diagnose.candidates.onsets import places
from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.settings import Settings
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
    table = SimpleNamespace(
        reference=distance[order], distance=lambda _: distance[order], conditions=conditions
    )
    return Scene(table, Base.of("linear"), residual[order], Settings())


def found(id_: str, order: np.ndarray) -> list[tuple[float, float]]:
    effect = find_effect(id_)
    (place,) = (p for p in effect.parameters if p.tried_along)
    return places(effect, place, {}, scene(order))


@pytest.mark.parametrize("id_", ["step_change", "beam_edge"])
def test_the_order_of_the_rows_does_not_matter(id_: str) -> None:
    in_order = found(id_, np.arange(ROWS))
    shuffled = found(id_, np.random.default_rng(2).permutation(ROWS))
    np.testing.assert_allclose(in_order, shuffled, rtol=1e-12)


def test_a_step_is_found_to_the_row() -> None:
    near = min(abs(time - 60.0 * (BUMPED - 0.5)) for time, _ in found("step_change", np.arange(ROWS)))
    assert near <= 60.0
