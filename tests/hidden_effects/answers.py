"""Ask the public interface about a case, and write down what it said beside the truth."""

import time
import warnings
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from typing import Any

import numpy as np

import echocal
from hidden_effects.aliases import labels, same_class
from hidden_effects.cases import Case, Spec, again, build

NAMED = 0.9
"""Probability above which a name is a promise."""

_BELIEVED = 0.5  # probability from which on a cause is counted as named at all
_NOISY = {
    "autoregressive": (("correlated_noise",),),
    # convection remembers, and it grows with the distance
    "convection": (("correlated_noise",), ("noise_growth",), ("correlated_noise", "noise_growth")),
}
_REGISTRIES = ("effects", "noises", "noise_causes", "row_faults", "gross_faults")

Record = dict[str, Any]


def known() -> frozenset[str]:
    """Ids that the engine has: of its registry of effects and, where public, of the others."""
    functions = [getattr(echocal, name) for name in _REGISTRIES if hasattr(echocal, name)]
    return frozenset(entry.id for function in functions for entry in function())


def ask(spec: Spec) -> Record:
    """Diagnose one case; an error of the engine is an answer too."""
    case = build(spec)
    start = time.perf_counter()
    with warnings.catch_warnings(action="ignore"):
        try:
            diagnosis = echocal.diagnose(case.table)
            gains = _gains(case, diagnosis.model)
        except Exception as error:  # whatever it is, a user would see it
            said: Record = {"error": f"{type(error).__name__}: {error}"}
        else:
            answer = diagnosis.to_dict()
            said = {**_judged(case, answer), **gains, "reported": _reported(answer)}
    return {
        **asdict(spec),
        "rows": len(case.rows),
        "sizes": {id_: float(size) for id_, size in case.sizes.items()},
        "snr": case.snr,
        "seconds": time.perf_counter() - start,
        **said,
    }


def _judged(case: Case, answer: dict[str, Any]) -> Record:
    posterior: dict[tuple[str, ...], float] = {}
    for entry in answer["posterior"]:
        ids = labels(entry["ids"])
        posterior[ids] = posterior.get(ids, 0.0) + entry["probability"]
    truth = acceptable(case)
    top = max(posterior, key=lambda ids: posterior[ids])
    credible = {labels(ids) for ids in answer["credible_set"]}
    named = {
        c["id"]: c["probability"]
        for c in answer["causes"]
        if c.get("in_model", True) or c["kind"] != "effect"
    }
    believed = [id_ for id_, p in named.items() if p >= _BELIEVED]
    return {
        "verdict": answer["verdict"],
        "alarm": answer["verdict"] != "nothing" and labels(named) not in truth - {()},
        "top": list(top),
        "top_probability": posterior[top],
        "truth_probability": sum(posterior.get(ids, 0.0) for ids in truth),
        "no_effect_probability": sum(p for ids, p in posterior.items() if not _mean_causes() & set(ids)),
        "strict": top in truth,
        "class": _class_right(case, top),
        **_told(case, answer["causes"], named),
        "covered": bool(credible & truth),
        "credible_sets": len(credible),  # exact aliases count as one
        "named": named,
        "refuted": [refuted["id"] for refuted in answer.get("refuted", [])],
        "says_unknown": answer["unexplained"] is not None or answer["verdict"] == "unknown",
        "confident_wrong": _wrong(case, answer["causes"]),
        "sure_counts": _counts(case, [id_ for id_, p in named.items() if p > NAMED], exact=False),
        "strict_counts": _counts(case, believed, exact=True),
        "class_counts": _counts(case, believed, exact=False),
    }


