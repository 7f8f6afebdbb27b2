"""How exactly each method times an echo, beside the bounds: docs/echo-times.png.

``python benches/echo_times.py --docs`` draws fresh captures, writes benches/echo_times.json and draws the
figure; without ``--docs`` it prints the tables only. Four minutes on one processor.
``python tests/reference/echo_times_page.py --write`` then puts the tables into docs/echo-times.md.
"""

import argparse
import json
import os
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import echocal
from echocal.virtual_bench import Scene, Sensor
from echocal.virtual_bench.waveform.measure import received
from echocal.virtual_bench.waveform.measure import waveform as sampled
from echocal.waveforms import cramer_rao_bound, ziv_zakai_bound

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "reference"))
from made_echoes import CARRIER, Echo, captures  # noqa: E402

RESULTS, FIGURE = ROOT / "benches" / "echo_times.json", ROOT / "docs" / "echo-times.png"
METHODS = ("matched_filter", "phase", "envelope", "threshold")
RATE, COUNT = 1e6, 5500  # samples per second [Hz], of a capture
EARLIEST, INTERVAL = 3e-3, 1e-3  # s: the echo begins somewhere in it
RATIOS = (
    12.5,
    15.0,
    17.5,
    20.0,
    22.5,
    25.0,
    27.5,
    30.0,
    32.5,
    35.0,
    37.5,
    40.0,
    42.5,
    45.0,
    50.0,
    55.0,
    60.0,
)
LEVEL = 0.3  # threshold of the comparator, of the echo's amplitude
HALF = 0.5 / CARRIER  # s: an error beyond it is that of another cycle
AT_ONCE = 1000  # captures, 44 MB
CLASSES = (0.0, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0)
STRENGTHS = np.geomspace(1.0, 30.0, 400)  # amplitude, in thresholds


def errors(method: str, echo: Echo, noise: Any, amplitude: Any, rng: np.random.Generator, n: int) -> Any:
    """Errors of a method [s], its uncertainties [s] and its ambiguities, of captures with an echo time."""
    noises, amplitudes = np.broadcast_to(noise, n), np.broadcast_to(amplitude, n)
    parts = [slice(first, first + AT_ONCE) for first in range(0, n, AT_ONCE)]
    found = [_errors(method, echo, noises[part], amplitudes[part], rng) for part in parts]
    return tuple(np.concatenate(values) for values in zip(*found, strict=True))


def _errors(method: str, echo: Echo, noise: Any, amplitude: Any, rng: np.random.Generator) -> Any:
    delays = rng.uniform(EARLIEST, EARLIEST + INTERVAL, len(noise))
    clean = captures(echo, delays, RATE, COUNT, amplitude)
    noisy = clean + noise[:, None] * rng.standard_normal(clean.shape)
    options = {"threshold": LEVEL} if method == "threshold" else {"template": echo.samples(RATE)}
    found = echocal.echo_times(noisy, RATE, method, **options)
    truth = delays
    if method == "threshold":  # a comparator's own delay is no error
        truth = echocal.echo_times(clean, RATE, method, noise=1e-6, **options).time
    good = found.found & np.isfinite(truth)
    return (found.time - truth)[good], found.standard_uncertainty[good], found.cycle_ambiguity[good]


def point(ratio: float, echo: Echo, rng: np.random.Generator, n: int) -> dict[str, Any]:
    """All methods at one ratio 2E/N0 [dB], in white noise over the whole band."""
    samples = echo.samples(RATE)
    noise = float(np.sqrt(np.sum(samples**2) / 10.0 ** (ratio / 10.0)))
    bound = cramer_rao_bound(samples, RATE, noise)
    found: dict[str, Any] = {
        "ratio_dB": ratio,
        "peak_dB": -20.0 * np.log10(noise),
        "cramer_rao_s": bound,
        "ziv_zakai_s": ziv_zakai_bound(samples, RATE, noise, INTERVAL),
    }
    for method in METHODS:
        off, spread, ambiguity = errors(method, echo, noise, 1.0, rng, n)
        right = np.abs(off) < HALF
        enough = right.sum() > 30
        found[method] = {
            "found": len(off) / n,
            "rms_s": float(np.sqrt(np.mean(off**2))) if len(off) else None,
            "right_rms_s": float(np.sqrt(np.mean(off[right] ** 2))) if enough else None,
            "score_sd": float(np.std(off[right] / spread[right])) if enough else None,
            "wrong": float(1.0 - right.mean()) if len(off) else None,
            "told": float(ambiguity.mean()) if len(off) else None,
        }
    return found


