"""Numbers of the smooth correction, and of the check that a large error is not called nothing."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["SmoothSettings"]


@dataclass(frozen=True, kw_only=True)
class SmoothSettings:
    """Numbers of the smooth correction."""

    pieces: int = number(
        10,
        "pieces",
        "of a cubic spline over the range of a column; with fewer distinct values, as many as half of them",
        "chosen by hand: the penalty decides how smooth it is",
    )
    penalties: tuple[float, ...] = number(
        (1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e2),
        "of the trace of the products",
        "weights of the penalty that are tried: from about ten degrees of freedom to a straight line",
        "chosen by hand",
    )
    most_terms: int = number(6, "columns", "of one smooth correction at most", "chosen by hand")
    most_beside: int = number(
        8, "columns", "tried beside the first one: those that predict best alone", "time, chosen by hand"
    )
    gain_from: float = number(
        3.0,
        "log likelihood",
        "a column takes part if it raises that of the rows left out by so much",
        "odds of 20",
    )
    standard_errors: float = number(
        1.0,
        "standard errors",
        "of this rise, from its scatter over the parts left out: so many are subtracted from it first",
        "rule of one standard error: Hastie, Tibshirani, Friedman, Elements of Statistical Learning, 7.10",
    )
    longest_gap: float = number(
        1.5, "h", "a column of hours with a longer gap has no smooth function of the day", "chosen by hand"
    )
    most_rows: int = number(
        50_000, "rows", "of larger tables, evenly spaced runs of rows are fitted", "memory, chosen by hand"
    )
    run: int = number(500, "rows", "of such a run", "chosen by hand: far longer than noise is correlated")
    far: float = number(
        0.5,
        "of the mean square",
        "the floor is far below the error if the columns can remove more than this part",
        "chosen by hand: more than half of the error is no noise",
    )
    far_from_chance: float = number(
        1e-5,
        "p-value",
        "and if chance removes as much with less than this probability",
        "chosen by hand: the noise models are a grid, and with the nearest one p-values are too small",
    )
    rows_of_a_turn: int = number(
        8, "rows", "of each turn, where rows are tried for a period in their order", "chosen by hand"
    )
    other_turns: float = number(
        0.1,
        "of the variance",
        "of a recorded column between the turns, from which on the column may be the reason",
        "chosen by hand",
    )
