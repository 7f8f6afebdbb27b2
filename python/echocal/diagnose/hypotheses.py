"""Which hypotheses compete, and how probable each is before the data."""

from itertools import combinations, product
from math import comb, prod

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates import UNKNOWN, Candidates, Variant
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh

__all__ = ["PRIOR", "posterior", "preferred"]

PRIOR = {"nothing": 0.4, "one": 0.43, "two": 0.15, "three": 0.02, UNKNOWN: 0.15}
"""Probability of no to three causes; and, independently, of a shape without a cause."""

_EXTENDED = 4  # most probable pairs that a third cause is added to
_NEGLIGIBLE = 1e-3  # probability of a noise below which it is not carried along
_UNDECIDED = 1.5  # log odds between two forms of a cause below which neither is better
_BESIDE_UNKNOWN = 8  # most probable hypotheses that are also tried beside an unknown shape


def posterior(found: Candidates, stack: Stack) -> tuple[list[Weighed], Stack]:
    """Weigh no cause, each cause, each pair, and the best of these beside each unknown shape.

    Returns
    -------
    list of Weighed
        Most probable first.
    Stack
        The noises that were carried along.
    """
    causes: dict[str, list[Variant]] = {}
    shapes = []
    for variant in found.variants:
        if variant.cause == UNKNOWN:
            shapes.append(variant)
        else:
            causes.setdefault(variant.cause, []).append(variant)
    explained = (1 - PRIOR[UNKNOWN]) if shapes else 1.0
    noises = _plausible(causes, shapes, stack)
    stack = stack.only(noises)
    known = [weigh(h, stack) for h in _catalogue(causes, explained)]
    known.sort(key=lambda w: -w.log_posterior)
    known += [weigh(h, stack) for h in _triples(causes, known, explained)]
    known.sort(key=lambda w: -w.log_posterior)
    beside = [
        Hypothesis(
            (*w.hypothesis.variants, shape), w.hypothesis.prior * PRIOR[UNKNOWN] / explained / len(shapes)
        )
        for w in _distinct(known)
        for shape in shapes
    ]
    known += [weigh(h, stack) for h in beside]
    return sorted(known, key=lambda w: -w.log_posterior), stack


def _plausible(causes: dict[str, list[Variant]], shapes: list[Variant], stack: Stack) -> NDArray[np.bool_]:
    """Noises worth carrying along: those that some simple or some very free hypothesis allows.

    The free ones have every cause at once, beside one shape: what they leave is noise if anything is.
    """
    every = tuple(max(variants, key=lambda v: len(v.free)) for variants in causes.values())
    free = tuple(v for v in every if v.offset is None)
    fixed = [v for variants in causes.values() for v in variants if v.offset is not None]
    simple = [(), *((v,) for variants in causes.values() for v in variants)]
    rich = [(*free, *some) for some in [(), *((v,) for v in fixed)]]
    shares = [weigh(Hypothesis(variants, 1.0), stack, one_size=True).noise for variants in (*simple, *rich)]
    shares += [weigh(Hypothesis((*free, v), 1.0), stack, one_size=True).noise for v in shapes]
    return np.asarray(np.max(shares, axis=0) > _NEGLIGIBLE)


def _catalogue(causes: dict[str, list[Variant]], share: float) -> list[Hypothesis]:
    """Nothing, every cause, every pair."""
    hypotheses = [Hypothesis((), share * PRIOR["nothing"])]
    for size, name in ((1, "one"), (2, "two")):
        sets = list(combinations(causes.values(), size))
        hypotheses += [
            _hypothesis(variants, share * PRIOR[name] / len(sets))
            for chosen in sets
            for variants in product(*chosen)
        ]
    return hypotheses


def _triples(causes: dict[str, list[Variant]], known: list[Weighed], share: float) -> list[Hypothesis]:
    """The best pairs, each with every third cause."""
    pairs = [w.hypothesis.causes for w in _distinct(known) if len(w.hypothesis.variants) == 2]
    sets = {frozenset((*pair, third)) for pair in pairs[:_EXTENDED] for third in causes if third not in pair}
    prior = share * PRIOR["three"] / comb(len(causes), 3) if len(causes) > 2 else 0.0
    chosen = [[causes[cause] for cause in causes if cause in named] for named in sets]
    return [_hypothesis(variants, prior) for three in chosen for variants in product(*three)]


def _hypothesis(variants: tuple[Variant, ...], prior: float) -> Hypothesis:
    return Hypothesis(variants, prior * prod(v.weight for v in variants))


def _distinct(known: list[Weighed]) -> list[Weighed]:
    """The best hypotheses that name different causes, the null always among them."""
    forms: dict[tuple[str, ...], list[Weighed]] = {}
    for weighed in known:
        forms.setdefault(weighed.hypothesis.causes, []).append(weighed)
    chosen = [preferred(same) for same in forms.values()]
    return chosen[:_BESIDE_UNKNOWN] + [w for w in chosen[_BESIDE_UNKNOWN:] if not w.hypothesis.variants]


def preferred(same: list[Weighed]) -> Weighed:
    """Of forms of the same causes, most probable first: the best, or a freer one that is as good.

    Where the data do not say which value is right, its uncertainty says so.
    """
    near = [w for w in same if w.log_posterior > same[0].log_posterior - _UNDECIDED]
    return max(near, key=lambda w: len(w.mean))
