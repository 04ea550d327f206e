"""Types of arrays."""

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float64]  # Real numbers of any shape
Mask = NDArray[np.bool_]  # Which sites, of any shape
