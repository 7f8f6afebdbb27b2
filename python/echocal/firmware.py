"""Fixed-point C from a calibrated model, proven over every input."""

import itertools
import json
import os
import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from echocal import _core, echoes, silicon
from echocal.budget.stated import Uncertainties
from echocal.codes import EchoCodes, FurtherCodes, HumidityCodes, TemperatureCodes, codes_of, count, numbers
from echocal.conditions import columns
from echocal.device_uncertainty import expanded_uncertainty
from echocal.domain import describe
from echocal.errors import BoundError, DomainWarning, UsageError
from echocal.further import further_of
from echocal.generated import Firmware
from echocal.keywords import exact, keyword
from echocal.model import Model
from echocal.model.needs import assumed
from echocal.model.origin import diagnosed
from echocal.model.uncertainty import stated
from echocal.recorded import WIDEST, recorded_command
from echocal.registry import find_effect
from echocal.reserved import RESERVED
from echocal.thermistor import ThermistorCodes

__all__ = [
    "EchoCodes",
    "Firmware",
    "FurtherCodes",
    "HumidityCodes",
    "TemperatureCodes",
    "ThermistorCodes",
    "generate",
]

Progress = Callable[[str, int, int], object]

_ABSOLUTE_ZERO = -273.15  # degC
_MOST_THREADS = 65_535  # set by hand, far above any machine
_WITHOUT_C = ("micropython", "rust")
_DS18B20 = TemperatureCodes()
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")  # valid in C, C++ and Python; no two differ by case alone
_LONGEST_NAME = 19  # C99 compares 31 characters of an external name (5.2.4.1); _output_hash has 12
_SUFFIXES = dict(_core.output_units())


