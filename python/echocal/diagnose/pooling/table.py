"""What one table says about sets of causes that all tables may share.

docs/method/several-tables.md, Eq. 35 and 36.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypotheses
from echocal.diagnose.inference.visible import INVISIBLE
from echocal.diagnose.pipeline import Examined
from echocal.diagnose.pooling.hierarchy import log_mixture
from echocal.diagnose.pooling.shared_forms import SharedForm, keys
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.selection.decision import threshold_of
from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.priors import WIDEST

__all__ = ["TableInference"]

_SHARE = 0.01  # of a set's evidence, below which a hypothesis does not move its sizes
_MOST = 12  # hypotheses that move the sizes of a set
_BESIDE = 3  # best hypotheses of the table that stand beside a set which its search had dropped

Array = NDArray[np.floating[Any]]
Natural = tuple[float, Array, Array]


@dataclass
class TableInference:
    """The inference of one table, without its columns.

    Attributes
    ----------
    variants : list of Variant
        Forms that compete.
    skipped : mapping of str to str
        Causes that do not compete, with the reasons.
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.
    fits : list of HypothesisFit
        Hypotheses, most probable first.
    threshold : float
        Probability of no effect below which an effect is claimed.
    known : dict
        Likelihoods that were computed before.
    """

    name: str
    diagnosis: Diagnosis
    table: Table
    base: Base
    variants: list[Variant]
    skipped: Mapping[str, str]
    reduced: Stack
    fits: list[HypothesisFit]
    threshold: float
    settings: Settings
    known: dict[tuple[SharedForm, ...], Natural] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, name: str, examined: Examined, diagnosis: Diagnosis) -> "TableInference":
        """Keep what a pool needs."""
        case, settings = examined.case, examined.case.settings
        return cls(
            name,
            diagnosis,
            case.table,
            case.base,
            case.found.variants,
            case.found.skipped,
            examined.reduced,
            examined.shares.fits,
            threshold_of(settings.claims.few_rows, examined.ranking, examined.shares),
            settings,
        )

    @cached_property
    def competing(self) -> frozenset[str]:
        """Causes that compete."""
        return frozenset(v.cause for v in self.variants) - {UNKNOWN}

    @cached_property
    def _keys(self) -> dict[int, tuple[object, ...]]:
        return keys(self.variants)

    @cached_property
    def total(self) -> float:
        """Log evidence of the table, all its hypotheses averaged."""
        return float(np.logaddexp.reduce([fit.log_posterior for fit in self.fits]))

    def can_have(self, cause: str) -> bool:
        """Whether the table has the columns for a cause, even if none of its sizes would show there."""
        return cause in self.competing or self.skipped.get(cause) == INVISIBLE

    def of_forms(self, form: SharedForm) -> list[Variant]:
        """Forms of this table that are a shared form."""
        return [v for v in self.variants if v.cause == form.cause and self._keys[id(v)] == form.key]

    def shared(
        self, forms: Sequence[SharedForm], hypothesis: Hypothesis
    ) -> Iterator[tuple[SharedForm, slice, Array]]:
        """Forms whose sizes a hypothesis of this table has: the places, and the unit of a shared size."""
        by_cause = {form.cause: form for form in forms if form.names}
        for variant, place in hypothesis.placed:
            if (form := by_cause.get(variant.cause)) is not None:
                count = len(form.names)
                unit = np.array(form.scales) / np.array(variant.scales)
                yield form, slice(place.start, place.start + count), unit

    @cached_property
    def _by_form(self) -> dict[tuple[str, tuple[object, ...]], set[int]]:
        """Positions of the hypotheses that have a shared form."""
        found: dict[tuple[str, tuple[object, ...]], set[int]] = {}
        for place, fit in enumerate(self.fits):
            for v in fit.hypothesis.variants:
                if v.cause != UNKNOWN:
                    found.setdefault((v.cause, self._keys[id(v)]), set()).add(place)
        return found

    def with_forms(self, forms: Sequence[SharedForm]) -> list[HypothesisFit]:
        """Hypotheses that have these forms, whatever else they have, most probable first."""
        places = [self._by_form.get((form.cause, form.key), set()) for form in forms]
        found = [self.fits[place] for place in sorted(set.intersection(*places))]
        return found or self._beside_the_best(forms)

    def _beside_the_best(self, forms: Sequence[SharedForm]) -> list[HypothesisFit]:
        """Fit a set that the search dropped, alone and beside the best hypotheses."""
        some = {fit.hypothesis.effects: fit for fit in reversed(self.fits)}
        best = sorted(some.values(), key=lambda fit: -fit.log_posterior)[:_BESIDE]
        best += [fit for fit in [some.get(())] if fit is not None and fit not in best]
        own = list(product(*(self.of_forms(form) for form in forms)))
        hypotheses, raises = [], []
        again = fit_hypotheses([fit.hypothesis for fit in best], self.reduced)
        for fit, plain in zip(best, again, strict=True):
            for chosen in own:
                hypotheses.append(self._joined(fit.hypothesis, chosen))
                raises.append(fit.log_evidence - plain.log_evidence)
        made = fit_hypotheses(hypotheses, self.reduced)
        raised = [fit.raised(by) for fit, by in zip(made, raises, strict=True)]
        distinct = {tuple(map(id, fit.hypothesis.variants)): fit for fit in raised}
        return sorted(distinct.values(), key=lambda fit: -fit.log_posterior)

    def _joined(self, hypothesis: Hypothesis, chosen: Sequence[Variant]) -> Hypothesis:
        """A hypothesis with further causes, and its prior."""
        causes = {v.cause for v in chosen}
        rest = tuple(v for v in hypothesis.variants if v.cause not in causes)
        priors, competing = self.settings.priors, len(self.competing)
        before = len(hypothesis.effects)
        after = len([v for v in rest if v.cause != UNKNOWN]) + len(chosen)
        log = priors.log_of_set(after, competing) - priors.log_of_set(before, competing)
        weight = np.prod([v.weight for v in chosen])
        weight /= np.prod([v.weight for v in hypothesis.variants if v.cause in causes])
        return Hypothesis((*chosen, *rest), hypothesis.prior * float(np.exp(log) * weight))

    def likelihood(self, forms: tuple[SharedForm, ...]) -> Natural:
        """Log likelihood of the sizes of these forms, given that they act in this table.

        The other causes, their sizes and the noise are averaged over. Causes that do not compete here
        must not be among `forms`.

        Returns
        -------
        log, information, precision
            In the units of the forms.
        """
        if forms not in self.known:
            none = self.total, np.zeros(0), np.zeros((0, 0))
            self.known[forms] = self._likelihood(forms) if forms else none
        return self.known[forms]

    def _likelihood(self, forms: tuple[SharedForm, ...]) -> Natural:
        fits = self.with_forms(forms)
        logs = np.array([fit.log_posterior for fit in fits])
        total = float(np.logaddexp.reduce(logs))
        given = self.settings.priors.log_of_presence(len(forms), len(self.competing))
        given += sum(np.log(form.weight) for form in forms)
        counts = [len(form.names) for form in forms]
        if not sum(counts):
            return total - given, np.zeros(0), np.zeros((0, 0))
        some = [fit for fit, log in zip(fits, logs, strict=True) if log - total > np.log(_SHARE)]
        some = some[:_MOST] or fits[:1]
        mean, covariance = self._wide(some, forms)
        information, precision = _divided(mean, covariance)
        own = self._own_bounds(forms)
        log = total - given - log_mixture(information, precision, counts, own)
        unit = np.array([s for form in forms for s in form.scales]) / self._scales(forms)
        return log, information * unit, precision * unit[:, None] * unit

    def _scales(self, forms: Sequence[SharedForm]) -> Array:
        """Prior standard deviations that this table uses."""
        return np.array([s for form in forms if form.names for s in self.of_forms(form)[0].scales])

    def _own_bounds(self, forms: Sequence[SharedForm]) -> list[tuple[float, float]]:
        each = ((form, self.of_forms(form)[0]) for form in forms if form.names)
        return [bound for form, variant in each for bound in variant.bounds[: len(form.names)]]

    def _wide(self, fits: Sequence[HypothesisFit], forms: Sequence[SharedForm]) -> tuple[Array, Array]:
        """Moments of the sizes with the widest prior and without bounds, over some hypotheses."""
        named = {form.cause: len(form.names) for form in forms if form.names}
        free = [_unbounded(fit.hypothesis, named) for fit in fits]
        wide = fit_hypotheses(free, self.reduced, one_width=True)
        log = np.array([fit.log_posterior for fit in fits])
        weight = np.exp(log - np.logaddexp.reduce(log))
        means, covariances = [], []
        for fit in wide:
            placed: Mapping[str, slice] = {v.cause: place for v, place in fit.hypothesis.placed}
            at = [placed[cause].start + i for cause, count in named.items() for i in range(count)]
            means.append(fit.mean[at])
            covariances.append(fit.covariance[np.ix_(at, at)])
        mean = weight @ np.array(means)
        apart = np.array(means) - mean
        covariance = np.einsum("h,hij->ij", weight, np.array(covariances))
        return mean, covariance + np.einsum("h,hi,hj->ij", weight, apart, apart)


def _unbounded(hypothesis: Hypothesis, causes: Mapping[str, int]) -> Hypothesis:
    free = (-np.inf, np.inf)
    variants = tuple(
        replace(v, bounds=(free,) * len(v.bounds)) if v.cause in causes else v for v in hypothesis.variants
    )
    return Hypothesis(variants, hypothesis.prior)


def _divided(mean: Array, covariance: Array) -> tuple[Array, Array]:
    """A posterior less its prior, the widest one: the likelihood. What the data do not show stays flat."""
    precision = np.linalg.inv(covariance)
    values, vectors = np.linalg.eigh(0.5 * (precision + precision.T) - np.eye(len(mean)) / WIDEST**2)
    shown = values > 0.0
    information = vectors @ np.where(shown, vectors.T @ (precision @ mean), 0.0)
    return information, (vectors * np.where(shown, values, 0.0)) @ vectors.T
