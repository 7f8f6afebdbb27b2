"""Ask the public interface about a table of the bench, and write down what it said beside the truth."""

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import echocal
from echocal.errors import EchocalError
from hidden_effects.answers import NAMED
from hidden_effects.bench import gains
from hidden_effects.bench.influence import accompanies, direction, same_class
from hidden_effects.bench.strength import DETECTABLE, strengths
from hidden_effects.bench.world import PLACEMENTS, Case, Column, Spec, build, error

Record = dict[str, Any]

OUTCOMES = (
    "named",
    "named beside a wrong name",
    "ambiguous",
    "one of two",
    "unknown",
    "wrong",
    "unsure",
    "silent",
)
"""What a diagnosis makes of planted causes, best first; see `outcome`."""


def ask(spec: Spec) -> Record:
    """Diagnose one table; an error of the engine is an answer too."""
    case = build(spec)
    start = time.perf_counter()
    said: Record = {}
    with warnings.catch_warnings(action="ignore"):
        try:
            diagnosis = echocal.diagnose(case.made.table, **case.options)
        except EchocalError as error:  # a line that the user can act on
            said = {"refused": f"{type(error).__name__}: {error}"}
        except Exception as error:  # a traceback that the user would see
            said = {"error": f"{type(error).__name__}: {error}"}
        seconds = time.perf_counter() - start
        if not said:
            answer = kept(diagnosis.to_dict())
            gained = {"told": gains.told(answer), "fresh": gains.fresh(case, diagnosis.model)}
            said = {"answer": answer, **judged(case, answer), **gained}
        if spec.design in PLACEMENTS and spec.stratum in ("null", "single"):
            said["means"] = _of_means(case)
    return {**facts(case), "seconds": round(seconds, 3), **said}


def _of_means(case: Case) -> Record:
    """What the engine says with one row for each placement: the mean of its readings."""
    table = case.made.table.groupby(case.made.campaign.placement).mean()
    try:
        answer = kept(echocal.diagnose(table, **case.options).to_dict())
    except Exception as error:  # whatever it is, a user would see it
        return {"error": f"{type(error).__name__}: {error}"}
    return {"answer": answer, **judged(case, answer)}


def kept(answer: Mapping[str, Any]) -> Record:
    """The part of an answer that is judged: a record that holds it can be judged again."""
    keys = ("id", "kind", "probability", "parameters", "indistinguishable_from")
    return {
        "verdict": answer["verdict"],
        "causes": [
            {
                **{key: cause[key] for key in keys},
                "in_model": cause.get("in_model", True),
                "doubt": cause.get("doubt", ""),
            }
            for cause in answer["causes"]
        ],
        "posterior": [max(answer["posterior"], key=lambda entry: entry["probability"])],
        "unexplained": answer["unexplained"] and {"against": answer["unexplained"]["against"]},
        "gain": answer["gain"] and {key: answer["gain"][key] for key in ("rms_before_m", "rms_after_m")},
    }


def judge_again(record: Record) -> Record:
    """Judge a record's answer as the judge is now, and ask nothing."""
    names = ("design", "stratum", "detector", "seed")
    case = build(Spec(**{name: record[name] for name in names}, causes=tuple(record["causes"])))
    said = judged(case, record["answer"]) if "answer" in record else {}
    if "answer" in record.get("means", {}):
        answer = record["means"]["answer"]
        said["means"] = {"answer": answer, **judged(case, answer)}
    return {**record, **facts(case), **said}


def facts(case: Case) -> Record:
    """What is true of a case."""
    visible = strengths(case)
    return {
        **asdict(case.spec),
        "sizes": case.spec.sizes,
        "measured_by": case.made.detector,
        "rows": len(case.made.table),
        "visible": {id_: {**asdict(v), "snr": v.snr} for id_, v in visible.items()},
        "marginal": any(v.strength < DETECTABLE for v in visible.values()),
        "always": [id_ for id_ in case.spec.causes if accompanies(case, id_, direction(case, id_))],
    }


