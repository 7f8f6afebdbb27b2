"""Numbers of the validation of claims and of the gain."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["ValidationSettings"]


@dataclass(frozen=True, kw_only=True)
class ValidationSettings:
    """Numbers of the validation of claims and of the gain."""

    pieces: int = number(
        40,
        "pieces",
        "most contiguous pieces of rows, for the interval of the gain and for that of the log score",
        "chosen by hand",
    )
    memories: float = number(
        2.0,
        "times 1/(1 - autoregression) rows",
        "pieces are not shorter than this, so that neighboring ones are nearly independent; the log score is "
        "of whitened rows, whose autoregression is 0",
        "exp(-2) of the autocorrelation is left over such a length",
    )
    fewest_pieces: int = number(5, "pieces", "there are not fewer, however long the memory is", "the folds")
    resamples: int = number(2000, "draws", "resamples of these pieces", "chosen by hand")
    interval: float = number(
        0.95, "probability", "of the intervals of the gain and of the log score", "convention"
    )
    reachable: float = number(
        0.02,
        "of the mean square before",
        "if less can be removed, the fraction of it is not reported",
        "chosen by hand",
    )
    shifted_inner: tuple[float, float] = number(
        (0.2, 0.8),
        "quantiles",
        "middle range of a column: the model is fitted inside and its error is measured outside",
        "chosen by hand",
    )
    shifted_values: int = number(
        5, "distinct values", "a column with fewer has no middle range", "chosen by hand"
    )
