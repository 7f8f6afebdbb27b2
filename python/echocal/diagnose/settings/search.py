"""Which hypotheses are looked at."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["SearchSettings"]


@dataclass(frozen=True, kw_only=True)
class SearchSettings:
    """Pruning and shortlists; what each can lose is in docs/method.md."""

    pruning_log_odds: float = number(
        25.0,
        "log odds",
        "a hypothesis that far behind the best is left out, and no larger set is built on it",
        "measured: with 18 a set that holds 0.0009 is missed; tests/test_diagnose_pruned.py",
    )
    form_preference: float = number(
        1.5, "log odds", "of forms of a cause that are as good as that, the freest is taken", "chosen by hand"
    )
    most_columns: int = number(
        420,
        "columns",
        "with more, further columns of the table go on a shortlist",
        "cost: 1 GB (docs/diagnose.md)",
    )
    shortlist_least: int = number(
        8, "columns", "so many further columns are tried in any case", "chosen by hand"
    )
    onset_resolution: float = number(0.5, "rows", "where the search for an onset ends", "rows tell no more")
    onset_ends: int = number(
        5,
        "rows",
        "at either end of a table, where no onset is sought: it would be a wild row",
        "chosen by hand",
    )
    distances_before: float = number(
        1 / 8, "of the distances", "lie before the one at which an effect may begin", "chosen by hand"
    )
    fewest_distances_before: int = number(
        2, "distances", "lie before it at least: one alone would make any offset an onset", "argument"
    )
