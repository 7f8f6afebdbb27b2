"""The judge of the third world is judged: tables of the bench, what is true of them, made-up answers."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hidden_effects.bench.answers import facts, judge_again, judged, kept
from hidden_effects.bench.equations import equations
from hidden_effects.bench.influence import UNSTAGED, accompanies, cosine, influence, same_class, usual
from hidden_effects.bench.menu import SHARES, choices, fits, forces, has, menu
from hidden_effects.bench.page import beside
from hidden_effects.bench.real import real
from hidden_effects.bench.strength import DETECTABLE, _groups, _noise, strength
from hidden_effects.bench.summary import ROWS, summarize
from hidden_effects.bench.truth import MISTAKES, NOISES, PARAMETERS, UNFORESEEN, names
from hidden_effects.bench.words import REASONS, WHY
from hidden_effects.bench.world import Case, Spec, build, error, signal
from hidden_effects.page import page

import echocal
from echocal.virtual_bench import CAUSES, DESIGNS, simulate

ROOT = Path(__file__).parents[1]
KNOWN = frozenset(
    entry.id
    for registry in (echocal.effects, echocal.noises, echocal.row_faults, echocal.gross_faults)
    for entry in registry()
)


def hidden(
    *causes: str, design: str = "bench", detector: str = "ideal", stratum: str = "", seed: int = 3
) -> Case:
    kind = stratum or ("single" if causes else "null")
    return build(Spec(design, kind, causes, detector, seed))


def cause(id_: str, p: float = 0.97, rivals: Sequence[str] = (), **parameters: float) -> dict[str, Any]:
    effects = {effect.id for effect in echocal.effects()}
    told = [
        {"name": name, "value": value, "standard_uncertainty": 0.1 * abs(value), "unit": ""}
        for name, value in parameters.items()
    ]
    kind = "effect" if id_ in effects else "noise"
    rest = {"indistinguishable_from": list(rivals), "in_model": True, "parameters": told}
    return {"id": id_, "kind": kind, "probability": p, **rest}


def answer(*causes: dict[str, Any], unexplained: bool = False) -> dict[str, Any]:
    ids = [one["id"] for one in causes] + ["unknown"] * unexplained
    return {
        "verdict": "named" if causes else "nothing",
        "causes": list(causes),
        "posterior": [{"ids": ids, "probability": 0.97}, {"ids": ["stuck_reading"], "probability": 0.03}],
        "unexplained": {"against": "time"} if unexplained else None,
        "gain": None,
    }


def test_the_same_spec_is_the_same_table() -> None:
    spec = Spec("quick", "single", ("temperature_offset",), "comparator", 12)
    first = build(spec)
    again = simulate("quick", spec.sizes, seed=12)
    assert first.made.table.equals(again.table)
    assert spec.sizes == Spec("quick", "single", ("temperature_offset",), "comparator", 12).sizes


@pytest.mark.parametrize("design", list(DESIGNS))
@pytest.mark.parametrize("detector", ["ideal", "comparator"])
def test_without_a_cause_a_table_is_its_own_pair(design: str, detector: str) -> None:
    case = hidden(design=design, detector=detector)
    assert case.made.table.equals(case.without.table)
    assert np.nanmax(np.abs(signal(case))) == 0.0


@pytest.mark.statistical
@pytest.mark.parametrize("id_", list(CAUSES))
def test_every_cause_shows_in_some_design(id_: str, random: np.random.Generator) -> None:
    """At its usual size, with the detector that it is measured by."""
    found = {}
    for design in (d for d in DESIGNS if id_ in fits(d)):
        seed = next(
            int(s) for s in random.integers(2**62, size=99) if CAUSES[id_].needs <= has(design, int(s))
        )
        spec = Spec(design, "single", (id_,), "ideal", seed)
        case = Case(spec, simulate(design, spec.sizes, seed=seed, detector="ideal"))
        found[design] = strength(case, id_).strength
        if found[design] > DETECTABLE:
            break
    assert max(found.values()) > DETECTABLE, found


def test_the_signal_is_what_was_planted() -> None:
    delayed = hidden("fixed_delay")
    speed = echocal.speed_of_sound(*(delayed.made.table[c].to_numpy() for c in ("temperature_C",)), 0.5)
    expected = 0.5 * speed * delayed.spec.sizes["fixed_delay"]
    assert signal(delayed) == pytest.approx(expected, rel=0.01)
    moved = hidden("zero_error")
    assert signal(moved) == pytest.approx(moved.spec.sizes["zero_error"], abs=0.4e-3)  # ticks of 1 us


def test_strength_is_that_of_the_whole_covariance() -> None:
    """The closed form against the inverse of the covariance, written out."""
    case = hidden("temperature_gain")
    found, added, groups = strength(case, "temperature_gain"), signal(case), _groups(case)
    scatter, placement = _noise(case, groups)
    covariance = scatter**2 * np.eye(len(added)) + placement**2 * (groups[:, None] == groups)
    expected = np.sqrt(added @ np.linalg.solve(covariance, added))
    assert found.strength == pytest.approx(expected)
    assert 0.1e-3 < scatter < 0.4e-3 < placement < 2e-3  # turbulence and a tape in millimeters


def test_a_perfect_answer_is_named_and_an_empty_one_silent() -> None:
    case = hidden("temperature_gain")
    told = judged(case, answer(cause("temperature_gain", gain=case.spec.sizes["temperature_gain"])))
    assert (told["outcome"], told["strict"], told["alarm"]) == ("named", True, False)
    assert told["z"] == {"temperature_gain": 0.0}
    empty = judged(case, answer())
    assert (empty["outcome"], empty["strict"], empty["alarm"]) == ("silent", False, False)
    null = judged(hidden(), answer())
    assert (null["outcome"], null["strict"], null["alarm"]) == ("silent", True, False)


def test_a_record_can_be_judged_again() -> None:
    case = hidden("temperature_gain")
    told = answer(cause("temperature_gain", gain=case.spec.sizes["temperature_gain"]))
    first = {**facts(case), "answer": kept(told), **judged(case, told)}
    assert judge_again(json.loads(json.dumps(first)))["outcome"] == "named"
    assert judge_again({**first, "outcome": "wrong", "named": []})["named"] == first["named"]


def test_a_wrong_name_is_an_alarm() -> None:
    for case in (hidden(), hidden("zero_error")):
        told = judged(case, answer(cause("temperature_gain", gain=0.05)))
        assert (told["outcome"], told["alarm"], told["strict"]) == ("wrong", True, False)
        assert told["confident_wrong"] == ["temperature_gain"]
        unsure = judged(case, answer(cause("temperature_gain", 0.6, gain=0.05)))
        assert (unsure["outcome"], unsure["confident_wrong"]) == ("unsure", [])
    beside = answer(cause("zero_error", offset=5e-3), cause("temperature_gain", gain=0.05))
    assert judged(hidden("zero_error"), beside)["outcome"] == "named beside a wrong name"


def test_a_class_is_what_the_rows_cannot_tell_apart() -> None:
    case = hidden("zero_error")
    assert same_class(case, "zero_error", "fixed_delay")
    assert not same_class(case, "zero_error", "clock_error")
    assert same_class(hidden("clock_error"), "clock_error", "reference_scale")
    assert not same_class(hidden("clock_error"), "clock_error", "temperature_gain")
    assert judged(case, answer(cause("fixed_delay", delay=3e-5)))["outcome"] == "named"
    held = judged(case, answer(cause("clock_error", 0.97, ["zero_error"], frequency_error=0.004)))
    assert (held["outcome"], held["confident_wrong"]) == ("ambiguous", [])


def test_a_comparator_has_company() -> None:
    """A delay is true of every comparator and of no ideal detector; so is all that acts like one."""
    delay = answer(cause("fixed_delay", delay=-1e-4), cause("amplitude_walk", delay=3e-5, threshold=0.1))
    assert not judged(hidden(detector="comparator"), delay)["alarm"]
    assert judged(hidden(), delay)["alarm"]
    assert not judged(hidden(detector="comparator"), answer(cause("zero_error", offset=-0.02)))["alarm"]
    assert judged(hidden(detector="comparator"), answer(cause("clock_error", frequency_error=0.004)))["alarm"]
    assert accompanies(hidden(), "reference_error")
    assert not accompanies(hidden(design="outdoor"), "reference_error")


def test_what_is_always_there_is_no_finding() -> None:
    assert facts(hidden("fixed_delay", detector="comparator"))["always"] == ["fixed_delay"]
    assert facts(hidden("zero_error", detector="comparator"))["always"] == ["zero_error"]
    assert facts(hidden("noise_growth"))["always"] == ["noise_growth"]
    for id_ in ("fixed_delay", "zero_error", "interrupt_loss", "temperature_gain"):
        assert facts(hidden(id_))["always"] == []


def test_a_scale_is_true_only_at_the_size_of_dispersion() -> None:
    small, large = (answer(cause("clock_error", frequency_error=-size)) for size in (3e-4, 4e-3))
    case = hidden(design="round_robin")
    assert cosine(case, UNSTAGED["dispersion"](case.made), influence(case, "clock_error")) < -0.99
    assert not judged(case, small)["alarm"]
    assert judged(case, large)["alarm"]


def test_pairs_are_judged_cause_by_cause() -> None:
    case = hidden("temperature_gain", "zero_error", stratum="pair")
    one, other = cause("temperature_gain", gain=0.03), cause("zero_error", offset=5e-3)
    assert judged(case, answer(one, other))["outcome"] == "named"
    assert judged(case, answer(one))["outcome"] == "one of two"
    assert judged(case, answer(one, other))["strict"]
    assert not judged(case, answer(one))["strict"]


def test_what_the_catalogue_lacks_is_unknown() -> None:
    case = hidden("standing_wave", stratum="unknown")
    told = judged(case, answer(unexplained=True))
    assert (told["outcome"], told["says_unknown"], told["strict"]) == ("unknown", True, True)
    assert judged(case, answer(cause("temperature_gain", gain=0.05)))["outcome"] == "wrong"
    assert judged(case, answer())["outcome"] == "silent"


def test_the_truth_is_in_the_words_of_the_catalogue() -> None:
    for id_ in CAUSES:
        assert names(id_) <= KNOWN or id_ in UNFORESEEN, id_
    assert set(UNSTAGED) <= KNOWN
    parameters = {e.id: {p.name for p in e.parameters} for e in (*echocal.effects(), *echocal.noises())}
    for id_, (name, parameter, _) in PARAMETERS.items():
        assert parameter in parameters[name], id_
    assert set(CAUSES) >= MISTAKES | NOISES | UNFORESEEN


@pytest.mark.parametrize("id_", sorted(set(PARAMETERS) - NOISES - {"fixed_speed", "divisor"}))
def test_a_true_model_takes_a_cause_away(id_: str) -> None:
    """The size in the catalogue's parameter: sign and unit, on the table and in another campaign."""
    if id_ in ("temperature_self_heating", "step_change"):
        pytest.skip("its time is drawn beside its size")
    design = next(d for d in ("bench", "outdoor", "daily") if id_ in fits(d))
    case = hidden(id_, design=design, seed=4)
    name, parameter, value = PARAMETERS[id_]
    told = {parameter: value(case.made, case.spec.sizes[id_])}
    columns = {"second_temperature": "temperature_wall_C"} if id_ == "thermometer_mix" else {}
    model = echocal.Model(case.options["base"], {name: told}, columns=columns)
    elsewhere = simulate(design, seed=4, detector="ideal", replicate=1)
    for made, without in ((case.made, case.without), (case.again, elsewhere)):
        left, there = (error(made, m) - error(without) for m in (model, None))
        assert np.nanmean(left**2) < 0.5 * np.nanmean(there**2)  # a wrong sign leaves four times as much