def reliability(echo: Echo, rng: np.random.Generator, n: int) -> dict[str, list[dict[str, float]]]:
    """Share of wrong cycles among captures of a stated ambiguity; strong and weak echoes."""
    samples = echo.samples(RATE)
    found = {}
    for method in METHODS:
        noise = np.sqrt(np.sum(samples**2)) / 10.0 ** (rng.uniform(20.0, 42.0, n) / 20.0)
        amplitude = (
            np.exp(rng.uniform(np.log(LEVEL), np.log(10.0 * LEVEL), n)) if method == "threshold" else 1.0
        )
        off, _, told = errors(method, echo, noise * amplitude, amplitude, rng, n)
        wrong = np.abs(off) >= HALF
        rows = []
        for low, high in pairwise(CLASSES):
            own = (told >= low) & (told < high)
            if own.sum() >= 50:
                rows.append(
                    {
                        "told": float(told[own].mean()),
                        "wrong": float(wrong[own].mean()),
                        "count": int(own.sum()),
                    }
                )
        found[method] = rows
    return found


def walk(echo: Echo) -> dict[str, list[float | None]]:
    """Delay of the comparator and of the matched filter [s] against the amplitude, without noise."""
    delays = np.full(len(STRENGTHS), EARLIEST)
    clean = captures(echo, delays, RATE, COUNT, LEVEL * STRENGTHS)
    template = echo.samples(RATE)
    crossing = echocal.echo_times(clean, RATE, "threshold", threshold=LEVEL, noise=1e-6).time
    matched = echocal.echo_times(clean, RATE, template=template, noise=1e-6).time
    found = {"threshold_s": crossing - EARLIEST, "matched_filter_s": matched - EARLIEST}
    return {name: [_rounded(value) for value in values] for name, values in found.items()}


def _rounded(value: float) -> float | None:
    return round(float(value), 12) if np.isfinite(value) else None


def world(rng: np.random.Generator, n: int) -> list[dict[str, Any]]:
    """Errors at an HC-SR04 of the virtual bench, whose echoes depend on target, path and temperature."""
    sensor, found = Sensor(), []
    for name, spread in (("20 °C", 0.0), ("5 to 35 °C", 15.0)):
        scene = Scene(rng.uniform(0.8, 2.5, n), temperature=20.0 + spread * rng.uniform(-1.0, 1.0, n))
        _, voltage = sampled(scene, sensor, rng, 250e3)
        arrival = received(scene, sensor).delays[:, 1]
        for method in METHODS:
            options = {"threshold": sensor.comparator.threshold} if method == "threshold" else {}
            echoes = echocal.echo_times(
                voltage, 250e3, method, template="mean", start=3e-3, stop=22e-3, **options
            )
            off = echoes.time - arrival
            off -= np.nanmedian(off)
            same = np.abs(off) < HALF
            found.append(
                {
                    "temperature": name,
                    "method": method,
                    "found": float(echoes.found.mean()),
                    "other_cycle": float(1.0 - same.mean()),
                    "sd_s": float(np.nanstd(off)),
                    "same_sd_s": float(np.std(off[same])),
                    "uncertainty_s": float(np.nanmedian(echoes.standard_uncertainty)),
                    "told": float(np.nanmean(echoes.cycle_ambiguity)),
                }
            )
    return found


def speed(echo: Echo, rng: np.random.Generator) -> dict[str, Any]:
    """Captures per second of one processor."""
    delays = rng.uniform(EARLIEST, EARLIEST + INTERVAL, 2000)
    noisy = captures(echo, delays, RATE, COUNT) + rng.normal(0.0, 0.1, (2000, COUNT))
    rates = {}
    for method in METHODS:
        used = []
        for _ in range(5):
            begun = time.process_time()
            echocal.echo_times(noisy, RATE, method)
            used.append(time.process_time() - begun)
        rates[method] = 2000.0 / min(used)
    return {"captures": 2000, "samples": COUNT, "per_second": rates, "load": os.getloadavg()[0]}


