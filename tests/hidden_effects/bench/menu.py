"""Which tables of the bench a run draws."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from echocal.virtual_bench import CAUSES, DESIGNS, simulate
from echocal.virtual_bench.campaign.campaign import Random
from echocal.virtual_bench.campaign.designs import lay_down
from echocal.virtual_bench.campaign.simulate import offers
from hidden_effects.aliases import label
from hidden_effects.bench.truth import FAULTS, MISTAKES, NOISES, UNFORESEEN
from hidden_effects.bench.world import Spec

SHARES = {
    ("null", "ideal"): 0.14,
    ("null", "comparator"): 0.08,
    ("single", "ideal"): 0.24,
    ("single", "comparator"): 0.22,
    ("pair", "ideal"): 0.06,
    ("pair", "comparator"): 0.06,
    ("unknown", "ideal"): 0.04,
    ("unknown", "comparator"): 0.04,
    ("mistake", "ideal"): 0.06,
    ("mistake", "comparator"): 0.06,
}
"""Part of the tables of a design that each stratum takes, by detector. The sum is 1."""


@cache
def has(design: str, seed: int) -> frozenset[str]:
    """What the campaign of a seed offers: three shelves may be as good as one."""
    return offers(lay_down(design, Random(seed)))


@cache
def fits(design: str) -> tuple[str, ...]:
    """Causes that a design can show, if not with every seed."""
    offered = frozenset().union(*(has(design, seed) for seed in range(20)))
    return tuple(sorted(id_ for id_, cause in CAUSES.items() if cause.needs <= offered))


@cache
def forces(id_: str) -> bool:
    """Whether a cause acts on the comparator, and brings it with it."""
    design = next(design for design in DESIGNS if id_ in fits(design))
    seed = _seed(design, (id_,), np.random.default_rng(0))
    return simulate(design, {id_: CAUSES[id_].high}, seed=seed, detector="ideal").detector == "comparator"


def _seed(design: str, ids: tuple[str, ...], random: np.random.Generator) -> int:
    """A seed whose campaign offers what the causes need."""
    needed = frozenset().union(*(CAUSES[id_].needs for id_ in ids))
    while True:
        seed = int(random.integers(2**62))
        if needed <= has(design, seed):
            return seed


def choices(design: str, stratum: str, detector: str) -> list[tuple[str, ...]]:
    """Sets of causes that a stratum draws from; what brings a comparator is measured by one."""
    here = [id_ for id_ in fits(design) if detector == "comparator" or not forces(id_)]
    singles = [id_ for id_ in here if id_ not in MISTAKES | UNFORESEEN]
    if stratum == "null":
        return [()]
    if stratum == "pair":
        means = [id_ for id_ in singles if id_ not in NOISES | FAULTS]
        return [(a, b) for i, a in enumerate(means) for b in means[i + 1 :] if label(a) != label(b)]
    among = {"single": singles, "unknown": UNFORESEEN, "mistake": MISTAKES}[stratum]
    return [(id_,) for id_ in here if id_ in among]


def menu(designs: Sequence[str], count: int, seed: int) -> list[Spec]:
    """Draw about `count` specs over all designs and strata; every cause in turn, in an order of chance."""
    specs: list[Spec] = []
    for design in designs:
        random = np.random.default_rng([seed, *design.encode()])
        for (stratum, detector), share in SHARES.items():
            some = choices(design, stratum, detector)
            order = random.permutation(len(some))
            for i in range(max(1, round(share * count / len(designs))) if some else 0):
                ids = some[int(order[i % len(order)])]
                specs.append(Spec(design, stratum, ids, detector, _seed(design, ids, random)))
    return specs
