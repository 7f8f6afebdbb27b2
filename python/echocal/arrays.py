"""The kinds of arrays that columns of a table are, each of shape (n,)."""

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]
