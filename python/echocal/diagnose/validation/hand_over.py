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
    case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack, *, doubt: bool = True
) -> tuple[Selection, Rest]:
    """Claim the causes of the best set, and drop those that the folds refute.

    If they refute all claims of a set, the next best set is tried, unless it has only causes that the data
    cannot separate from refuted ones. A set that is too improbable to be mentioned ends the search. If no set
    is left, the answer is that for the first one. A claim of a later set may enter the model, but is not
    named: a more probable set was wrong. `doubt`: see `select`.
    """
    settings = case.settings
    first: tuple[Selection, Rest] | None = None
    found: list[Refuted] = []
    for _ in range(settings.validation.sets_tried):
        if ranking.is_exhausted:
            break
        selection = _of_usual_sizes(case, ranking, shares, reduced, doubt=doubt)
        effects = selection.effects
        if first is not None and ranking.of_set(effects) < settings.claims.mentioned_from:
            break
        ranking = ranking.without(effects)
        if effects and set(effects) <= {id_ for r in found for id_ in (r.id, *r.indistinguishable_from)}:
            continue
        trials = Trials(case, selection.noise, case.rows_with_every_reading)
        rest = refute(trials, selection, trials.base())
        if rest.kept and first is not None:
            return _later(selection, rest, found)
        first = first or (selection, rest)
        if rest.kept or not rest.refuted:
            break
        found += [r for r in rest.refuted if r.id not in {other.id for other in found}]
    assert first is not None
    return first


def _of_usual_sizes(
    case: Case, ranking: Ranking, shares: NoisePosterior, reduced: Stack, *, doubt: bool
) -> Selection:
    """The best set; of sets that are as probable, one without implausible sizes."""
    settings = case.settings
    best = selection = select(case, ranking, shares, reduced, doubt=doubt)
    rest, least = ranking, settings.claims.usual_from * ranking.of_set(best.effects)
    for _ in range(settings.validation.sets_tried):
        if not selection.implausible:
            return selection
        rest = rest.without(selection.effects)
        if rest.is_exhausted:
            break
        selection = select(case, rest, shares, reduced, doubt=doubt)
        if not selection.effects or ranking.of_set(selection.effects) < least:
            break
    return best


def _later(selection: Selection, rest: Rest, refuted: Sequence[Refuted]) -> tuple[Selection, Rest]:
    """A set after the refuted ones, with a doubt about each of its claims."""
    kept = {claim.cause for claim in rest.kept}
    others = {one.id: one for one in (*refuted, *rest.refuted) if one.id not in kept}
    why = f"the rows of the folds refute a more probable set ({', '.join(sorted(r.id for r in refuted))})"
    doubts = {cause: f"{why}, so {cause} is not named" for cause in sorted(kept)}
    return replace(selection, later=doubts), replace(rest, refuted=tuple(others.values()))
