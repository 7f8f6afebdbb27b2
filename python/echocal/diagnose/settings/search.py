"""The search over hypotheses."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["SearchSettings"]


@dataclass(frozen=True, kw_only=True)
class SearchSettings:
    """Limits of the search; docs/method.md, section 5, says what they leave out."""

    pruning_log_odds: float = number(
        25.0,
        "log odds",
        "a hypothesis that is less probable than the best by more is pruned",
        "measured: with 18, a set with a probability of 0.0009 is missed; tests/test_diagnose_pruned.py",
    )
    form_preference: float = number(
        1.5,
        "log odds",
        "of the forms of a cause within it of the best, the one with the most parameters is taken",
        "chosen by hand",
    )
    unlisted_in_folds: float = number(
        1e-3,
        "probability",
        "the least probable hypotheses, which share it, are left out where a choice is repeated in a fold",
        "argument: a choice by sums of probabilities; it saves a twentieth of the time of 1,000 rows",
    )
    most_columns: int = number(
        420,
        "columns",
        "if there are more, a shortlist of the further columns of the table is used",
        "memory: 1 GB (docs/diagnose.md)",
    )
    most_thermometers: int = number(
        8,
        "columns",
        "of more further thermometers, those that differ from the first as the residual does are tried",
        "memory: each takes two columns of the sums; chosen by hand",
    )
    shortlist_least: int = number(8, "columns", "fewest further columns on the shortlist", "chosen by hand")
    shortest_day: float = number(
        43_200.0,
        "s",
        "a table that spans less has no effect of the clock's daylight",
        "argument: half a day; a shorter part of the sun's arc looks like a drift or an offset",
    )
    onset_resolution: float = number(
        0.5, "rows", "resolution of the search for an onset", "rows show no more"
    )
    onset_ends: int = number(
        5,
        "rows",
        "at either end of a table, where no onset is searched for",
        "chosen by hand; an onset there would be an outlier",
    )
    distances_before: float = number(
        1 / 8, "of the distances", "fewest distances before an onset along the distance", "chosen by hand"
    )
    fewest_distances_before: int = number(
        2, "distances", "the same", "argument: with a single one, any offset would be an onset"
    )
