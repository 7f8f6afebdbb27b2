"""Position of a row in its burst, 0 for the first."""

from echocal.quantities.facts import QuantityFacts

FACTS = QuantityFacts(
    id="position_in_group",
    words="position in group",
    example=0.0,
    why_no_codes="a function of one echo does not know its place in a burst",
)