def test_a_replicate_keeps_the_sensor_and_the_cause() -> None:
    case = hidden("polling_jitter", design="round_robin")
    other = case.again
    assert other.causes == case.made.causes
    assert other.campaign.distance == pytest.approx(case.made.campaign.distance, abs=2e-3)  # a hand's 0.2 mm
    assert not np.allclose(other.table["temperature_C"], case.made.table["temperature_C"], atol=0.1)
    assert not np.allclose(other.campaign.reference, case.made.campaign.reference, atol=1e-6)
    mounted, again = (simulate("outdoor", seed=5, replicate=r).scene.target.tilt for r in (0, 1))
    assert np.array_equal(mounted, again)


def test_a_menu_has_every_stratum_in_its_share() -> None:
    specs = menu(["bench", "snow"], 200, 5)
    assert specs == menu(["bench", "snow"], 200, 5)
    assert len(set(specs)) == len(specs)
    assert sum(SHARES.values()) == pytest.approx(1.0)
    for (stratum, detector), share in SHARES.items():
        drawn = [s for s in specs if (s.design, s.stratum, s.detector) == ("bench", stratum, detector)]
        assert len(drawn) == round(100 * share)
    for spec in specs:
        assert all(CAUSES[id_].needs <= has(spec.design, spec.seed) for id_ in spec.causes)
        assert spec.detector == "comparator" or not any(map(forces, spec.causes))
    assert not choices("outdoor", "mistake", "ideal").count(("fixed_speed",))


