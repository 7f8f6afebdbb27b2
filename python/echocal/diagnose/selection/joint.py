"""One posterior over mean causes, noises and faults together."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from echocal.diagnose.candidates.effects import UNKNOWN
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Cause, Parameter
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.noises.weighing import GUARDS as GUARD_MODULES
from echocal.diagnose.noises.weighing import SHAPES, Guard, NoiseShares
from echocal.diagnose.selection.claims import Ranking, posterior_sets

__all__ = ["NAMED", "Joint", "join"]

_LEAST = 1e-6  # probability of a set worth a line
_MATTERS = 0.05  # part of the variance of the noise from which on a noise is a verdict
_OPEN = 0.2  # probability below which a guard is not split off: every hypothesis reckons with it anyhow
_SEEN = 0.5  # probability from which on a cause is reported
_TURNS = 20  # memories in a table, below which what remembers is no different from a slow shape
_NO_MEMORY = (
    "; something unknown that changes with the rows would look the same: measure some of them again, in "
    "another order"
)
NAMED = 0.9
"""Probability of one class from which on it is named."""

Sets = dict[tuple[str, ...], float]


@dataclass(frozen=True)
class Joint:
    """The posterior with every kind of cause in it.

    Attributes
    ----------
    sets : dict
        Probability of each set of ids, most probable first; sums to one.
    findings : tuple of Finding
        Faults and noises that are more probable than not.
    """

    sets: Sets
    findings: tuple[Finding, ...]

    @property
    def causes(self) -> tuple[Cause, ...]:
        """The findings as a diagnosis lists them; no model of the mean has them."""
        return tuple(
            Cause(f.cause, f.facts.kind, f.probability, f.parameters, f.rivals, f.because, in_model=False)
            for f in self.findings
        )

    @property
    def telling(self) -> tuple[Finding, ...]:
        """Findings that a verdict counts; noise that remembers is no error of the readings."""
        return tuple(f for f in self.findings if f.share > _MATTERS and f.facts.id != "correlated_noise")


def join(ranking: Ranking, found: Iterable[Finding], shares: NoiseShares, carried: Stack) -> Joint:
    """Cross the posterior over mean causes with the noises beside each, and with the faults.

    A fault is decided on other features of the table than the means are (values that repeat, rows
    far off, lattices), so that the probabilities multiply.
    """
    sets: Sets = {}
    for ids, p in posterior_sets(ranking).items():
        shapes = shares.shape_of(ids)
        split = {ids: p * max(1 - sum(shapes.values()), 0.0)}
        split |= {tuple(sorted((*ids, shape))): p * part for shape, part in shapes.items()}
        split = {named: part for named, part in split.items() if part >= _LEAST}
        for guard, probability in shares.guard_of(ids).items():
            is_open = _OPEN < probability < 1 - _OPEN
            split = _crossed(split, guard, probability if is_open else round(probability))
        for named, part in split.items():
            sets[named] = sets.get(named, 0.0) + part
    found = tuple(found)
    for finding in found:
        sets = _crossed(sets, finding.cause, finding.probability)
    total = sum(sets.values())
    ordered = sorted(((ids, p / total) for ids, p in sets.items()), key=lambda item: -item[1])
    seen = [f for f in found if f.probability >= _SEEN]
    return Joint(dict(ordered), (*seen, *_noises(dict(ordered), shares, carried)))


def _noises(sets: Sets, shares: NoiseShares, carried: Stack) -> list[Finding]:
    """Findings on the noises that are more probable than not."""
    findings = []
    modules = {module.FACTS.id: module for module in GUARD_MODULES}
    for facts in (*(shape.FACTS for shape in SHAPES), *(module.FACTS for module in GUARD_MODULES)):
        probability = sum(p for ids, p in sets.items() if facts.id in ids)
        if probability < _SEEN:
            continue
        fitted = shares.fit_of(facts.id)
        values = fitted.parameters if fitted else _guard_parameters(modules[facts.id], shares, carried)
        units = {quantity.name: quantity.unit for quantity in facts.parameters}
        parameters = tuple(Parameter(name, v, u, units[name]) for name, (v, u) in values.items())
        odds = np.log(probability) - np.log(max(1 - probability, 1e-15))
        log_bayes = float(odds - np.log(facts.prior) + np.log1p(-facts.prior))
        because = fitted.told if fitted else _guard_story(facts.id, values)
        share = float(fitted is None or fitted.matters)
        rivals = _like_a_shape(values, carried) if facts.id == "correlated_noise" else ()
        if rivals:
            because += _NO_MEMORY
        findings.append(Finding(facts, log_bayes, because, parameters, share=share, rivals=rivals))
    return findings


def _like_a_shape(memory: dict[str, tuple[float, float]], carried: Stack) -> tuple[str, ...]:
    """Noise that remembers long is a function of the row like any other."""
    rows = 1 / (1 - memory["autoregression"][0])
    return (UNKNOWN,) if _TURNS * rows > carried.degrees else ()


def _guard_parameters(module: Guard, shares: NoiseShares, carried: Stack) -> dict[str, tuple[float, float]]:
    top = shares.weighed[0]
    return module.parameters(carried.noises, top.noise, top.variance)


def _guard_story(id_: str, values: dict[str, tuple[float, float]]) -> str:
    if id_ == "correlated_noise":
        follows = f"with a coefficient of {values['autoregression'][0]:.2f} (autocorrelation in row order)"
        if "growth" in values:
            return f"what the causes leave follows the rows before {follows}, the more the farther the target"
        return f"what the causes leave follows the row before {follows}"
    return (
        f"the means of the stands scatter by {1e3 * values['standard_deviation'][0]:.2f} mm beyond what "
        "their rows explain"
    )


def _crossed(sets: Sets, cause: str, probability: float) -> Sets:
    crossed: Sets = {}
    for ids, p in sets.items():
        for named, part in ((ids, 1 - probability), (tuple(sorted({*ids, cause})), probability)):
            if p * part >= _LEAST:
                crossed[named] = crossed.get(named, 0.0) + p * part
    return crossed
