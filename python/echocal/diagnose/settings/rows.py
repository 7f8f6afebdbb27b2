"""Numbers of the preprocessing of rows."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["RowSettings"]


@dataclass(frozen=True, kw_only=True)
class RowSettings:
    """Numbers of the preprocessing; see `echocal.diagnose.settings.table` for what each is."""

    fewest: int = threshold(
        8,
        "rows",
        "fewest usable rows, fitted rows, held-out rows, and rows of a station with a usual reading; by hand",
    )
    wild: float = threshold(
        0.5,
        "probability",
        "that a table has wild rows, which no noise explains; parts of the rows from 1e-4 to 0.1, and "
        "deviations, have any order of magnitude; measured: of 40 rows 10 sd off, 33 are told among 150 "
        "rows of normal noise, 2 among those of Student's t with 4 degrees",
    )
    far: float = threshold(
        20.0, "robust sd", "a smaller deviation may be physical, and the row is kept; chosen by hand"
    )
    far_relative: float = threshold(
        0.02, "of the reading", "a smaller deviation may be physical, and the row is kept; chosen by hand"
    )
    far_least: float = threshold(
        0.018, "m", "with a smaller deviation, a row is kept; argument: four cycles of 25 us are 17.2 mm"
    )
    exceptions: int = threshold(
        5,
        "rows",
        "most rows that are left out because they deviate differently from all neighbors; chosen by hand",
    )
    half_window: int = threshold(
        6, "rows", "rows on each side of a row whose median is the level; chosen by hand"
    )
    off_station: float = threshold(
        10.0,
        "robust sd",
        "a row farther from the median of its station is another echo, also under noise with heavy tails; "
        "chosen by hand",
    )
    as_a_whole: float = threshold(
        0.5,
        "of the rows",
        "if a larger part of a station, or of the last rows, is far, this is a step; more probable than not",
    )
    rows_per_station: int = threshold(
        3,
        "rows",
        "with fewer rows per station on average, all rows count as one station; argument: an error per "
        "station is then the same as noise of single rows",
    )
    per_kelvin: float = threshold(
        0.002,
        "1/K",
        "relative change of an uncompensated reading with the temperature of the air; 0.6/343 = 0.00175 per "
        "K, rounded up",
    )
    air_anyhow: float = threshold(
        0.005, "1", "relative change of the reading by other changes of the air; chosen by hand"
    )
    gap: float = threshold(5.0, "usual intervals", "a longer pause begins a new series; chosen by hand")
    level_step: float = threshold(
        7.0, "robust sd", "a larger jump of an unknown level begins a new segment; chosen by hand"
    )
    level_step_of_no_air: float = threshold(
        4.5, "robust sd", "the same, if the air cannot cause the jump; chosen by hand"
    )
    step_height: float = threshold(
        0.1,
        "m",
        "prior standard deviation of a step of an unknown level; chosen by hand: a post that is knocked "
        "moves by millimeters, a target that is changed by decimeters; ten times more costs a step 2.3 log "
        "odds",
    )
    one_more_step: float = threshold(
        0.5,
        "probability",
        "that the level has one step more, for each number of steps; the places of so many steps are "
        "equally probable; chosen by hand: the place, ln n, costs far more",
    )
    step_beyond_air: float = threshold(
        0.05,
        "of the reading",
        "a larger step is not weighed beside causes; argument: it is 30 K between two neighboring rows, at "
        "0.0018 per K",
    )
    folds: int = threshold(5, "folds", "parts of the rows in a cross-validation; convention")
