"""The round trip not halved, or halved twice."""

import numpy as np

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.ratio import factor_of
from echocal.diagnose.faults.common.repair import divided
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings

__all__ = ["FAULT"]

FACTS = CauseFacts(
    id="round_trip_factor",
    kind="gross",
    sentence="The way out and back was not halved, or halved twice.",
    signature="reading / reference = 2 or 1/2 in every row",
    source="UncleRus/esp-idf-lib #699: a compensated reading of 0.2327 m for 0.1162 m",
    parameters=(Quantity("factor", "1", "reading over what it should be"),),
    check="measure one distance with a ruler: twice the reading means the way out and back",
    prior=0.01,
    formula="reading' = factor * reading, factor = 2 or 1/2, in every row",
    needs=("reference_distance",),
    repair="divides readings and echo times by the factor",
)


def detect(view: View, _: object, settings: FaultSettings) -> Found | None:
    """Compare the median ratio of reading and reference with 2 and 1/2."""
    found = factor_of(
        view, (2.0, 0.5, 2.54, 1 / 2.54), settings.factor
    )  # an inch is near enough to be a rival
    if found is None or found.value not in (2.0, 0.5):
        return None
    because = (
        f"readings are {found.ratio:.3f} times the reference distance (median of all rows); the rest of the "
        f"diagnosis divides them by {found.value:g}"
    )
    every = np.ones(len(view), dtype=bool)
    repaired = divided(view, every, FACTS.id, found.value)
    return Found(every, found.log_bayes, because, (found.value,), repaired)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Forget to halve the way out and back, or halve it twice."""
    table["reading_m"] = float(random.choice([2.0, 0.5])) * table["reading_m"]


FAULT = Fault(FACTS, detect, spoil)
