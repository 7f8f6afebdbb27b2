"""One posterior over effects on the mean, noises and faults together."""

from collections.abc import Iterable
from dataclasses import dataclass

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Cause
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import LISTED, Ranking, posterior_sets
from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["Joint", "join"]

Sets = dict[tuple[str, ...], float]


@dataclass(frozen=True)
class Joint:
    """The posterior over causes of every kind.

    Attributes
    ----------
    sets : dict
        Probability of each set of ids, most probable first; sums to one.
    findings : tuple of Finding
        Faults and noises that are more probable than not.
    settings : Settings
    """

    sets: Sets
    findings: tuple[Finding, ...]
    settings: Settings

    @property
    def causes(self) -> tuple[Cause, ...]:
        """The findings as a diagnosis lists them; the model does not include them."""
        return tuple(
            Cause(f.cause, f.facts.kind, f.probability, f.parameters, f.rivals, f.because, in_model=False)
            for f in self.findings
        )

    @property
    def decisive(self) -> tuple[Finding, ...]:
        """Findings that count for the verdict."""
        listed_only, least = registry.listed_only(), self.settings.noises.matters
        return tuple(f for f in self.findings if f.share > least and f.cause not in listed_only)


def join(
    ranking: Ranking,
    found: Iterable[Finding],
    shares: NoisePosterior,
    reduced: Stack,
) -> Joint:
    """Combine the posterior over effects with the noises beside each set, and with the faults.

    docs/method.md, Eq. 30. Faults are found from other features of the table than effects are (repeated
    values, outliers, quantization grids), so the probabilities multiply.
    """
    never, least = ranking.settings.noises.split, LISTED
    sets: Sets = {}
    for ids, p in posterior_sets(ranking).items():
        fitted = shares.fitted_of(ids)
        split = {ids: p * max(1 - sum(fitted.values()), 0.0)}
        split |= {tuple(sorted((*ids, noise))): p * part for noise, part in fitted.items()}
        split = {named: part for named, part in split.items() if part >= least}
        for nuisance, probability in shares.nuisance_of(ids).items():
            is_open = never < probability < 1 - never
            split = _crossed(split, nuisance, probability if is_open else round(probability), least)
        for named, part in split.items():
            sets[named] = sets.get(named, 0.0) + part
    found = tuple(found)
    for finding in found:
        sets = _crossed(sets, finding.cause, finding.probability, least)
    total = sum(sets.values())
    ordered = sorted(((ids, p / total) for ids, p in sets.items()), key=lambda item: -item[1])
    seen = [f for f in found if f.probability >= PROBABLE]
    noises = noise_findings(dict(ordered), shares, reduced, PROBABLE, {f.cause for f in found})
    return Joint(dict(ordered), (*seen, *noises), ranking.settings)


def _crossed(sets: Sets, cause: str, probability: float, least: float) -> Sets:
    crossed: Sets = {}
    for ids, p in sets.items():
        for named, part in ((ids, 1 - probability), (tuple(sorted({*ids, cause})), probability)):
            if p * part >= least:
                crossed[named] = crossed.get(named, 0.0) + p * part
    return crossed