def measure(n: int, seed: int) -> dict[str, Any]:
    """Everything that the page shows."""
    rng, echo = np.random.default_rng(seed), Echo()
    return {
        "seed": seed,
        "captures": n,
        "points": [point(ratio, echo, rng, n) for ratio in RATIOS],
        "reliability": reliability(echo, rng, 8 * n),
        "walk": walk(echo),
        "world": world(rng, 200),
        "speed": speed(echo, rng),
    }


def _save(results: dict[str, Any]) -> None:
    """Write the results, one line for each part or point."""
    parts = []
    for name, part in results.items():
        rows = isinstance(part, list) and ",\n".join(json.dumps(one) for one in part)
        parts.append(f'"{name}": ' + (f"[\n{rows}\n]" if rows else json.dumps(part)))
    RESULTS.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def _ns(value: float | None) -> str:
    return "-" if value is None else f"{1e9 * value:,.0f}"


def _ratio(value: float | None, of: float) -> str:
    return "-" if value is None else f"{value / of:.2f}"


def table(results: dict[str, Any]) -> str:
    """RMS error of each method beside the bounds, as a table of the page."""
    text = [
        "| 2E/N0 [dB] | peak by noise [dB] | Cramér-Rao [ns] | Ziv-Zakai [ns] | matched filter [ns] "
        "| phase [ns] | envelope [ns] | threshold [ns] |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in results["points"]:
        cells = [
            f"{one['ratio_dB']:g}",
            f"{one['peak_dB']:.1f}",
            _ns(one["cramer_rao_s"]),
            _ns(one["ziv_zakai_s"]),
        ]
        text.append(f"| {' | '.join([*cells, *(_ns(one[method]['rms_s']) for method in METHODS)])} |")
    return "\n".join(text) + "\n"


def right(results: dict[str, Any]) -> str:
    """The matched filter where the cycle is right, and how often it is, as a table of the page."""
    text = [
        "| 2E/N0 [dB] | captures with a time | wrong cycle | told: mean cycle ambiguity "
        "| RMS error by Cramér-Rao, right cycle | the same, all "
        "| standard deviation of error by uncertainty, right cycle |",
        "|---|---|---|---|---|---|---|",
    ]
    for one in results["points"]:
        own, bound = one["matched_filter"], one["cramer_rao_s"]
        text.append(
            f"| {one['ratio_dB']:g} | {own['found']:.2%} | {own['wrong']:.2%} | {own['told']:.2%} "
            f"| {_ratio(own['right_rms_s'], bound)} | {_ratio(own['rms_s'], bound)} "
            f"| {_ratio(own['score_sd'], 1.0)} |"
        )
    return "\n".join(text) + "\n"


def physics(results: dict[str, Any]) -> str:
    """Errors at the virtual bench, as a table of the page."""
    text = [
        "| air | method | standard uncertainty, median [ns] | standard deviation of error, same cycle [ns] "
        "| another cycle | told: mean cycle ambiguity |",
        "|---|---|---|---|---|---|",
    ]
    text += [
        f"| {one['temperature']} | `{one['method']}` | {_ns(one['uncertainty_s'])} "
        f"| {_ns(one['same_sd_s'])} | {one['other_cycle']:.1%} | {one['told']:.2%} |"
        for one in results["world"]
    ]
    return "\n".join(text) + "\n"


def rates(results: dict[str, Any]) -> str:
    """Captures per second, as a table of the page."""
    own = results["speed"]["per_second"]
    return "| method | captures per second |\n|---|---|\n" + "".join(
        f"| `{method}` | {own[method]:,.0f} |\n" for method in METHODS
    )


def main() -> None:
    """Measure, print, and with --docs write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--captures", type=int, default=2000, help="for each point")
    parser.add_argument("--seed", type=int, default=int(np.random.SeedSequence().generate_state(1)[0]))
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--draw", action="store_true", help="draw what was measured last")
    parser.add_argument(
        "--world", action="store_true", help="measure at the virtual bench anew, keep the rest"
    )
    given = parser.parse_args()
    from echo_times_figure import draw

    if given.draw:
        draw(json.loads(RESULTS.read_text()), FIGURE)
        return
    if given.world:
        kept = json.loads(RESULTS.read_text())
        kept["world"] = world(np.random.default_rng(given.seed), 200)
        _save(kept)
        print(physics(kept))
        return
    results = measure(given.captures, given.seed)
    print(table(results), right(results), physics(results), rates(results), sep="\n")
    if given.docs:
        _save(results)
        draw(results, FIGURE)


if __name__ == "__main__":
    main()