def record(outcome: str, named: Sequence[dict[str, Any]] = (), **more: Any) -> dict[str, Any]:
    usual_record = {
        "design": "bench",
        "stratum": "single",
        "causes": ["zero_error"],
        "measured_by": "ideal",
        "seed": 1,
        "seconds": 1.0,
        "marginal": False,
        "always": [],
        "named": list(named),
        "confident_wrong": [n["id"] for n in named if n["status"] == "wrong"],
        "says_unknown": False,
        "alarm": False,
        "strict": outcome == "named",
        "top_probability": 0.9,
        "z": {},
        "told": [2e-3, 1e-3],
        "fresh": [2e-3, 1.5e-3],
    }
    return {**usual_record, "outcome": outcome, **more}


def test_the_summary_counts() -> None:
    right = {"id": "zero_error", "kind": "effect", "probability": 0.99, "status": "planted"}
    wrong = {**right, "id": "temperature_gain", "status": "wrong"}
    records = [
        *(record("named", [right], z={"zero_error": z}) for z in (1.0, -1.0, 1.0, -1.0, 1.0, -1.0)),
        record("wrong", [wrong]),
        record("silent"),
        record("wrong", [wrong], marginal=True),
        record("named", [right], always=["zero_error"], told=None),
        record("wrong", [wrong], stratum="null", causes=[], alarm=True),
        record("silent", stratum="null", causes=[]),
    ]
    records[-2]["means"] = {"outcome": "unknown", "says_unknown": True, "alarm": False}
    summary = summarize(records)
    value = {name: of["bench"] and of["bench"]["value"] for name, of in summary["figures"].items()}
    assert value["one cause: named, ideal detector"] == pytest.approx(6 / 8)
    assert value["one cause: a confident wrong name, ideal detector"] == pytest.approx(1 / 8)
    assert value["false alarms, ideal detector"] == pytest.approx(1 / 2)
    assert value["names above 0.9 that are right"] == pytest.approx(7 / 9, abs=1e-4)
    assert value["share removed as told, ideal detector"] == pytest.approx(1 - 0.25)
    assert value["share removed in another campaign, ideal detector"] == pytest.approx(1 - 0.75**2)
    assert value["sizes: rms of z"] == pytest.approx(1.0)
    assert value["one cause: named, comparator"] is None
    assert value["a row a placement, ideal detector: unexplained term without a cause"] == 1.0
    assert value["a row a placement, ideal detector: false alarms"] == 0.0
    assert summary["by_cause"]["zero_error"]["wrong"] == {"temperature_gain": 1}
    assert summary["marginal_outcomes"] == {"wrong": 1}
    assert summary["null_names"]["ideal"] == {"temperature_gain": 1}


