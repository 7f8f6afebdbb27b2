"""Autocorrelated noises that are considered, and their prior probabilities."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["AUTOREGRESSIONS", "VARIANCE_FLOOR", "NoiseModelSettings"]

VARIANCE_FLOOR = 1e-9
"""Smallest standard deviation of noise that is assumed [m]; simulated data may have none."""

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

    autoregressions: tuple[tuple[float, tuple[float, ...]], ...] = threshold(
        AUTOREGRESSIONS,
        "1 per row",
        "moving-average coefficients, each with the autoregressive coefficients that are tried; the "
        "specification requires a grid; its values are chosen by hand",
    )
    station_ratios: tuple[float, ...] = threshold(
        (0.0, 0.1, 1.0, 10.0),
        "1",
        "ratio of the variance of the station errors to that of the innovations; chosen by hand",
    )
    level_ratios: tuple[float, ...] = threshold(
        (0.0, 0.1, 1.0, 10.0, 100.0, 1000.0, 10000.0),
        "1",
        "the same of errors by the levels of a column: targets may differ by centimeters; chosen by hand",
    )
    convection_rhos: tuple[float, ...] = threshold(
        (0.6, 0.8, 0.9, 0.95, 0.98),
        "1 per row",
        "autoregressive coefficients of convection: warm cells of air in the path; chosen by hand",
    )
    convection_growths: tuple[float, ...] = threshold(
        (0.1, 0.3, 1.0, 3.0),
        "1/m",
        "ratio of the variances of the autocorrelated and the white part, per meter of distance; Andreeva "
        "and Durgin 2005 give the law; the values are chosen by hand",
    )
    whole_path_rhos: tuple[float, ...] = threshold(
        (0.6, 0.8, 0.9),
        "1 per row",
        "the same of air that is alike along the whole path; argument: a thermometer follows what is "
        "slower; slower air looks like an error of scale",
    )
    whole_path_growths: tuple[float, ...] = threshold(
        (0.3, 1.0, 3.0, 10.0, 100.0),
        "1",
        "and its ratio of variances at one meter; it grows with the square of the distance; chosen by hand",
    )
    white_growths: tuple[float, ...] = threshold(
        (0.1, 0.3, 1.0, 3.0, 10.0, 100.0),
        "1",
        "the same without autocorrelation, where noise_growth is more probable than not; chosen by hand",
    )
    slow_airs: tuple[float, ...] = threshold(
        (0.1, 0.3),
        "K",
        "standard deviation of the temperature along the path less that of the thermometer, where it "
        "changes; WMO-No. 8, annex 1.A: 0.1 K are achievable at the thermometer; layers of air beside it; "
        "judgement",
    )
    slow_air_times: tuple[float, ...] = threshold(
        (600.0, 3600.0),
        "s",
        "its correlation times, each with an equal part of its variance; judgement: a heater or a cloud, a "
        "room or the sun",
    )
    usual: float = threshold(
        0.5,
        "probability",
        "prior of what is usually assumed: noise without autocorrelation, stations without errors, air along "
        "the path as at the thermometer; half for each of them",
    )
