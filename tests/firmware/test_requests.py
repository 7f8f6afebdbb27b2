"""Unusual requests: each is met or clearly refused in half a minute of processor time.

``python tests/firmware/test_requests.py`` prints each request, its time and its answer.
"""

import time
import warnings
from collections.abc import Iterator
from typing import Any

import pytest
from test_every_effect import EFFECTS, model_with

from echocal import BoundError, Model, UsageError, firmware
from echocal.firmware import EchoCodes, HumidityCodes, TemperatureCodes, ThermistorCodes
from echocal.sensors import SENSORS

MOST = 30.0  # s of a processor
HOUSE = {"fixed_delay": {"delay": 31e-6}}
WALK = {"amplitude_walk": {"delay": 40e-6}}
FINE = {"temperature": (0.0625, -20.0, 60.0)}
HUMID = {**FINE, "humidity": HumidityCodes()}
NTC = ThermistorCodes(10e3, beta=3950.0, r25=10e3)


def part(name: str, **more: Any) -> dict[str, Any]:
    return {"temperature": SENSORS[name].temperature, "humidity": SENSORS[name].humidity, **more}


def requests() -> Iterator[tuple[str, Model, str, dict[str, Any]]]:
    """Name, model, target, and the rest of a request."""
    house, dry = Model("cramer", HOUSE), Model("cramer")
    for name in SENSORS:
        yield f"{name}, 0.5 mm", house, "avr", part(name)
    yield "SHT3X, 0.2 mm", house, "cortex-m0", part("SHT3X", max_error=0.2e-3)
    yield "SHT4X, 0.1 mm", house, "c99", part("SHT4X", max_error=0.1e-3)
    yield "BME280, speed", house, "esp32", part("BME280", prefer="speed")
    yield "DHT22, 0.2 mm, speed, avr", house, "avr", part("DHT22", prefer="speed", max_error=0.2e-3)
    yield "DHT22, 0.05 mm", house, "avr", part("DHT22", max_error=0.05e-3)
    yield (
        "BME280 without a shift, refused",
        house,
        "avr",
        part("BME280") | {"humidity": HumidityCodes(0.01 / 1024)},
    )
    yield (
        "AHT20 without a shift, refused",
        house,
        "avr",
        part("AHT20") | {"temperature": TemperatureCodes(200 / 2**20, -20.0, 60.0, -50.0)},
    )
    yield "32-bit timer of 72 MHz", house, "cortex-m3", {**FINE, "echo": EchoCodes(1 / 72, None, None, 32)}
    yield (
        "32-bit timer of 600 MHz, tight",
        house,
        "cortex-m7",
        {
            **FINE,
            "echo": EchoCodes(1 / 600, None, None, 32),
            "max_error": 0.05e-3,
        },
    )
    yield (
        "32-bit timer, no 64 bits, refused",
        house,
        "rp2040",
        {
            **FINE,
            "echo": EchoCodes(1 / 72, None, None, 32),
            "max_bits": 32,
        },
    )
    yield "32-bit timer and SHT4X", house, "msp430", part("SHT4X", echo=EchoCodes(1 / 8, None, None, 32))
    yield "no 64 bits, 0.1 mm", house, "rv32e", {**FINE, "max_bits": 32, "max_error": 0.1e-3}
    yield "no 64 bits, 0.001 mm, refused", dry, "c99", {**FINE, "max_bits": 32, "max_error": 1e-6}
    for unit, bound in (("0.1mm", 0.2e-3), ("mm", 0.7e-3), ("cm", 6e-3), ("0.01in", 0.3e-3), ("in", 20e-3)):
        yield f"{unit}, {bound * 1e3:g} mm", house, "avr", {**FINE, "output_unit": unit, "max_error": bound}
    for unit, bound in (
        ("Q16.16", 0.1e-3),
        ("Q8.24", 0.1e-3),
        ("Q8.8", 3e-3),
        ("Q4.12", 0.4e-3),
        ("Q3.13", 0.3e-3),
    ):
        far = 3.0 if unit == "Q3.13" else 4.0
        asked = {**FINE, "output_unit": unit, "max_error": bound, "max_distance": far}
        yield f"{unit}, {bound * 1e3:g} mm", house, "cortex-m4", asked
    yield (
        "int16 of 0.1 mm to 4 m, refused",
        house,
        "avr",
        {**FINE, "output_unit": "0.1mm", "output_type": "int16"},
    )
    yield (
        "int16 of mm with humidity",
        house,
        "avr",
        {**HUMID, "output_unit": "mm", "output_type": "int16", "max_error": 1e-3},
    )
    yield "thermistor, 10 bits", house, "avr", {"temperature": NTC}
    yield (
        "thermistor, 12 bits, 0.1 mm",
        house,
        "esp32",
        {
            "temperature": ThermistorCodes(10e3, beta=3950.0, r25=10e3, bits=12, side="supply"),
            "max_error": 0.1e-3,
        },
    )
    yield "thermistor and humidity", house, "avr", {"temperature": NTC, "humidity": HumidityCodes()}
    yield (
        "humidity that falls",
        model_with("humidity"),
        "avr",
        {**FINE, "humidity": HumidityCodes(-0.005, 0.0, 1.0, 1.0)},
    )
    yield "amplitude walk, humidity, refused", Model("cramer", WALK), "avr", {**HUMID, "max_error": 2e-3}
    yield "amplitude walk, 0.1 mm", Model("cramer", WALK), "avr", {**FINE, "max_error": 0.1e-3}
    yield "0.001 mm with humidity, refused", house, "c99", {**HUMID, "max_error": 1e-6}
    yield "0.02 mm with humidity", house, "avr", {**HUMID, "max_error": 2e-5}
    yield "to 10 m", house, "avr", {**FINE, "max_distance": 10.0, "echo": EchoCodes(1.0, 62_000.0)}
    for effect in EFFECTS:
        yield f"effect {effect}", model_with(effect), "avr", {"temperature": (0.5, -20.0, 60.0)}


def answer(model: Model, target: str, request: dict[str, Any]) -> tuple[float, str]:
    """Processor time [s], and what the answer is."""
    begun = time.process_time()
    with warnings.catch_warnings(action="ignore"):
        try:
            made = firmware.generate(model, target, n_threads=1, **request)
        except BoundError as error:
            text = f"refused: {error}"
        except UsageError as error:
            text = f"refused: {error}"
        else:
            report = made.report
            assert report["error_proven_m"] <= report["error_bound_m"]
            proven = f"{report['error_proven_m'] * 1e3:.4f} mm, {report['widest_bits']} bits"
            text = f"{proven}: {report['form']['description']}"
    return time.process_time() - begun, text


ALL = {name: rest for name, *rest in requests()}


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_half_a_minute_is_enough(name: str) -> None:
    model, target, request = ALL[name]
    seconds, text = answer(model, target, request)
    assert seconds <= MOST, f"{seconds:.0f} s: {text}"
    if "refused" in name:
        assert text.startswith("refused"), text
    elif not name.startswith("effect"):
        assert not text.startswith("refused"), text
    elif text.startswith("refused"):
        assert "--accept" in text or "mm or more" in text or "leave it out" in text, text


if __name__ == "__main__":
    for name, (model, target, request) in ALL.items():
        seconds, text = answer(model, target, request)
        print(f"{seconds:5.1f} s  {name} ({target}): {text}", flush=True)