def generate(
    model: Model,
    target: str = "c99",
    *,
    temperature: TemperatureCodes | ThermistorCodes | tuple[float, float, float] = _DS18B20,
    humidity: HumidityCodes | tuple[float, float, float] | None = None,
    further: FurtherCodes | str | None = None,
    echo: echoes.Echo = None,
    output_unit: str = "um",
    output_type: str | None = None,
    max_error: float = 0.5e-3,
    max_distance: float = 4.0,
    prefer: str = "size",
    form: str | None = None,
    accept: Iterable[str] = (),
    assume: Mapping[str, float] | None = None,
    max_table_bytes: int = 1024,
    median: int | None = None,
    gate: float | None = None,
    max_bits: int = 64,
    package: str = "c",
    name: str = "echocal",
    uncertainties: Iterable[str] | Mapping[str, float] = (),
    measure: bool = False,
    n_threads: int | None = None,
    progress: Progress | None = None,
    model_name: str = "MODEL.json",
    recorded: Mapping[str, Any] | None = None,
) -> Firmware:
    """Design the cheapest integer function that follows a model, and prove it on every input.

    Parameters
    ----------
    model : Model
        The model to follow. It gives the true distance from echo time and temperature.
    target : str
        Core that the C is for: ``"avr"``, ``"cortex-m0"``, ``"cortex-m3"``, ``"cortex-m4f"``, ``"rv32"``,
        ``"rv32e"`` (without multiplier), or ``"c99"``, any compiler with ``stdint.h``. ``"cortex-m4"``,
        ``"cortex-m7"``, ``"esp32"``, ``"rp2040"`` and ``"msp430"`` give the C of ``"c99"``.
    temperature : TemperatureCodes, ThermistorCodes or tuple of (lsb, low, high)
        Codes of the thermometer [degC], or of a converter that measures a thermistor in a divider.
    humidity : HumidityCodes or tuple of (lsb, low, high), optional
        Codes of the hygrometer [1]; default: the device has none. `echocal.sensors.SENSORS` has those of
        known parts.
    further : FurtherCodes or str, optional
        Codes of one further input, such as ``"supply_voltage=4.5:5.5:0.01"``; default: the device has none.
    echo : float, EchoCodes or tuple of (lsb, longest, shortest), optional
        Longest and shortest accepted echo time [us], and tick `lsb` of the timer [us], 1 us by default.
        The default of the shortest is the earliest echo from `echocal.echoes.BLANKING_M`. The default of the
        longest is the latest echo from `max_distance`. Both cover all conditions that the device accepts.
    output_unit : str
        Unit of the output: ``"um"``, ``"0.1mm"``, ``"mm"``, ``"cm"``, ``"0.01in"``, ``"in"``, or meters as a
        binary fixed-point number: ``"Q16.16"``, ``"Q8.24"``, ``"Q8.8"``, ``"Q4.12"``, ``"Q3.13"``. It is also
        the end of the function's name: ``echocal_distance_um``, ``echocal_distance_q16_16``.
    output_type : {"int32", "int16"}, optional
        Type of the output; default: ``"int32"``, and for Q formats of 16 bits ``"int16"``.
    max_error : float
        Largest error against the model at distances up to `max_distance` [m]; 0.5 mm is ``0.5e-3``.
    max_distance : float
        Distances up to this meet `max_error` [m].
    prefer : {"size", "speed"}
        What to save: bytes of flash, or cycles.
    form : str, optional
        The only form to try, ``"polynomial"``, ``"adapted"``, ``"interpolated_table"``, ``"segments"``,
        ``"square"``, ``"factored"``, ``"full_table"``, ``"bent"``, ``"additive"`` or ``"grid"``; default:
        the cheapest of all.
    accept : iterable of str, or str
        Effects that may be left out although they change the distance.
    assume : mapping of str to float
        Values of conditions that the device does not measure, for example
        ``{"relative_humidity": 0.5}``; default: the air of the model.
    max_table_bytes : int
        Largest size of all tables together [byte].
    median : {3, 5, 7}, optional
        Write a second C function beside the first: the median of this many of the last distances.
    gate : float, optional
        Largest distance from that median at which a distance supports it [m].
    max_bits : {32, 64}
        Widest integer that the function computes with; 32 for a compiler without ``int64_t``, or to save the
        library's product of 64 bits. ``report["widest_bits"]`` states what it needs.
    package : {"c", "arduino", "platformio", "esphome", "micropython", "esp-idf", "zephyr", "rust"}
        Kind of files: plain C with its self-test, an Arduino library with an example sketch, a
        PlatformIO project with the library in it, an external component for ESPHome, a module for
        MicroPython and CircuitPython, a component for ESP-IDF, a module for Zephyr, or a ``no_std``
        crate. All but ``"micropython"`` and ``"rust"`` hold the same C.
    name : str
        What the names of files, functions, macros and libraries begin with. Two sensors in one program need
        two names. Lower-case letters, digits and single underscores, at most 19 characters. No word that a
        language or its library reserves.
    uncertainties : iterable of str, or mapping of str to float
        Standard uncertainties of what the device measures or assumes, as in `echocal.correct`:
        ``["temperature_C=0.5"]`` or ``["thermometer=DHT22"]``, for the uncertainty that the header states.
    measure : bool
        Whether to compile the C for the target's core, run it in a simulator, and state the measured cost in
        header and report (``report["measured"]``). ``c99`` is measured on every core. Cores without an
        installed compiler or simulator are skipped; `echocal.silicon.missing` names the missing tools.
    n_threads : int, optional
        Threads of the proof; default: all processors.
    progress : callable, optional
        Called with the form in words, the number of checked inputs and the number of all inputs.
    model_name : str
        Name of the model file in the command that the files record.
    recorded : mapping of str to object, optional
        Options of that command which differ from this request: the request of `echocal.per_unit`.

    Returns
    -------
    Firmware
        Texts, report and twin.

    Raises
    ------
    BoundError
        If no form meets `max_error`. The message states the smallest error that is possible, and its cost.
    UsageError
        If an effect needs an input that the device lacks, or if the codes are invalid.

    Examples
    --------
    >>> from echocal import Model, firmware
    >>> model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    >>> made = firmware.generate(model, temperature=(0.5, -20, 60), max_error=0.5e-3)
    >>> made.report["error_proven_m"] < 0.5e-3
    True
    >>> int(made.distance_um(11_690, 40))  # 20 degC
    2001613
    """
    if not isinstance(model, Model):
        raise UsageError(f"firmware needs a Model, got {type(model).__name__}; Model.load(path) reads a file")
    model.refuse_shape("firmware")
    if measure and package in _WITHOUT_C:
        raise UsageError(f"measure needs C, and the package {package} contains none: choose another package")
    _refuse_name(name, output_unit)
    thermistor = temperature if isinstance(temperature, ThermistorCodes) else None
    codes = _above_absolute_zero(
        TemperatureCodes(1.0, thermistor.low, thermistor.high)
        if thermistor
        else codes_of("temperature", TemperatureCodes, temperature)
    )
    humidity_codes = None if humidity is None else codes_of("humidity", HumidityCodes, humidity)
    assume = _mapped(assume)
    if humidity_codes is not None and "relative_humidity" in assume:
        raise UsageError("relative_humidity is measured: it cannot be assumed as well")
    further_codes = None if further is None else further_of(further, model.reads)
    if further_codes is not None and further_codes.quantity in assume:
        raise UsageError(f"{further_codes.quantity} is measured: it cannot be assumed as well")
    air = _assumed(model, assume)
    threads = (os.cpu_count() or 1) if n_threads is None else n_threads
    if max_bits not in (32, WIDEST):
        raise UsageError(f"{keyword('max_bits', max_bits)} is no width of an integer: give 32 or {WIDEST}")
    request: dict[str, Any] = {
        "target": target,
        "package": package,
        "name": name,
        "prefer": prefer,
        "form": form,
        "temperature": numbers("temperature", codes),
        "thermistor": None if thermistor is None else (*thermistor.scale(), thermistor.words()),
        "humidity": None if humidity_codes is None else numbers("humidity", humidity_codes),
        "further": further_codes and (further_codes.quantity, numbers(further_codes.quantity, further_codes)),
        "output_unit": output_unit,
        "output_type": output_type,
        "maximum_error": float(max_error),
        "maximum_distance": float(max_distance),
        "maximum_table": count("max_table_bytes", max_table_bytes, 2**31 - 1, least=0),
        "widest": max_bits,
        "threads": count("n_threads", threads, _MOST_THREADS, least=1),
        "accept": [find_effect(effect).id for effect in ([accept] if isinstance(accept, str) else accept)],
        "assumed": air,
        "median": _median(median, gate),
        "model_hash": model.hash,
        "diagnosis": diagnosed(model.provenance),
        "standard_uncertainty": stated(model, {**model.air, **assume}, max_distance),
        "fitted": _fitted(model),
        "outside_domain": _outside(model, codes, humidity_codes, air),
        "command": "",
    }
    times = echoes.accepted(model._core, request, echo)
    request["echo"] = times.codes
    texts = _texts(uncertainties)
    known = Uncertainties.of(texts)
    more = {**({} if thermistor is None else {"ntc": thermistor.text()}), **(recorded or {})}
    request["command"] = recorded_command(request, model_name, assume, texts, measure, more)
    try:
        core = _core.design_firmware(model._core, request, progress)
    except BoundError as error:
        cost = _cost(_firmware(error.best, []), target, measure=measure)
        raise BoundError(f"{error}; that function takes {cost}") from None
    for line in request["outside_domain"]:
        warnings.warn(line, DomainWarning, stacklevel=2)
    echoes.warn_of(times, stacklevel=2)
    made = _firmware(core, [])
    budget = expanded_uncertainty(model, made.report, {**model.air, **assume}, known)
    found = [silicon.measure(made, core_) for core_ in silicon.cores_of(target)] if measure else []
    return _firmware(core, [one.to_dict() for one in found if one is not None], budget)


