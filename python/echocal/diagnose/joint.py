"""One posterior over mean causes, noises and faults together."""

from collections.abc import Iterable
from dataclasses import dataclass

from echocal.diagnose.claims import Ranking, posterior_sets
from echocal.diagnose.faults.finding import Finding
from echocal.diagnose.result import Cause

__all__ = ["Joint", "join"]

_LEAST = 1e-6  # probability of a set worth a line
_MATTERS = 0.05  # part of the variance of the noise from which on a noise is a verdict
_SEEN = 0.5  # probability from which on a cause is reported

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
            Cause(f.cause, f.facts.kind, f.probability, f.parameters, (), f.because, in_model=False)
            for f in self.findings
        )

    @property
    def telling(self) -> tuple[Finding, ...]:
        """Findings that a verdict counts: not what every table is guarded against anyhow."""
        return tuple(f for f in self.findings if f.facts.id not in GUARDS and f.share > _MATTERS)


GUARDS = frozenset({"correlated_noise", "reference_error"})
"""Noise that every hypothesis reckons with: reported, but no verdict of its own."""


def join(ranking: Ranking, found: Iterable[Finding]) -> Joint:
    """Cross the posterior over mean causes with the faults and noises that were looked for.

    A fault is decided on other features of the table than the means are (values that repeat, rows
    far off, lattices), so that the probabilities multiply.
    """
    sets = posterior_sets(ranking)
    found = tuple(found)
    for finding in found:
        sets = _crossed(sets, finding.cause, finding.probability)
    total = sum(sets.values())
    ordered = sorted(((ids, p / total) for ids, p in sets.items()), key=lambda item: -item[1])
    return Joint(dict(ordered), tuple(f for f in found if f.probability >= _SEEN))


def _crossed(sets: Sets, cause: str, probability: float) -> Sets:
    crossed: Sets = {}
    for ids, p in sets.items():
        for named, part in ((ids, 1 - probability), (tuple(sorted({*ids, cause})), probability)):
            if p * part >= _LEAST:
                crossed[named] = crossed.get(named, 0.0) + p * part
    return crossed
