"""What could make a size that the data give and one that theory fixes both true."""

from dataclasses import replace

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack
from echocal.diagnose.selection.claims import free_sizes, without
from echocal.quantities import BY_COLUMN

__all__ = ["reconciled"]

_MOVED = 0.5  # standard uncertainties that a shape must move the size to be worth a word
_NAMED = 3  # columns named in one sentence

_WHY = {column: facts.suspect for column, facts in BY_COLUMN.items() if facts.suspect}
_WHY["hour of day"] = "something of the day's course, such as a lagging thermometer"
"""What a smooth remainder against a column would mean, in the words of a bench."""


def reconciled(
    case: Case, cause: str, beside: Hypothesis, stack: Stack, known: float, size: float, uncertainty: float
) -> str:
    """Say what brings a free size and theory's together: noise that remembers, or a column.

    The size is fitted again beside a smooth shape against each recorded column: a column whose
    shape moves it toward theory is a suspect.
    """
    said = ""
    if abs(size - known) <= (agrees := case.settings.claims.agrees) * uncertainty:
        said = (
            "; the rows are not independent (slow air, slow instruments), and with that reckoned the size is "
            f"within {agrees:g} standard uncertainties of theory's"
        )
    moved = []
    named = without(beside, UNKNOWN)
    shapes = list(case.found.terms.values())
    shaped = [replace(named, variants=(*named.variants, variant)) for variant in shapes]
    (size, uncertainty), *fits = free_sizes(cause, case.found, [named, *shaped], stack)
    for variant, (there, error) in zip(shapes, fits, strict=True):
        closer = abs(size - known) - abs(there - known)
        if closer > _MOVED * uncertainty:
            moved.append((closer, variant.against, there, error))
    moved.sort(reverse=True)
    texts = [
        f"{against.replace('_', ' ')} ({there:.2f} +/- {error:.2f}{_meaning(against)})"
        for _, against, there, error in moved[:_NAMED]
    ]
    if texts:
        said += f"; it comes closer to theory beside a smooth function of {' or of '.join(texts)}"
    elif not said:
        said = "; no recorded column brings it closer"
    return said


def _meaning(against: str) -> str:
    return f": {_WHY[against]}" if against in _WHY else ""
