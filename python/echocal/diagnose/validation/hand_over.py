"""From a refuted set of causes to the next one of the posterior."""

from collections.abc import Sequence
from dataclasses import replace

from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.selection.select import Selection, select
from echocal.diagnose.validation.refute import Rest, refute
from echocal.diagnose.validation.trials import Trials

__all__ = ["select_and_refute"]


def select_and_refute(
    case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack
) -> tuple[Selection, Rest]:
    """Claim the causes of the best set, and drop those that the folds refute.

    If they refute all claims of a set, the next best set is tried, unless it has only causes that the data
    cannot separate from refuted ones. A set that is too improbable to be mentioned ends the search. If no set
    is left, the answer is that for the first one.
    """
    settings = case.settings
    first: tuple[Selection, Rest] | None = None
    found: list[Refuted] = []
    for _ in range(settings.validation.sets_tried):
        if ranking.is_exhausted:
            break
        selection = select(case, ranking, shares, reduced)
        effects = selection.best.hypothesis.effects
        if first is not None and ranking.of_set(effects) < settings.claims.mentioned_from:
            break
        ranking = ranking.without(effects)
        if effects and set(effects) <= {id_ for r in found for id_ in (r.id, *r.indistinguishable_from)}:
            continue
        trials = Trials(case, selection.noise, case.table_with_every_row)
        rest = refute(trials, selection, trials.base())
        if rest.kept and first is not None:
            return selection, _with(found, rest)
        first = first or (selection, rest)
        if rest.kept or not rest.refuted:
            break
        found += [r for r in rest.refuted if r.id not in {other.id for other in found}]
    assert first is not None
    return first


def _with(found: Sequence[Refuted], rest: Rest) -> Rest:
    """The claims of a later set, with the refuted ones of the sets before."""
    kept = {claim.cause for claim in rest.kept}
    others = {one.id: one for one in (*found, *rest.refuted) if one.id not in kept}
    return replace(rest, refuted=tuple(others.values()))
