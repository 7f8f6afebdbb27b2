"""The gain on tables left out: the others choose the shared causes and their sizes."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from echocal.diagnose.findings.parts import Gain, Ladder
from echocal.diagnose.pooling.choice import choose
from echocal.diagnose.pooling.models import shared_model
from echocal.diagnose.pooling.search import Pool, SharedSet
from echocal.diagnose.validation.gain import HeldOut, errors, summarize
from echocal.errors import DomainWarning
from echocal.model import ResidualUncertainty

__all__ = ["SCHEME", "Transfer", "transfer"]

SCHEME = "tables left out in turn; the others choose the causes and their sizes"


@dataclass(frozen=True)
class Transfer:
    """What the model of all other tables does for one table.

    Attributes
    ----------
    causes : tuple of str
        That the others choose.
    rms_before_m, rms_after_m : float
        Error of the base and of that model [m].
    """

    causes: tuple[str, ...]
    rows: int
    rms_before_m: float
    rms_after_m: float


def transfer(
    pool: Pool, sets: Sequence[SharedSet], causes: Sequence[str], seed: int
) -> tuple[Gain, tuple[Transfer, ...], ResidualUncertainty | None]:
    """Leave each table out once, and judge the model of the others on it.

    The residual uncertainty is that of the shared causes on these tables, or of the base where their error
    is larger.
    """
    before, after, distance, unit, each = [], [], [], [], []
    for place, table in enumerate(pool.tables):
        chosen = choose(pool, sets, without=place).best
        others = [other for other in range(len(pool.tables)) if other != place]
        rows = table.table.rows
        every = np.ones(len(rows), dtype=bool)
        with warnings.catch_warnings(action="ignore", category=DomainWarning):
            model = shared_model(pool, chosen, {}, others, table)
            base, extended = (errors(rows, one, every) for one in (table.base.model(), model))
        known = np.isfinite(base) & np.isfinite(extended)
        before.append(base[known])
        after.append(extended[known])
        distance.append(rows.distance(table.base.model())[known])
        unit.append(table.table.unit[known] + sum(len(t.table) for t in pool.tables[:place]))
        ids = tuple(model.effects.keys() - table.base.effects.keys())
        each.append(Transfer(ids, int(known.sum()), HeldOut(base[known]).rms, HeldOut(extended[known]).rms))
    one, other = (HeldOut(np.concatenate(parts)) for parts in (before, after))
    rho = max(table.diagnosis.noise["autoregression"] for table in pool.tables)
    ladder: Ladder = (((), one.rms), *([(tuple(causes), other.rms)] if causes else []))
    gain = summarize(None, ladder, one, other, _floor(pool), SCHEME, np.concatenate(unit), rho, seed)
    left = (other if causes and not other.rms > one.rms else one).error
    return gain, tuple(each), ResidualUncertainty.measured(left, np.concatenate(distance), 0.0, SCHEME)


def _floor(pool: Pool) -> float:
    """Floor of all rows, from the floors of the tables."""
    gains = [(t.diagnosis.gain, len(t.table.rows)) for t in pool.tables]
    known = [(gain.rms_floor_m**2, rows) for gain, rows in gains if gain is not None]
    total = sum(rows for _, rows in known)
    return float(np.sqrt(sum(square * rows for square, rows in known) / max(total, 1)))
