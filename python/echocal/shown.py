"""How results show themselves: in a notebook, in the terminal, as a table and as a figure."""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

__all__ = ["Shown"]


class Shown:
    """A result with a short ``repr``, an explanation as text, a table and a figure.

    What each kind of result shows is in `echocal.report.results` and `echocal.plots.results`, which are
    imported when they are used.
    """

    def __repr__(self) -> str:
        return f"<{_call('report', 'headline', self)}>"

    def __str__(self) -> str:
        return str(_call("report", "explanation", self))

    def _repr_html_(self) -> str:
        """What a notebook shows: the headline, of a diagnosis its sentence, the figure and the table."""
        return str(_call("report", "html", self))

    def to_dataframe(self) -> "DataFrame":
        """Return the result as a table of pandas: a row for each cause, parameter, reading or figure."""
        frame: DataFrame = _call("report", "dataframe", self)
        return frame

    def plot(self) -> "Figure":
        """Draw the result.

        Returns
        -------
        matplotlib.figure.Figure
            A notebook shows it; ``figure.savefig("name.png")`` writes it.
        """
        figure: Figure = _call("plots", "figure", self)
        if "ipykernel" in sys.modules:
            # a notebook knows how to show a figure once this is imported, a dependency of ipykernel
            import_module("matplotlib_inline.backend_inline")
        return figure


def _call(room: str, function: str, result: object) -> Any:
    return getattr(import_module(f"echocal.{room}.results"), function)(result)
