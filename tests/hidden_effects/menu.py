"""Which cases a run draws."""

from collections.abc import Collection
from itertools import cycle

import numpy as np

from hidden_effects.cases import Spec
from hidden_effects.causes import CAUSES
from hidden_effects.designs import DESIGNS
from hidden_effects.unknown import UNKNOWN

SHARES = {
    "null": 0.24,
    "prior": 0.18,
    "wild": 0.18,
    "power5": 0.08,
    "power8": 0.06,
    "pair": 0.12,
    "unknown": 0.14,
}
"""Part of the cases of a design that each stratum takes."""

NULLS = ("normal", "student_t4", "autoregressive", "convection", "tape")


def fits(design: str, kinds: Collection[str] = ("mean",)) -> list[str]:
    """Causes that a design can show."""
    offers = DESIGNS[design](np.random.default_rng(0)).offers
    return [id_ for id_, cause in CAUSES.items() if cause.needs <= offers and cause.kind in kinds]


def menu(designs: Collection[str], count: int, engine: Collection[str], seed: int) -> list[Spec]:
    """Draw `count` specs a design over all strata, and every cause that the engine lacks once."""
    specs = []
    for design in designs:
        random = np.random.default_rng([seed, *design.encode()])
        known = [id_ for id_ in fits(design) if id_ in engine]
        for stratum, share in SHARES.items():
            specs += draw(design, stratum, max(1, round(share * count)), known, random)
        lacking = [id_ for id_ in fits(design, ("mean", "noise", "row", "gross")) if id_ not in engine]
        specs += draw(design, "missing", len(lacking), lacking, random)
        noises = [id_ for id_ in fits(design, ("noise", "row", "gross")) if id_ in engine]
        specs += draw(design, "other", 3 * len(noises), noises, random)
    return specs


def draw(
    design: str, stratum: str, count: int, causes: Collection[str], random: np.random.Generator
) -> list[Spec]:
    """Specs of one stratum: every cause in turn, in an order of chance."""
    choices = {
        "null": [()],
        "unknown": [(id_,) for id_, (_, where) in UNKNOWN.items() if design in where],
        "pair": [
            (a, b) for i, a in enumerate(sorted(causes)) for b in sorted(causes)[i + 1 :] if _apart(a, b)
        ],
    }.get(stratum) or [
        (id_,) for id_ in sorted(causes) if stratum[:5] != "power" or CAUSES[id_].size != "fixed"
    ]
    order = random.permutation(len(choices))
    nulls = [n for n in NULLS if design != "a" or n not in ("convection", "tape")]
    kinds = cycle(nulls[int(random.integers(len(nulls))) :] + nulls)
    specs = []
    for i in range(count if choices else 0):
        noise, tape = ("student_t4" if random.random() < 0.3 else "normal"), 0.0
        if stratum == "null":
            noise = next(kinds)
            noise, tape = ("normal", 1e-3) if noise == "tape" else (noise, 0.0)
        elif stratum in ("prior", "wild") and design == "b" and random.random() < 0.3:
            tape = 0.5e-3
        ids = choices[int(order[i % len(order)])]
        specs.append(Spec(design, stratum, ids, noise, tape, int(random.integers(2**62))))
    return specs


def _apart(one: str, other: str) -> bool:
    """Causes that can act together: not two laws for the same thing, not one recorded and not."""
    exclusive = (
        {"humidity", "unrecorded_humidity", "pressure"},
        {"fixed_speed", "double_correction", "pressure_sqrt_law"},
    )
    return not any(one in group and other in group for group in exclusive)
