"""Adhesion by an even traction within a range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from annotated_types import Gt

from asperity.adhesion.law import Adhesion
from asperity.base.checks import Floats
from asperity.base.parameters import Quantity


@dataclass(frozen=True)
class Dugdale(Adhesion):
    r"""Surfaces pull with s0 = w/h0 where their gap is below h0, and not at all beyond.

    Parameters
    ----------
    work
        Work of adhesion w, energy per area > 0; under a surface with units in J/m^2, or a text with a unit.
    range
        Range h0, length > 0; likewise in m.

    Raises
    ------
    InputError
        A number is out of its range.

    References
    ----------
    D. Maugis, J. Colloid Interface Sci. 150, 243 (1992), DOI 10.1016/0021-9797(92)90285-T.
    """

    work: Annotated[float, Gt(0), Quantity("work of adhesion", "J/m^2", "w")]
    range: Annotated[float, Gt(0), Quantity("range", "m", "h0")]

    formula = "s0 = w/h0 where the gap is below h0"

    if TYPE_CHECKING:

        def __init__(self, work: float | str, range: float | str) -> None: ...  # noqa: A002

    @property
    def strength(self) -> float:
        """See `Adhesion`."""
        return self.work / self.range

    @property
    def reach(self) -> float:
        """See `Adhesion`."""
        return self.range

    def energy(self, gap: Floats) -> Floats:
        """See `Adhesion`."""
        return self.strength * np.minimum(gap - self.range, 0.0)

    def traction(self, gap: Floats) -> Floats:
        """See `Adhesion`."""
        return np.where(gap < self.range, self.strength, 0.0)