def test_equations_are_counted_alike() -> None:
    made = {
        "design": "b",
        "stratum": "wild",
        "rows": 400,
        "snr": 1.0,
        "named": {"zero_error": 0.99},
        "confident_wrong": [],
        "sure_counts": [1, 1, 1],
        "told": True,
        "top_probability": 0.99,
        "strict": True,
        "reported": [2e-3, 1e-3],
        "same": [4e-6, 0.0],
        "says_unknown": False,
    }
    missed = {**made, "sure_counts": [0, 0, 1], "named": {}, "told": None}
    faint = {**missed, "snr": 0.1}
    found = equations({"seed": 1, "records": [made, made, made, missed, faint]})["figures"]
    assert found["one cause: named, ideal detector"]["b"]["value"] == pytest.approx(0.75)
    assert found["share removed in another campaign, ideal detector"]["b"]["value"] == pytest.approx(
        4 / (4 + 1.5**2), abs=1e-4
    )
    assert set(found) <= set(ROWS)


def test_real_records_are_read_as_the_analyst_wrote() -> None:
    found = real()
    assert set(found["figures"]) <= set(ROWS)
    assert len(found["tables"]["placements"]) + len(found["tables"]["log"]) >= 15
    figures = found["figures"]["one cause: named, comparator"]
    assert figures["log"]["count"] > 5
    assert 0.0 < figures["log"]["value"] < 1.0


def test_the_page_is_fresh() -> None:
    made, bench = (
        json.loads((ROOT / "benches" / name).read_text())
        for name in ("diagnosis.json", "diagnosis_bench.json")
    )
    shown = (ROOT / "docs" / "diagnosis-benchmark.md").read_text()
    assert bench["real"] == json.loads(json.dumps(real())), (
        "run python benches/diagnosis_bench.py --read --docs"
    )
    assert "\n".join(beside(bench)) in shown
    assert shown == page(made, bench)


def test_every_cause_that_may_be_missed_has_a_reason() -> None:
    """The page says of each cause why it is missed, by numbers of its list of reasons."""
    assert set(WHY) >= set(CAUSES) - {"noise_growth", "round_trip_factor", "reading_quantization"}
    assert set(WHY) <= set(CAUSES)
    numbers = {int(n) for text in WHY.values() for n in re.findall(r"\b(\d+)(?=[,:;]|$)", text)}
    assert all(f"\n{n}. " in REASONS for n in numbers)


def test_usual_sizes_are_within_the_range_of_the_bench() -> None:
    assert all(abs(usual(id_)) <= CAUSES[id_].high for id_ in CAUSES)
