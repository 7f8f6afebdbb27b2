"""Progress of a diagnosis."""

from collections.abc import Callable

__all__ = ["STAGES", "Progress", "Steps"]

Progress = Callable[[str, int, int], object]
"""Called with the name of the stage, the number of stages done, and the number of all stages."""

STAGES = (
    "reading",
    "searching for faults",
    "building columns",
    "comparing causes",
    "comparing noises",
    "validating claims",
    "planning measurements",
)
"""Stages in order. For each level step that is found, the work starts again at the columns."""


class Steps:
    """Reports to a listener which stage begins, if there is a listener."""

    def __init__(self, listener: Progress | None) -> None:
        self._listener = listener
        self.level_steps = 0  # found so far; each starts the work again

    def begin(self, stage: str) -> None:
        """Report that a stage of `STAGES` begins."""
        if self._listener is not None:
            text = f"{stage} (again, level steps found: {self.level_steps})" if self.level_steps else stage
            self._listener(text, STAGES.index(stage), len(STAGES))

    def end(self) -> None:
        """Report that all stages are done."""
        if self._listener is not None:
            self._listener("done", len(STAGES), len(STAGES))
