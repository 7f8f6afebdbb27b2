"""Options of the codes that a device has."""

from dataclasses import replace

from echocal.errors import UsageError
from echocal.firmware import HumidityCodes, TemperatureCodes
from echocal.sensors import Sensor
from echocal.thermistor import ThermistorCodes, thermistor_of


def thermometer(
    ntc: str | None,
    sensor: Sensor | None,
    lsb: float | None,
    codes: str | None,
    zero: float | None,
    shift: int | None,
) -> TemperatureCodes | ThermistorCodes:
    """Return the codes of a thermistor if there is one, else those of a known sensor or a DS18B20."""
    given = _given(lsb, zero, shift)
    if ntc is None:
        usual = TemperatureCodes() if sensor is None else sensor.temperature
        _refuse_mixed("temperature", usual, lsb, zero, shift)
        return replace(usual, **given, **_range("--temperature-range", codes, "-20:60"))
    if sensor is not None or given:
        raise UsageError(
            "--ntc states the codes of the thermometer: leave out --sensor, --temperature-lsb, "
            "--temperature-zero and --temperature-shift"
        )
    return thermistor_of(ntc, **_range("--temperature-range", codes or "-20:60", "-20:60"))


def humidity_codes(
    sensor: Sensor | None, lsb: float | None, codes: str | None, zero: float | None, shift: int | None
) -> HumidityCodes | None:
    """Return the codes of the hygrometer; None if the device has none."""
    usual = None if sensor is None else sensor.humidity
    given = _given(lsb, zero, shift)
    if usual is None and lsb is None:
        if codes is None and not given:
            return None
        option = "--humidity-range" if codes is not None else f"--humidity-{min(given)}"
        raise UsageError(f"{option} needs --humidity-lsb, the step of one humidity code")
    usual = usual or HumidityCodes()
    _refuse_mixed("humidity", usual, lsb, zero, shift)
    return replace(usual, **given, **_range("--humidity-range", codes, "0:1"))


def _refuse_mixed(
    name: str,
    usual: TemperatureCodes | HumidityCodes,
    lsb: float | None,
    zero: float | None,
    shift: int | None,
) -> None:
    """Raise `UsageError` if the step of a sensor's codes is replaced, and their zero or shift is kept."""
    if lsb is None or lsb == usual.lsb:
        return
    kept = {"zero": usual.zero if zero is None else 0, "shift": usual.shift if shift is None else 0}
    if own := {f"--{name}-{what}": value for what, value in kept.items() if value}:
        told = " and ".join(f"{flag} {value:g}" for flag, value in own.items())
        raise UsageError(
            f"--{name}-lsb {lsb:g} replaces the sensor's step {usual.lsb:g}, and {told} of the sensor would "
            f"stay: give {' and '.join(own)}, too, or leave out --{name}-lsb or --sensor"
        )


def _given(lsb: float | None, zero: float | None, shift: int | None) -> dict[str, float]:
    given = {"lsb": lsb, "zero": zero, "shift": shift}
    return {name: value for name, value in given.items() if value is not None}


def _range(name: str, text: str | None, example: str) -> dict[str, float]:
    if text is None:
        return {}
    low, separator, high = text.partition(":")
    try:
        return {"low": float(low), "high": float(high if separator else "missing")}
    except ValueError:
        raise UsageError(f"{name} is '{text}': give LOW:HIGH, as in {name}={example}") from None
