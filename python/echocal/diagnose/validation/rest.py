"""Claims with what they are fitted in, and their errors on rows that judge them."""

from dataclasses import dataclass

from echocal.diagnose.inference.hypothesis import Hypothesis
from echocal.diagnose.selection.claims import Claim
from echocal.diagnose.validation.gain import HeldOut

__all__ = ["Rest"]


@dataclass(frozen=True)
class Rest:
    """The claims that are kept so far.

    Attributes
    ----------
    hypothesis : Hypothesis
        What they are fitted in.
    kept : tuple of Claim
    after : HeldOut
        Errors of the model that has them.
    """

    hypothesis: Hypothesis
    kept: tuple[Claim, ...]
    after: HeldOut
