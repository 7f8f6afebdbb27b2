"""What the engine reaches in the benchmark of hidden effects is not lost.

Fixed cases guard each commit: `hidden_effects/reached.jsonl` says of each what the engine reaches, and
one loss fails. After a change that is meant, run ``python tests/test_hidden_effects.py`` and read the
difference: it writes that file anew. Two tests draw fresh cases, since fixed ones can be learned by heart.
``python benches/diagnosis.py`` draws many more, and measures the rates.
"""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hidden_effects.answers import ask, known
from hidden_effects.cases import Spec
from hidden_effects.menu import draw, fits
from scipy.stats import binom

Record = dict[str, Any]

FILE = Path(__file__).parent / "hidden_effects" / "reached.jsonl"
COUNTS = {"null": {"a": 18, "b": 22}, "power8": {"b": 16}, "wild": {"a": 16, "b": 24}, "unknown": {"b": 12}}
SEED = 20_261_122
"""The cases of the file were drawn with it, when it was made."""


def cases(random: np.random.Generator, counts: dict[str, dict[str, int]]) -> list[Spec]:
    engine, specs = known(), []
    for stratum, designs in counts.items():
        for design, count in designs.items():
            causes = [id_ for id_ in fits(design) if id_ in engine]
            specs += draw(design, stratum, count, causes, random)
    return specs


def reached(record: Record) -> list[str]:
    """Goals that an answer reaches."""
    if "error" in record:
        return []
    stratum = record["stratum"]
    goals = {
        "no alarm": stratum == "null" and not record["alarm"],
        "effect seen": stratum != "null" and record["verdict"] != "nothing",
        "class holds the cause": stratum in ("wild", "power8") and bool(record["told"]),
        "credible set holds the truth": stratum in ("null", "wild") and record["covered"],
        "no confident wrong name": not record["confident_wrong"],
        "says unknown": stratum == "unknown" and record["says_unknown"],
    }
    return [goal for goal, yes in goals.items() if yes]


def stored() -> list[tuple[Spec, list[str]]]:
    entries = [json.loads(line) for line in FILE.read_text(encoding="utf-8").splitlines()]
    return [
        (Spec(**{**entry["case"], "causes": tuple(entry["case"]["causes"])}), entry["reached"])
        for entry in entries
    ]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_nothing_is_lost(part: int) -> None:
    """Every goal of every fixed case, as it was: one that is gained is written down, so that it stays."""
    changed = []
    for spec, before in stored()[part::4]:
        now = reached(ask(spec))
        lost, gained = [g for g in before if g not in now], [g for g in now if g not in before]
        if lost or gained:
            changed.append(f"{spec}: lost {lost}, gained {gained}")
    assert not changed, "\n".join(["meant? then: python tests/test_hidden_effects.py", *changed])


def test_the_fixed_cases_are_worth_guarding() -> None:
    """The file holds what the benchmark draws, and the engine reaches most of it."""
    entries = stored()
    for stratum, designs in COUNTS.items():
        for design, count in designs.items():
            assert sum((s.stratum, s.design) == (stratum, design) for s, _ in entries) == count
    right = sum("no confident wrong name" in goals for _, goals in entries)
    assert right >= 0.95 * len(entries)


FRESH, FEW = 60, 7


def test_what_a_fresh_draw_proves() -> None:
    """The limit of the next two tests fails by chance once in a thousand runs, and when it should."""
    today, bad = 0.035, 0.20
    assert binom.sf(FEW, FRESH, today) < 2e-3
    assert binom.sf(FEW, FRESH, bad) > 0.9


@pytest.mark.statistical
@pytest.mark.slow
def test_fresh_noise_raises_few_alarms(random: np.random.Generator) -> None:
    """Alarms in 7 of 192 cases of the benchmark; a rate of 0.20 fails in nine of ten runs."""
    answers = [ask(spec) for spec in cases(random, {"null": {"a": FRESH // 2, "b": FRESH // 2}})]
    alarms = [record["seed"] for record in answers if record.get("alarm", True)]
    assert len(alarms) <= FEW, alarms


@pytest.mark.statistical
@pytest.mark.slow
def test_fresh_effects_are_seen(random: np.random.Generator) -> None:
    """One of 24 is missed in the benchmark; a rate of 0.20 fails in nine of ten runs."""
    answers = [ask(spec) for spec in cases(random, {"power8": {"b": FRESH}})]
    missed = [record["seed"] for record in answers if record.get("verdict", "nothing") == "nothing"]
    assert len(missed) <= FEW, missed


if __name__ == "__main__":
    specs = [spec for spec, _ in stored()] if FILE.exists() else cases(np.random.default_rng(SEED), COUNTS)
    lines = [json.dumps({"case": asdict(spec), "reached": reached(ask(spec))}) + "\n" for spec in specs]
    FILE.write_text("".join(lines), encoding="utf-8")
