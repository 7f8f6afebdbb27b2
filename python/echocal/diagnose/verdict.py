"""The verdict, in one of four words, and the smallest credible set."""

from echocal.diagnose.findings.parts import Verdict
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.selection.joint import Joint
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.refute import Validation

__all__ = ["credible_set", "verdict"]


def verdict(ranking: Ranking, selection: Selection, validation: Validation, joint: Joint) -> Verdict:
    """What is to be said first.

    A noise or a fault of rows is no answer where something shifts the readings and no cause of that
    is claimed, or none that has one size: then it is listed, and the shift is left open. Where something
    shifts the readings, the verdict is not `nothing` either, even if held-out rows refute every cause.
    """
    named = ranking.settings.claims.named
    steady = [c.probability for c in validation.kept if c.cause not in selection.varying]
    if any(probability >= named for probability in steady):
        return "named"
    shifted = not validation.kept and _shifted(ranking)
    is_open = len(steady) < len(validation.kept) or shifted
    if not is_open and any(f.probability >= named for f in joint.decisive):
        return "named"
    if selection.remainder is not None:
        return "unknown"
    return "ambiguous" if is_open or validation.kept or joint.decisive else "nothing"


def _shifted(ranking: Ranking) -> bool:
    """Whether the rows that were fitted leave no doubt that something shifts the readings."""
    return sum(p for ids, p in ranking.sets if not ids) < 1 - ranking.settings.claims.named


def credible_set(joint: Joint) -> tuple[tuple[str, ...], ...]:
    """The most probable sets of causes, as few as hold the probability of the credible set."""
    total, chosen = 0.0, []
    for ids, p in joint.sets.items():
        chosen.append(ids)
        total += p
        if total >= joint.settings.claims.credible:
            break
    return tuple(chosen)
