"""Which autocorrelated noises are considered, and how probable each is before the data."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["AUTOREGRESSIONS", "NoiseModelSettings"]

AUTOREGRESSIONS = (
    (0.0, (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98)),
    (0.5, (0.7, 0.85, 0.95, 0.99)),
    (0.8, (0.9, 0.95, 0.98, 0.995)),
    (0.9, (0.95, 0.98, 0.995)),
)
"""Moving-average coefficient, and the autoregressive coefficients that are tried with it."""


@dataclass(frozen=True, kw_only=True)
class NoiseModelSettings:
    """Grids and priors of the noise models."""

    autoregressions: tuple[tuple[float, tuple[float, ...]], ...] = number(
        AUTOREGRESSIONS,
        "1 per row",
        "moving-average coefficient, and autoregressive coefficients with it",
        "the grid is the specification's; its values are chosen by hand",
    )
    station_ratios: tuple[float, ...] = number(
        (0.0, 0.1, 1.0, 10.0),
        "1",
        "variance of a station's error over that of the innovations",
        "chosen by hand",
    )
    convection_rhos: tuple[float, ...] = number(
        (0.6, 0.8, 0.9, 0.95, 0.98),
        "1 per row",
        "autoregressive coefficients of warm cells in the path",
        "chosen by hand",
    )
    convection_growths: tuple[float, ...] = number(
        (0.1, 0.3, 1.0, 3.0),
        "1/m",
        "variance of the autocorrelated part over that of the white part, per distance",
        "Andreeva and Durgin 2005 give the law; the values are chosen by hand",
    )
    white: float = number(
        0.5, "probability", "rows whose noise is not autocorrelated", "half on the usual assumption"
    )
    no_station_error: float = number(0.5, "probability", "stations without an error of their own", "the same")
    distance_spread: float = number(
        0.1,
        "of the mean distance",
        "distances that differ by less do not show noise that grows with them",
        "chosen by hand",
    )
    long_table: int = number(
        20_000,
        "rows",
        "in a longer table the noises that cannot be there are found first",
        "cost; tests/test_diagnose_memories.py holds the probabilities",
    )
    pruning: float = number(
        300.0,
        "log likelihood",
        "a noise that far behind, beside all columns at once, is not tried",
        "argument: few columns cannot make up for more; the same test",
    )
    ridge_width: float = number(
        3.0,
        "prior sd",
        "width of the prior when all columns are fitted at once",
        "the widest of the prior widths",
    )
