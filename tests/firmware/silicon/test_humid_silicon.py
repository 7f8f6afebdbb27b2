"""Functions of temperature and humidity on simulated silicon: the proven hash, and pinned costs on AVR."""

from pathlib import Path

import pytest
from costs import Cost, check
from test_diagnose_roof import COLUMNS, JULY
from test_silicon import DRY

import echocal
from echocal import Model, firmware, silicon
from echocal.errors import UsageError

pytestmark = pytest.mark.slow

COARSE = {"temperature": (4.0, -20.0, 60.0), "humidity": (0.25, 0.0, 1.0), "echo": 24_000}
FINE = {"temperature": (0.0625, -20.0, 60.0), "humidity": (0.01, 0.0, 1.0)}

MONTH = {end: JULY[end] for end in ("since", "until")}

MODELS = {
    "cramer": Model("cramer"),
    "delay": Model("cramer", {"fixed_delay": {"delay": 31e-6}}),
    "diagnosed": Model("linear", {"humidity": {"coefficient": 0.9}, "fixed_delay": {"delay": 31e-6}}),
}

# Full Cramer at every whole percent, by what is saved: the bound, and the most allowed per compiler version.
CEILINGS = {
    "size": (0.5e-3, {"5": Cost(194, 164, 0, 6, 261)}),
    "speed": (0.35e-3, {"5": Cost(856, 826, 0, 8, 186)}),
}


@pytest.mark.parametrize("prefer", CEILINGS)
def test_costs_stay_below_their_ceilings_over_three_billion_inputs(prefer: str) -> None:
    bound, most = CEILINGS[prefer]
    carbon = {"co2_mole_fraction": DRY["co2_mole_fraction"]}
    made = firmware.generate(
        Model("cramer"), "avr", max_error=bound, prefer=prefer, assume=carbon, n_threads=2, **FINE
    )
    assert made.report["inputs_checked"] == 1281 * 101 * (25_069 - 106 + 1)
    assert made.report["error_proven_m"] <= bound
    check(made, "avr", "-Os", most)


# The diagnosed model at every whole percent.
DIAGNOSED = {
    "size": (0.5e-3, {"5": Cost(184, 154, 0, 6, 254)}),
    "speed": (0.35e-3, {"5": Cost(856, 826, 0, 8, 184)}),
}


@pytest.mark.parametrize("prefer", DIAGNOSED)
def test_a_diagnosed_model_stays_below_its_ceilings(prefer: str) -> None:
    bound, most = DIAGNOSED[prefer]
    made = firmware.generate(MODELS["diagnosed"], "avr", max_error=bound, prefer=prefer, n_threads=2, **FINE)
    assert made.report["error_proven_m"] <= bound
    check(made, "avr", "-Os", most)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", silicon.CORES)
def test_every_input_of_a_coarse_device(name: str, model: str) -> None:
    """Some 2.5 million inputs, the bits of the twin on each core."""
    made = firmware.generate(MODELS[model], name, **COARSE)
    assert silicon.output_hash(made, name) == made.report["output_hash"]


@pytest.mark.parametrize("name", ["avr", "cortex-m0", "rv32"])
def test_a_table_in_two_inputs(name: str) -> None:
    made = firmware.generate(Model("cramer"), name, form="grid", max_error=2e-3, **COARSE)
    assert made.report["form"]["name"] == "grid"
    assert silicon.output_hash(made, name) == made.report["output_hash"]


@pytest.mark.parametrize("name", ["avr", "cortex-m0", "rv32"])
def test_a_diagnosed_model_runs_on_silicon(name: str, shared: Path, tmp_path: Path) -> None:
    """From a month of a sonic ranger on a roof to the bits that the chip computes.

    The model has a lag of the thermometer, too. This device does not measure how fast the temperature
    changes, so it accepts the lag, as the message of `firmware.generate` asks.
    """
    table = shared / "data" / "roof-sr50" / "roof_fixed_target_tidy.csv"
    diagnosis = echocal.diagnose(
        table, columns=COLUMNS, constant_distance=True, base="linear", reading_speed="331.4", **MONTH
    )
    diagnosis.model.save(tmp_path / "model.json")
    model = Model.load(tmp_path / "model.json")
    assert "humidity" in model.effects
    with pytest.raises(UsageError, match="--accept temperature_lag"):
        firmware.generate(model, name, **COARSE)
    made = firmware.generate(model, name, accept=["temperature_lag"], **COARSE)
    assert made.report["model_hash"] == model.hash
    assert made.report["error_proven_m"] <= 0.5e-3
    assert silicon.output_hash(made, name) == made.report["output_hash"]
