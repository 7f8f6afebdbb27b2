"""The verdict, one of four words, and the credible set."""

from collections.abc import Iterable

from echocal.diagnose.findings.parts import Remainder, Verdict
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.selection.joint import Joint
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.validate import Validation

__all__ = ["credible_set", "verdict"]


def verdict(
    ranking: Ranking,
    selection: Selection,
    validation: Validation,
    joint: Joint,
    left: Remainder | None = None,
    *,
    moving: bool = False,
) -> Verdict:
    """Choose the verdict.

    A noise or a fault alone makes the verdict ``named`` only if no shift of the readings is open. A
    shift is open if it is more probable than the threshold of ``named`` and no claim is kept, if a kept
    claim is in doubt, or if claims were dropped because their model is not, or not certainly, better than
    the base on rows that its choice has not seen. An open shift is never
    ``nothing``, even if every claim is refuted. Neither is an error that recorded columns, or rows that take
    turns, can lower: `left` says so. Where the target is `moving`, no noise is a name for that.
    """
    named = ranking.settings.claims.named
    doubts = validation.doubts
    if any(claim.probability >= named and claim.cause not in doubts for claim in validation.kept):
        return "named"
    if moving or (left is not None and left.turns):
        return "unknown"
    shifted = not validation.kept and _shifted(ranking, selection)
    is_open = bool(doubts or validation.refuted or shifted)
    if not is_open and any(f.probability >= named for f in joint.decisive):
        return "named"
    if selection.term is not None:
        return "unknown"
    if is_open or validation.kept or joint.decisive:
        return "ambiguous"
    return "nothing" if left is None or left.by_chance else "unknown"


def _shifted(ranking: Ranking, selection: Selection) -> bool:
    """Whether an effect, or an unexplained term, has a probability above that of ``named`` (0.9).

    In few rows it must have it under each single autoregression, too.
    """
    nothing = sum(p for ids, p in ranking.sets if not ids)
    if selection.slow is not None:
        nothing = max(nothing, selection.slow.nothing)
    return nothing < 1 - ranking.settings.claims.named


def credible_set(sets: Iterable[tuple[Ids, float]], least: float) -> tuple[Ids, ...]:
    """The fewest sets of causes, most probable first, that together have a probability of at least this."""
    total, chosen = 0.0, []
    for ids, p in sets:
        chosen.append(ids)
        total += p
        if total >= least:
            break
    return tuple(chosen)
