"""What brings the fitted size of a cause and its theoretical size together."""

from dataclasses import replace

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack
from echocal.diagnose.selection.claims import free_sizes, without
from echocal.quantities import BY_COLUMN

__all__ = ["reconciled"]

_MOVED = 0.5  # standard uncertainties that an unexplained term must move the size by, to be listed
_NAMED = 3  # columns listed in one sentence

_WHY = {column: facts.suspect for column, facts in BY_COLUMN.items() if facts.suspect}
_WHY["hour of day"] = "an effect of the time of day, such as a lagging thermometer"
"""What an unexplained term against a column would mean."""


def reconciled(
    case: Case, cause: str, beside: Hypothesis, stack: Stack, known: float, size: float, uncertainty: float
) -> str:
    """Say what brings the two sizes together: autocorrelated noise, or a column.

    The size is fitted again beside an unexplained term against each recorded column. Columns whose
    term moves the size toward theory are listed.
    """
    said = ""
    if abs(size - known) <= (agrees := case.settings.claims.agrees) * uncertainty:
        said = (
            ". The rows are not independent (slow air, slow instruments). With autocorrelated noise, the "
            f"size is within {agrees:g} standard uncertainties of theory"
        )
    moved = []
    named = without(beside, UNKNOWN)
    terms = list(case.found.terms.values())
    with_term = [replace(named, variants=(*named.variants, term)) for term in terms]
    (size, uncertainty), *fits = free_sizes(cause, case.found, [named, *with_term], stack)
    for variant, (there, error) in zip(terms, fits, strict=True):
        closer = abs(size - known) - abs(there - known)
        if closer > _MOVED * uncertainty:
            moved.append((closer, variant.against, there, error))
    moved.sort(reverse=True)
    texts = [
        f"{against.replace('_', ' ')} ({there:.2f} +/- {error:.2f}{_meaning(against)})"
        for _, against, there, error in moved[:_NAMED]
    ]
    if texts:
        said += f". It is closer to theory if fitted beside a smooth function of {' or of '.join(texts)}"
    elif not said:
        said = ". No recorded column brings it closer to theory"
    return said


def _meaning(against: str) -> str:
    return f": {_WHY[against]}" if against in _WHY else ""
