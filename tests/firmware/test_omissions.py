"""What an omission costs holds for every accepted echo, the nearest too."""

import pytest

from echocal import Model, firmware


@pytest.mark.parametrize("shortest", [200, 400, 1000])
def test_the_stated_cost_is_not_exceeded_at_the_nearest_echo(shortest: int) -> None:
    model = Model("linear", {"transducer_spacing": {"square": 0.026**2}})
    codes = {"temperature": (0.5, 0.0, 40.0), "echo": (1.0, 20_000, shortest)}
    made = firmware.generate(model, accept="transducer_spacing", **codes)
    (cost,) = (one["left_m"] for one in made.report["omissions"] if one["effect"] == "transducer_spacing")
    for celsius in (0, 20, 40):
        true = float(model.distance(shortest * 1e-6, temperature=celsius))
        away = abs(float(made.distance_um(shortest, 2 * celsius)) * 1e-6 - true)
        assert away <= cost + made.report["error_proven_m"]
        assert cost < 1e-2
