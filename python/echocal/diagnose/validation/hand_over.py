"""From a refuted set of causes to the next one of the posterior."""

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

    If they refute all claims of a set, the next best set is tried. A set that is too improbable to be
    mentioned ends the search. If no set is left, the answer is that for the first one.
    """
    settings = case.settings
    first: tuple[Selection, Rest] | None = None
    found: list[Refuted] = []
    for _ in range(settings.validation.sets_tried):
        selection = select(case, ranking, shares, reduced)
        trials = Trials(case, selection.noise)
        rest = refute(trials, selection, trials.base())
        found += [r for r in rest.refuted if r.id not in {other.id for other in found}]
        first = first or (selection, rest)
        if rest.kept:
            kept = {claim.cause for claim in rest.kept}
            return selection, replace(rest, refuted=tuple(r for r in found if r.id not in kept))
        if not rest.refuted:
            break
        ranking = ranking.without(selection.best.hypothesis.effects)
        following = ranking.best()
        if following is None or ranking.of_set(following.hypothesis.effects) < settings.claims.mentioned_from:
            break
    assert first is not None
    return first