def _told(case: Case, causes: list[dict[str, Any]], named: Mapping[str, float]) -> Record:
    """Whether the one cause told, or one that it says it cannot be told from, is the planted one.

    `told` is None where no effect is in the model, or where all that is told is a tape that does err;
    `class_told` holds the names.
    """
    true_noise = {"reference_error"} - set(case.spec.causes) if case.spec.tape else set()
    heads = [c for c in causes if c["id"] in named and c["id"] not in true_noise]
    if not case.spec.causes or not heads:
        return {"told": None, "class_told": []}
    said = [id_ for c in heads for id_ in (c["id"], *c["indistinguishable_from"])]
    truth = case.spec.causes[0]
    right = len(heads) == 1 and any(same_class(case, truth, id_) for id_ in said)
    return {"told": right, "class_told": labels(said)}


def acceptable(case: Case) -> set[tuple[str, ...]]:
    """Sets of causes that are true of a case; of noise that is not white, its own name too."""
    outside = [id_ for id_ in case.spec.causes if id_ not in _catalogue()]
    if outside:
        return {("unknown",)}
    names = labels(case.spec.causes)
    extra = _NOISY.get(case.spec.noise, ())
    extra = (("reference_error",),) if case.spec.tape else extra
    return {names} | {labels([*case.spec.causes, *also]) for also in extra}


@cache
def _mean_causes() -> frozenset[str]:
    return frozenset((*(name for effect in echocal.effects() for name in labels([effect.id])), "unknown"))


def _catalogue() -> frozenset[str]:
    from hidden_effects.causes import CAUSES

    return frozenset(CAUSES)


def _class_right(case: Case, top: tuple[str, ...]) -> bool:
    """Whether each planted cause is answered by one of its class, and nothing is left over."""
    if top in acceptable(case):
        return True
    if len(top) != len(labels(case.spec.causes)) or "unknown" in top:
        return False
    hits, said, planted = _counts(case, top, exact=False)
    return hits == said == planted


def _wrong(case: Case, causes: list[dict[str, Any]]) -> list[tuple[str, float]]:
    """Names given with more than 0.9 that neither are the truth nor hold it among their rivals."""
    wrong = []
    for cause in causes:
        said = {cause["id"], *cause["indistinguishable_from"]}
        right = any(labels([id_]) in acceptable(case) for id_ in said) or any(
            same_class(case, truth, id_) for truth in case.spec.causes for id_ in said
        )
        allowed = {id_ for ids in acceptable(case) for id_ in ids}
        if cause["probability"] > NAMED and not right and cause["id"] not in allowed:
            wrong.append((cause["id"], cause["probability"]))
    return wrong


def _counts(case: Case, said: Any, *, exact: bool) -> tuple[int, int, int]:
    """Hits, names said and causes planted; every name may hit one cause."""
    left = list(labels(said) if exact else said)
    planted = list(labels(case.spec.causes))
    total, hits = len(left), 0
    for id_ in planted:
        match = next(
            (x for x in left if x == id_ or (not exact and same_class(case, _raw(case, id_), x))), None
        )
        if match is not None:
            left.remove(match)
            hits += 1
    return hits, total, len(planted)


def _raw(case: Case, name: str) -> str:
    """The planted id behind the name of its exact class."""
    return next(id_ for id_ in case.spec.causes if labels([id_]) == (name,))


def _reported(answer: Mapping[str, Any]) -> list[float] | None:
    """Root mean squares [m] of the base and the model on held-out rows, as the diagnosis tells them."""
    gain = answer["gain"]
    return None if gain is None else [gain["rms_before_m"], gain["rms_after_m"]]


def _gains(case: Case, model: echocal.Model) -> Record:
    """Mean squares [m^2] before and after correction of noise-free rows, same and other conditions."""
    gains: Record = {}
    for where in ("same", "shifted"):
        campaign = again(case, where)
        if not case.spec.causes or campaign is None:
            continue
        table, reference = campaign
        seen = echocal.read_observations(table, reading_speed="linear")
        reading = table["reading_m"].to_numpy()
        used = model if where == "same" else model.transferable()
        corrected = used.correct(reading, **seen.conditions)
        before = float(np.mean((reading - reference) ** 2))
        gains[where] = [before, float(np.mean((np.asarray(corrected) - reference) ** 2))]
    return gains
