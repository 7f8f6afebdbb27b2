"""How far a diagnosis is, for whoever waits for it."""

from collections.abc import Callable

__all__ = ["STAGES", "Progress", "Steps"]

Progress = Callable[[str, int, int], object]
"""Called with what is being done, the number of stages done, and their number."""

STAGES = (
    "reading",
    "looking for faults",
    "building columns",
    "weighing causes",
    "weighing noises",
    "validating on held-out rows",
    "planning measurements",
)
"""What a diagnosis does, in order; from the columns on again for each level step that it finds."""


class Steps:
    """Tells a listener which stage begins; does nothing where nobody listens."""

    def __init__(self, listener: Progress | None) -> None:
        self._listener = listener
        self.level_steps = 0  # found so far: for each the work begins again

    def begin(self, stage: str) -> None:
        """Tell that a stage of `STAGES` begins."""
        if self._listener is not None:
            text = f"{stage}, {self.level_steps} level steps more" if self.level_steps else stage
            self._listener(text, STAGES.index(stage), len(STAGES))

    def end(self) -> None:
        """Tell that everything is done."""
        if self._listener is not None:
            self._listener("done", len(STAGES), len(STAGES))
