"""The choice of causes on some blocks of a table, from the inference to the claims."""

from collections.abc import Collection

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.posterior import infer
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.posterior import infer_noises
from echocal.diagnose.selection.claims import rank
from echocal.diagnose.selection.select import Selection, select

__all__ = ["chosen"]

_UNLISTED = 1e-3  # probability that the least probable hypotheses share, which a fold leaves out


def chosen(case: Case, tried: Collection[FittedNoise]) -> Selection:
    """Choose causes as `echocal.diagnose.pipeline.run` does, on the blocks that the case may see.

    The columns and the sums are those of the whole table: where a step or an edge may lie, and the
    segments of an unknown level, are not searched again.

    Parameters
    ----------
    case : Case
    tried : collection of FittedNoise
        Noises that compete.
    """
    inference = infer(case, _UNLISTED)
    shares = infer_noises(case, inference.fits, inference.reduced, tried)
    ranking = rank(shares.fits, case.found.competing, case.settings)
    return select(case, ranking, shares, inference.reduced)
