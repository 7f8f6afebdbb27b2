"""Which rows are used, and how they belong together."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["RowSettings"]


@dataclass(frozen=True, kw_only=True)
class RowSettings:
    """Numbers of the preprocessing; see `echocal.diagnose.settings.table` for what each is."""

    fewest: int = number(
        8, "rows", "fewer usable rows, or rows to fit or to judge by, are refused", "chosen by hand"
    )
    far: float = number(20.0, "robust sd", "a row farther from its expectation is left out", "chosen by hand")
    far_relative: float = number(
        0.02, "of the reading", "below it a deviation may be physics, and the row stays", "chosen by hand"
    )
    far_least: float = number(
        0.018, "m", "no deviation below it leaves a row out", "argument: four cycles of 25 us are 17.2 mm"
    )
    exceptions: int = number(
        5,
        "rows",
        "so many rows that deviate as none of their neighbors does may be left out",
        "chosen by hand",
    )
    half_window: int = number(6, "rows", "rows on each side that tell a level", "chosen by hand")
    off_station: float = number(
        10.0,
        "robust sd",
        "a row farther from what its station mostly reads is another echo",
        "chosen by hand",
    )
    station_tells: int = number(8, "rows", "a station of fewer rows has no usual reading", "chosen by hand")
    as_a_whole: float = number(
        0.5,
        "of the rows",
        "where more of a station, or of the last rows, is far, it is a step",
        "more probable than not",
    )
    rows_per_station: int = number(
        3,
        "rows",
        "with fewer rows a station on average, an error per station is noise like any other",
        "argument",
    )
    per_kelvin: float = number(
        0.002,
        "1/K",
        "part of the reading that the air changes by where nobody compensates",
        "0.6/343 = 0.00175 per K",
    )
    air_anyhow: float = number(
        0.005, "1", "part of the reading that other changes of the air make", "chosen by hand"
    )
    gap: float = number(5.0, "usual intervals", "a longer pause begins a new series", "chosen by hand")
    level_step: float = number(
        7.0, "robust sd", "a larger jump of an unknown level begins a new segment", "chosen by hand"
    )
    level_step_of_no_air: float = number(
        4.5, "robust sd", "the same, where the air cannot have made the jump", "chosen by hand"
    )
    most_level_steps: int = number(
        6, "rounds", "the diagnosis runs again with one more level step at most so often", "chosen by hand"
    )
    folds: int = number(5, "folds", "parts of the rows that are held out in turn", "convention")
