"""One posterior over mean causes, noises and faults together."""

from collections.abc import Iterable
from dataclasses import dataclass

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Cause
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.noises.common.settings import NoiseSettings
from echocal.diagnose.selection.claims import Ranking, posterior_sets

__all__ = ["NAMED", "Joint", "join"]

_LEAST = 1e-6  # probability of a set worth a line
_SEEN = 0.5  # probability from which on a cause is reported
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
    matters : float
        Part of the noise's variance from which on a verdict counts a noise.
    """

    sets: Sets
    findings: tuple[Finding, ...]
    matters: float = NoiseSettings.matters

    @property
    def causes(self) -> tuple[Cause, ...]:
        """The findings as a diagnosis lists them; no model of the mean has them."""
        return tuple(
            Cause(f.cause, f.facts.kind, f.probability, f.parameters, f.rivals, f.because, in_model=False)
            for f in self.findings
        )

    @property
    def telling(self) -> tuple[Finding, ...]:
        """Findings that a verdict counts."""
        listed_only = registry.listed_only()
        return tuple(f for f in self.findings if f.share > self.matters and f.cause not in listed_only)


def join(
    ranking: Ranking,
    found: Iterable[Finding],
    shares: NoisePosterior,
    carried: Stack,
    settings: NoiseSettings | None = None,
) -> Joint:
    """Cross the posterior over mean causes with the noises beside each, and with the faults.

    A fault is decided on other features of the table than the means are (values that repeat, rows
    far off, lattices), so that the probabilities multiply.
    """
    settings = settings or NoiseSettings()
    sets: Sets = {}
    for ids, p in posterior_sets(ranking).items():
        shapes = shares.fitted_of(ids)
        split = {ids: p * max(1 - sum(shapes.values()), 0.0)}
        split |= {tuple(sorted((*ids, shape))): p * part for shape, part in shapes.items()}
        split = {named: part for named, part in split.items() if part >= _LEAST}
        for guard, probability in shares.nuisance_of(ids).items():
            is_open = settings.split < probability < 1 - settings.split
            split = _crossed(split, guard, probability if is_open else round(probability))
        for named, part in split.items():
            sets[named] = sets.get(named, 0.0) + part
    found = tuple(found)
    for finding in found:
        sets = _crossed(sets, finding.cause, finding.probability)
    total = sum(sets.values())
    ordered = sorted(((ids, p / total) for ids, p in sets.items()), key=lambda item: -item[1])
    seen = [f for f in found if f.probability >= _SEEN]
    noises = noise_findings(dict(ordered), shares, carried, _SEEN)
    return Joint(dict(ordered), (*seen, *noises), settings.matters)


def _crossed(sets: Sets, cause: str, probability: float) -> Sets:
    crossed: Sets = {}
    for ids, p in sets.items():
        for named, part in ((ids, 1 - probability), (tuple(sorted({*ids, cause})), probability)):
            if p * part >= _LEAST:
                crossed[named] = crossed.get(named, 0.0) + p * part
    return crossed
