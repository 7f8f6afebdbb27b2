"""A few rows that scatter far more than the others: under normal noise, a cause may only follow them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.noise import VARIANCE_FLOOR
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.noises.common.posterior import NoisePosterior, Traced, sampled
from echocal.diagnose.noises.common.without import without
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.threshold import PROBABLE
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["Scattered", "without_scattered_rows"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_ROUNDS = 2  # the second one beside the causes that are probable after the first
_STEPS = 50  # of the EM algorithm
_SAME = 0.1  # of the usual scatter: with smaller changes, a second comparison would be the first one
_START = 0.05, 5.0  # part of the rows that scatter more, and how much more


@dataclass(frozen=True)
class Scattered:
    """Noise of two kinds of rows, both normal with a mean of zero: docs/method/noises.md, Eq. 18d.

    Attributes
    ----------
    part : float
        Of the rows that scatter more.
    usual, wide : float
        Standard deviations of both kinds [m].
    log : float
        Log likelihood, up to a constant of the rows.
    gain : float
        The same over that of one normal distribution, less what the two parameters cost.
    """

    part: float
    usual: float
    wide: float
    log: float
    gain: float

    @classmethod
    def of(cls, left: Column, least: float = VARIANCE_FLOOR) -> "Scattered | None":
        """Fit by expectation and maximization (doi:10.1111/j.2517-6161.1977.tb01600.x).

        `least` is the standard deviation that every row has, as that of its rounding [m]. None if both kinds
        become one.
        """
        square = left**2
        usual, whole = MAD_TO_SD**2 * float(np.median(square)), float(square.mean())
        usual = max(usual, least**2)
        if not usual < whole:
            return None
        part, wide = _START[0], max(_START[1] ** 2 * usual, whole)
        for _ in range(_STEPS):
            share = _share(square, part, usual, wide)
            part = float(share.mean())
            if not 0.0 < part < 1.0:
                return None
            usual = max(float(((1.0 - share) * square).sum() / (1.0 - share).sum()), least**2)
            wide = float((share * square).sum() / share.sum())
        logs = [np.log(p) - 0.5 * (square / v + np.log(v)) for p, v in ((1 - part, usual), (part, wide))]
        log = float(np.logaddexp(*logs).sum())
        gain = log - _log_of_one_kind(left) - float(np.log(len(square)))
        return cls(part, usual**0.5, wide**0.5, log, gain)

    def beyond(self, left: Column) -> Column:
        """Expected error of each row beyond the usual scatter [m]."""
        share = _share(left**2, self.part, self.usual**2, self.wide**2)
        return np.asarray(share * (1.0 - (self.usual / self.wide) ** 2) * left)

    def counts(self, settings: NoiseSettings) -> bool:
        """Whether these are few rows, far more scattered, and no chance."""
        apart = self.wide > settings.scattered_apart * self.usual
        return apart and self.part < settings.scattered_part and self.gain > settings.scattered_gain


def _log_of_one_kind(left: Column) -> float:
    """Log likelihood of one normal distribution, up to the same constant."""
    return -0.5 * len(left) * (1.0 + float(np.log(max(float(np.mean(left**2)), VARIANCE_FLOOR**2))))


def _share(square: Column, part: float, usual: float, wide: float) -> Column:
    """Probability that each row is of the kind that scatters more."""
    log = np.log(part / (1.0 - part)) - 0.5 * np.log(wide / usual) + 0.5 * square * (1 / usual - 1 / wide)
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(log, -700.0, 700.0))))


def without_scattered_rows(
    case: Case, inference: Inference, shares: NoisePosterior
) -> tuple[Case, Inference] | None:
    """Subtract what few rows scatter beyond the others from the residuals: docs/method/noises.md, Eq. 18d.

    Such rows are exceptions from what the best hypothesis leaves, or from what the least one leaves: under
    normal noise, a cause may be the best one only because it follows them.

    None if there are no such rows, or if a noise with a likelihood of its own explains them.
    """
    settings = case.settings.noises
    likely = (max(one.values(), default=0.0) for one in shares.fitted.values())
    if max(likely, default=0.0) >= PROBABLE:
        return None
    fits, off, other = shares.fits, np.zeros(len(case.table)), None
    for _ in range(_ROUNDS):
        found = _exceptions(other or case, fits, inference, off, settings)
        if found is None or np.abs(found[1] - off).max() < _SAME * found[0].usual:
            break
        scattered, off = found
        other, inference = without(case, off)
        other = replace(other, remarks=(_said(scattered, len(off)),))
        fits = inference.fits
    return None if other is None else (other, inference)


def _exceptions(
    case: Case, fits: Sequence[HypothesisFit], inference: Inference, off: Column, settings: NoiseSettings
) -> tuple[Scattered, Column] | None:
    """What few rows scatter beyond the others [m], from the likelier of two hypotheses by the BIC.

    Each hypothesis competes with noise of one kind of rows, too: a cause whose column has rare large values
    leaves nothing that scatters.
    """
    rows = sampled(case.folds, settings)
    least = max(VARIANCE_FLOOR, case.table.rounding)
    simplest = min(fits, key=lambda one: len(one.hypothesis.variants))
    found: list[tuple[float, Scattered | None, HypothesisFit]] = []
    for one in {id(one): one for one in (fits[0], simplest)}.values():
        left = _left(case, one, inference, off, rows)
        cost = 0.5 * len(one.mean) * float(np.log(len(rows)))
        found.append((_log_of_one_kind(left) - cost, None, one))
        if _peaked(left, settings.worth) and (fit := Scattered.of(left, least)) is not None:
            found.append((fit.log - cost, fit, one))
    _, best, one = max(found, key=lambda each: each[0])
    if best is None or not best.counts(settings):
        return None
    return best, best.beyond(_left(case, one, inference, off, np.arange(len(case.table))))


def _left(case: Case, one: HypothesisFit, inference: Inference, off: Column, rows: Labels) -> Column:
    """What a hypothesis leaves of some units, with what was subtracted from them [m]."""
    noise, first = inference.reduced.likeliest(one)[0], np.unique(case.table.unit, return_index=True)[1]
    return Traced.of(case, first[rows]).left_of_units(one, noise) + off[rows]


def _peaked(left: Column, worth: float) -> bool:
    """Whether the fourth moment is so many standard errors above that of normal noise."""
    square = left**2
    return (
        float(np.mean(square**2))
        > (3.0 + worth * float(np.sqrt(24.0 / len(left)))) * float(square.mean()) ** 2
    )


def _said(found: Scattered, rows: int) -> str:
    count, wide, usual = max(round(found.part * rows), 1), 1e3 * found.wide, 1e3 * found.usual
    return (
        f"about {count} of {rows} rows scatter far more than the others (standard deviations: {wide:.1f} mm "
        f"and {usual:.2f} mm). They count little in the choice of causes. The errors of the base and of the "
        "model include them"
    )