def judged(case: Case, answer: Mapping[str, Any]) -> Record:
    """Compare an answer with the truth."""
    named = [c for c in answer["causes"] if c.get("in_model", True) or c["kind"] != "effect"]
    judged_names = [_judged_name(case, cause) for cause in named]
    says_unknown = answer["unexplained"] is not None or answer["verdict"] == "unknown"
    wrong = [n for n in judged_names if n["status"] == "wrong" and is_sure(n)]
    return {
        "verdict": answer["verdict"],
        "named": judged_names,
        "says_unknown": says_unknown,
        "against": answer["unexplained"] and answer["unexplained"]["against"],
        "alarm": any(n["status"] == "wrong" and n["kind"] == "effect" for n in judged_names),
        "false_noise_or_fault": any(n["status"] == "wrong" and n["kind"] != "effect" for n in judged_names),
        "confident_wrong": [n["id"] for n in wrong],
        "outcome": outcome(case.spec, judged_names, says_unknown=says_unknown),
        "z": gains.scores(case, named),
        **_first(case, answer),
    }


def _judged_name(case: Case, cause: Mapping[str, Any]) -> Record:
    """A name with its status: a planted cause, a true companion, one whose rivals are true, or wrong."""
    claimed = _claimed(case, cause)
    planted = [id_ for id_ in case.spec.causes if same_class(case, id_, cause["id"])]
    others = [r for r in cause["indistinguishable_from"] if r != "unknown"]
    held = [id_ for id_ in case.spec.causes if any(same_class(case, id_, rival) for rival in others)]
    if planted:
        status = "planted"
    elif accompanies(case, cause["id"], claimed):
        status = "companion"
    elif held or any(accompanies(case, rival, claimed) for rival in others):
        status = "rival"
    else:
        status = "wrong"
    name = {key: cause[key] for key in ("id", "kind", "probability")}
    return {**name, "doubt": cause.get("doubt", ""), "status": status, "planted": planted, "held": held}


def is_sure(name: Record) -> bool:
    """Whether a name is a promise: of a cause with a doubt, the diagnosis says that it is not named."""
    return bool(name["probability"] > NAMED and not name.get("doubt"))


def _claimed(case: Case, cause: Mapping[str, Any]) -> Column | None:
    """What a named effect takes away from the readings of the base [m]."""
    parameters = {one["name"]: one["value"] for one in cause["parameters"]}
    if cause["kind"] != "effect" or any(value is None for value in parameters.values()):
        return None
    try:
        return error(case.made, echocal.Model(case.options["base"], {cause["id"]: parameters})) - error(
            case.made
        )
    except EchocalError:  # it needs a column that only the whole model can name
        return None


def outcome(spec: Spec, named: Sequence[Record], *, says_unknown: bool) -> str:
    """Put an answer into one class of `OUTCOMES`.

    ``named``: each planted cause, or one of its class, with more than 0.9 and no doubt; no such wrong name.
    ``ambiguous``: with less, or among those that the diagnosis cannot tell from one that it names.
    ``unknown``: something is there without a name. ``unsure``: wrong names, none with more than 0.9.
    ``silent``: nothing, or only what is always there, under its name or one told as its rival.
    """
    sure = {id_ for n in named if is_sure(n) for id_ in n["planted"]}
    maybe = {id_ for n in named for id_ in (*n["planted"], *n["held"])}
    wrong = any(n["status"] == "wrong" and is_sure(n) for n in named)
    truth = set(spec.causes) if spec.stratum not in ("null", "unknown") else set()
    if truth and sure == truth:
        return "named beside a wrong name" if wrong else "named"
    if wrong:
        return "wrong"
    if truth and maybe == truth:
        return "ambiguous"
    if truth and maybe:
        return "one of two"
    if says_unknown:
        return "unknown"
    return "unsure" if any(n["status"] == "wrong" for n in named) else "silent"


def _first(case: Case, answer: Mapping[str, Any]) -> Record:
    """The first set of the posterior, and whether it is true: one name a planted cause, and companions."""
    top = max(answer["posterior"], key=lambda entry: entry["probability"])
    claimed = {cause["id"]: _claimed(case, cause) for cause in answer["causes"]}
    return {
        "top": top["ids"],
        "top_probability": top["probability"],
        "strict": _is_truth(case, top["ids"], claimed),
    }


def _is_truth(case: Case, ids: Sequence[str], claimed: Mapping[str, Column | None]) -> bool:
    left = list(ids)
    if case.spec.stratum == "unknown":
        if "unknown" not in left:
            return False
        left.remove("unknown")
    else:
        for truth in case.spec.causes:
            match = next((id_ for id_ in left if same_class(case, truth, id_)), None)
            if match is None:
                return False
            left.remove(match)
    return all(id_ != "unknown" and accompanies(case, id_, claimed.get(id_)) for id_ in left)
