"""A judge that knows how cases are drawn: what no diagnosis of the same rows can do better.

It is told every cause that can be planted and none else, the distribution of its sizes, the shape
that it would have in this case, the kinds of noise with their scatter, and how often nothing is
there. With Bayes' theorem on that its probabilities are the right ones, and its decisions the best
that exist. An engine that must find out the noise, knows more causes and no distribution of sizes
falls short of it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from hidden_effects.aliases import SAME_DIRECTION, label
from hidden_effects.cases import Case, planted
from hidden_effects.causes import CAUSES
from hidden_effects.disturbance import SHOT
from hidden_effects.likelihood import mean_of, nothing_but_noise, single_noise, unknown_noise
from hidden_effects.menu import SHARES, fits

Column = NDArray[np.float64]
Matrix = NDArray[np.float64]

_NODES = np.geomspace(0.02, 60.0, 33)  # snr at which a cause is planted; between them it is interpolated
_COARSE, _FINE = 160, 81  # sizes at which the likelihood is looked at: everywhere, and near the best
_SNR = (0.25, 8.0)  # log-uniform, where no prior is known
_WIDTHS = (1 / 3, 1.0, 3.0)  # of the half-normal sizes, in units of the usual magnitude
_DETECTED = 0.5
_SEEN = 1e-3  # snr


@dataclass(frozen=True)
class Opinion:
    """What the judge says of a case; exact aliases are one name.

    Attributes
    ----------
    probability : dict of str to float
        Of each name; ``""`` is nothing.
    detected : bool
    named : str
        The name whose class (what these rows see in one direction) is most probable.
    """

    probability: dict[str, float]
    detected: bool
    named: str

    def credible(self, held: float = 0.95) -> list[str]:
        """The smallest set of names that holds this probability."""
        ordered = sorted(self.probability, key=lambda name: -self.probability[name])
        sums = np.cumsum([self.probability[name] for name in ordered])
        return ordered[: int(np.searchsorted(sums, held)) + 1]


@dataclass(frozen=True)
class Family:
    """One cause with one sign: its shift at some sizes."""

    id: str
    sign: float
    sizes: Column
    shifts: Matrix  # (rows, sizes)

    def at(self, sizes: Column) -> Matrix:
        """Shift [m] at other sizes, interpolated; shape (rows, sizes)."""
        where = np.clip(np.searchsorted(self.sizes, sizes) - 1, 0, len(self.sizes) - 2)
        low, high = self.sizes[where], self.sizes[where + 1]
        part = (sizes - low) / (high - low)
        return np.asarray(self.shifts[:, where] * (1 - part) + self.shifts[:, where + 1] * part)


def judge(case: Case) -> Opinion:
    """Give every cause its probability, by the shares in which single causes and nothing are drawn."""
    error = (case.table["reading_m"] - case.table["distance_m"]).to_numpy()
    families = [family for id_ in _possible(case) for family in _families(case, id_)]
    ids = sorted({family.id for family in families})
    singles = SHARES["prior"] + SHARES["wild"]
    log = {"": np.log(SHARES["null"]) + nothing_but_noise(case.rows, error)}
    best: dict[str, Column] = {}
    for id_ in ids:
        signs = [f for f in families if f.id == id_]
        parts = [_evidence(case, family, error) for family in signs]
        best[id_] = max(parts, key=lambda part: part[0])[1]
        evidence = logsumexp([part[0] for part in parts]) - np.log(len(signs))
        log[id_] = np.log(singles / len(ids)) + evidence
    total = logsumexp(list(log.values()))
    alone = {id_: float(np.exp(value - total)) for id_, value in log.items()}
    merged: dict[str, float] = {}
    for id_, p in alone.items():
        merged[label(id_) if id_ else ""] = merged.get(label(id_) if id_ else "", 0.0) + p
    return Opinion(merged, merged[""] < _DETECTED, _of_best_class(alone, best))


def detection(case: Case, strength: float, *, knows_noise: bool) -> float:
    """Logarithm of the odds that some cause of this snr sqrt(N) is there rather than noise alone.

    By the lemma of Neyman and Pearson a threshold on it finds most, at any rate of false alarms.
    Who does not know the noise reckons with the same noises, of any size, whether a cause is there
    or not.
    """
    error = (case.table["reading_m"] - case.table["distance_m"]).to_numpy()
    left = error[:, None] - np.array([np.zeros(len(error)), *_of_strength(case, strength)]).T
    if knows_noise:
        there = single_noise(case.rows, left[:, 1:], tape=False)
        nothing = nothing_but_noise(case.rows, error)
    else:
        log = unknown_noise(case.rows, left)
        nothing, there = float(log[0]), log[1:]
    return float(mean_of(list(there))) - nothing


def _of_strength(case: Case, strength: float) -> Iterator[Column]:
    """Shift by every cause that can have this snr sqrt(N), either sign."""
    snr = strength / np.sqrt(len(case.rows))
    for id_ in _possible(case):
        if CAUSES[id_].size == "fixed":
            continue
        for family in _families(case, id_):
            strengths = np.sqrt(np.mean(family.shifts**2, axis=0)) / SHOT
            if strengths[-1] >= snr:
                yield family.at(np.array([np.interp(snr, strengths, family.sizes)]))[:, 0]


def _possible(case: Case) -> list[str]:
    """Mean causes that this design can show; of recorded and unrecorded humidity the one that is."""
    recorded = "humidity_percent" in case.table
    other = "unrecorded_humidity" if recorded else "humidity"
    return [id_ for id_ in fits(case.rows.design) if id_ != other]


def _families(case: Case, id_: str) -> Iterator[Family]:
    cause = CAUSES[id_]
    if cause.size == "fixed":
        shift = planted(case.rows, {id_: 1.0}, case.spec.seed).shift()
        yield Family(id_, 1.0, np.ones(1), shift[:, None])
        return
    scale = _scale(case, id_)
    for sign in (1.0, -1.0) if cause.size == "signed" else (1.0,):
        sizes = np.unique(np.minimum(_NODES / scale, cause.most))
        shifts = [planted(case.rows, {id_: sign * size}, case.spec.seed).shift() for size in sizes]
        yield Family(id_, sign, sizes, np.array(shifts).T)


def _scale(case: Case, id_: str) -> float:
    """Signal to noise ratio per unit of size, at the smallest size that shows at all."""
    for size in np.geomspace(1e-3, 1.0, 13) * min(CAUSES[id_].most, 1.0):
        snr = float(np.sqrt(np.mean(planted(case.rows, {id_: size}, case.spec.seed).shift() ** 2))) / SHOT
        if snr > _SEEN:
            break
    return max(snr, _SEEN) / float(size)


def _evidence(case: Case, family: Family, error: Column) -> tuple[float, Column]:
    """Logarithm of the likelihood averaged over the sizes, and the shift at the best of them."""
    if len(family.sizes) == 1:
        return float(single_noise(case.rows, error[:, None] - family.shifts)[0]), family.shifts[:, 0]
    coarse = np.geomspace(family.sizes[0], family.sizes[-1], _COARSE)
    log = single_noise(case.rows, error[:, None] - family.at(coarse))
    top = int(log.argmax())
    low, high = coarse[max(top - 1, 0)], coarse[min(top + 1, _COARSE - 1)]
    fine = np.linspace(low, high, _FINE)
    log = np.concatenate([log, single_noise(case.rows, error[:, None] - family.at(fine))])
    sizes, first = np.unique(np.concatenate([coarse, fine]), return_index=True)
    log = log[first]
    density, atom = _density(family, sizes)
    step = np.gradient(sizes)
    weights = np.maximum(density * step, 1e-300)
    weights[-1] += atom
    best = family.at(sizes[[log.argmax()]])[:, 0]
    return float(logsumexp(log + np.log(weights))), best


def _density(family: Family, sizes: Column) -> tuple[Column, float]:
    """Density of the sizes that are drawn, and the part that nature's bound holds back."""
    half = [2 / (w * np.sqrt(2 * np.pi)) * np.exp(-0.5 * (sizes / w) ** 2) for w in _WIDTHS]
    strength = np.maximum(np.sqrt(np.mean(family.at(sizes) ** 2, axis=0)) / SHOT, _SEEN)
    inside = (strength >= _SNR[0]) & (strength <= _SNR[1])
    wild = np.where(inside, np.gradient(np.log(strength), sizes), 0.0) / np.log(_SNR[1] / _SNR[0])
    bound = sizes[-1] >= CAUSES[family.id].most
    rest = (
        max(0.0, np.log(_SNR[1] / max(strength[-1], _SNR[0])) / np.log(_SNR[1] / _SNR[0])) if bound else 0.0
    )
    prior, share = np.mean(half, axis=0), SHARES["prior"] / (SHARES["prior"] + SHARES["wild"])
    return share * prior + (1 - share) * np.maximum(wild, 0.0), (1 - share) * min(rest, 1.0)


def _of_best_class(alone: Mapping[str, float], best: Mapping[str, Column]) -> str:
    """The name whose direction holds most of the probability."""
    ids = list(best)
    unit = np.array([best[id_] / max(float(np.linalg.norm(best[id_])), 1e-30) for id_ in ids])
    alike = np.abs(unit @ unit.T) >= SAME_DIRECTION
    same = np.array([[label(a) == label(b) for b in ids] for a in ids])
    held = (alike | same) @ np.array([alone[id_] for id_ in ids])
    first = np.flatnonzero(held >= held.max() * 0.999)  # of a class, its most probable member
    return label(max((ids[i] for i in first), key=lambda id_: alone[id_]))