def _median(window: int | None, gate: float | None) -> tuple[int, float | None] | None:
    """Return window and gate [m] of the median filter, as the core takes them."""
    if window is not None:
        return count("median", window, 255, least=1), None if gate is None else float(gate)
    if gate is None:
        return None
    raise UsageError(
        f"a gate is about a median of the last distances, and none is wanted: give {keyword('median', 5)} too"
    )


def _refuse_name(name: str, unit: str) -> None:
    longest = _LONGEST_NAME - max(0, len(_SUFFIXES.get(unit, "")) - len("um"))
    if not isinstance(name, str) or not _NAME.fullmatch(name) or len(name) > longest:
        raise UsageError(
            f"{keyword('name', name)} cannot begin names of functions and files: give lower-case letters, "
            f"digits and single underscores, a letter first, at most {longest} characters"
        )
    if name in RESERVED:
        raise UsageError(
            f"{keyword('name', name)} is a word of a language or its library; add to it: {name}_1"
        )


def _mapped(assume: Mapping[str, float] | None) -> dict[str, float]:
    if assume is None or isinstance(assume, Mapping):
        return dict(assume or {})
    raise UsageError(f"assume maps conditions to values, {{'relative_humidity': 0.5}}; got {assume!r}")


def _above_absolute_zero(codes: TemperatureCodes) -> TemperatureCodes:
    if codes.low < _ABSOLUTE_ZERO:
        raise UsageError(f"temperature {codes.low:g} degC is below absolute zero; give a range of the air")
    return codes


