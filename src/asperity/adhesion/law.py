r"""Laws of adhesion with a range: the energy of two surfaces for each area, as a function of their gap.

    phi(gap) <= 0,      phi(0) = -w,      phi' >= 0 does not rise with the gap

phi' is the traction that pulls the surfaces together. As phi is concave, a contact with adhesion is a
sequence of contacts with external forces, see `asperity.contact.adhesive`.
"""

from __future__ import annotations

import math

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.parameters import Law
from asperity.errors import InputError


class Adhesion(Law):
    """A law of adhesion with a range.

    Its keys in a configuration begin with ``adhesion``. They follow from its parameters: the fields of a
    frozen dataclass that are annotated with a `asperity.base.parameters.Quantity`.
    """

    prefix = "adhesion"

    work: float
    """Work of adhesion w, energy per area."""

    @property
    def strength(self) -> float:
        """Largest traction s0, that at contact."""
        raise NotImplementedError

    @property
    def reach(self) -> float:
        """Gap from which on nothing pulls."""
        return math.inf

    def energy(self, gap: Floats) -> Floats:
        """Energy phi for each area at gaps >= 0, which may be infinite."""
        raise NotImplementedError

    def traction(self, gap: Floats) -> Floats:
        """Traction phi' >= 0 at gaps, which may be infinite; below 0 as at 0."""
        raise NotImplementedError

    def zone(self, modulus: float) -> float:
        """Length pi E* w / (4 s0^2) over which surfaces that part still pull, length.

        It is that of a straight front in a half-space, where the range is small beside the contact (D. S.
        Dugdale, J. Mech. Phys. Solids 8, 100 (1960), DOI 10.1016/0022-5096(60)90013-2).
        """
        return math.pi * modulus * self.work / (4 * self.strength**2)


def checked_adhesion(adhesion: Adhesion) -> Adhesion:
    """Take a law of adhesion and nothing else."""
    advice = "asperity.solids.Dugdale(work='50 mJ/m^2', range='10 nm')"
    law = checks.instance("adhesion", adhesion, Adhesion, advice)
    for method in ("strength", "energy", "traction"):
        if getattr(type(law), method) is getattr(Adhesion, method):
            expected = "a law with a strength, an energy(gap) and a traction(gap)"
            got = f"{checks.kind_of(law)} without {method}"
            raise InputError("adhesion", expected=expected, got=got, advice=advice)
    return law
