"""Search for the onset of an effect: what the effect explains for each possible onset."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.scene import Scene
from echocal.registry import Effect

__all__ = ["OnsetSearch"]

Column = NDArray[np.float64]
Matrix = NDArray[np.floating[Any]]

_ALIKE = 1e-9  # relative ridge, for columns that are linearly dependent


@dataclass(kw_only=True)
class OnsetSearch:
    """What the sizes of an effect explain beside a level, for each onset.

    Attributes
    ----------
    parameters : mapping of str to float
        Parameters at which the tangents are taken, except the onset.
    place : str
        Name of the parameter that is the onset.
    of : sequence of ndarray, shape (n,)
        Columns to be explained [m].
    known : dict of float to ndarray
        Sum of squares of each of these that the effect explains, by onset.
    """

    effect: Effect
    parameters: Mapping[str, float]
    place: str
    scene: Scene
    of: Sequence[Column]
    known: dict[float, Matrix] = field(default_factory=dict)

    def squares(self, wanted: Sequence[float], of: int) -> list[float]:
        """Sums of squares of one column that the effect explains with each of some onsets."""
        new = [value for value in dict.fromkeys(wanted) if value not in self.known]
        if new:
            self._look(new)
        return [float(self.known[value][of]) for value in wanted]

    def _look(self, values: Sequence[float]) -> None:
        """Look at all these onsets in one pass over the rows."""
        columns = self.scene.columns()
        slope = columns.slope()
        sizes = [p.name for p in self.effect.parameters if p.role == "size"]
        designs = []
        for value in values:
            at = {**self.parameters, self.place: value}
            designs.append([slope, *(columns.tangent(self.effect.id, at, name, 1.0) for name in sizes)])
        left = [columns.store(of) for of in self.of]
        gram = columns.gram()
        for value, own in zip(values, designs, strict=True):
            among, along = gram[np.ix_(own, own)], gram[np.ix_(own, left)]
            ridge = np.diag(_ALIKE * among.diagonal() + np.finfo(float).tiny)
            self.known[value] = (np.linalg.solve(among + ridge, along) * along).sum(axis=0)