def _fitted(model: Model) -> list[str]:
    """Return a line for each parameter of the model with a known standard uncertainty."""
    lines = []
    for effect, own in model.effects.items():
        units = {parameter.name: parameter.unit for parameter in find_effect(effect).parameters}
        for parameter, value in own.items():
            size = model.standard_uncertainties[f"{effect}.{parameter}"]
            if size:
                unit = "" if units[parameter] == "1" else f" {units[parameter]}"
                size = float(f"{size * (1 + 5e-3):.2e}")  # to three digits, never down
                lines.append(f"{effect}, {parameter}: {value:g}{unit}, standard uncertainty {size:g}{unit}")
    return lines


def _texts(uncertainties: Iterable[str] | Mapping[str, float]) -> list[str]:
    if isinstance(uncertainties, Mapping):
        return [f"{name}={exact(size)}" for name, size in uncertainties.items()]
    return [uncertainties] if isinstance(uncertainties, str) else [*uncertainties]


def _outside(
    model: Model, codes: TemperatureCodes, humidity: HumidityCodes | None, air: list[float]
) -> list[str]:
    """Return the corners of the code ranges that lie outside the domain of the law, a line each.

    The domain's limits are monotone in temperature and humidity, so the corners are enough.
    """
    lines = []
    humidities = (air[1],) if humidity is None else (humidity.low, humidity.high)
    for end, level in itertools.product((codes.low, codes.high), dict.fromkeys(humidities)):
        where = "in the assumed air" if humidity is None else f"and relative humidity {level:g}"
        lines.append(describe(model.law, [end, level, *air[2:4], 0.0], f"outside at {end:g} degC {where}"))
    return [line for line in dict.fromkeys(lines) if line]


def _firmware(
    core: _core.Firmware, measured: list[dict[str, Any]], budget: dict[str, Any] | None = None
) -> Firmware:
    files = dict(core.files(measured, budget))
    return Firmware(files, json.loads(files["report.json"]), core)


def _cost(made: Firmware, target: str, *, measure: bool) -> str:
    """Return flash and time in words, and whether they were measured."""
    able = (name for name in silicon.cores_of(target) if measure and not silicon.missing(name))
    core = next(able, None)
    found = None if core is None else silicon.measure(made, core)
    if found is None:
        flash, steps = made.ranked_by()
        unit = "cycles" if target == "avr" else "instructions"
        return f"about {flash} bytes of flash and {steps} {unit}, by the cost model"
    unit = "instructions" if found.cycles is None else "cycles"
    return f"{found.flash_bytes} bytes of flash and {found.steps} {unit}, measured on {found.core}"


def _assumed(model: Model, assume: Mapping[str, float]) -> list[float]:
    """Conditions where nothing is measured, in the order of the core."""
    if "temperature" in assume:
        raise UsageError("temperature is measured: it cannot be assumed; give its codes")
    _, (_, *values) = columns(0.0, {**model.air, **assume})
    assumed(assume)
    return [float(value[0]) for value in values]
