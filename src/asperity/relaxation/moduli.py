"""From Young's modulus to contact modulus."""

from __future__ import annotations

import asperity.checks as checks
from asperity.errors import LARGEST


def contact_modulus(young: float, poisson: float, other: float | None = None) -> float:
    """Contact modulus E* of a body against a rigid one, or against another.

        1/E* = (1 - nu^2)/E + 1/E*_other

    Parameters
    ----------
    young
        Young's modulus E, above 0, in any unit.
    poisson
        Poisson's ratio nu, above -1 and at most 0.5.
    other
        Contact modulus of the other body, in the same unit; None if that is rigid.

    Returns
    -------
    float
        In the unit of `young`.

    Raises
    ------
    InputError
        A number is out of its range.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 4.2, DOI 10.1017/CBO9781139171731.
    """
    E = checks.number("young", young, least=1 / LARGEST, expected="a finite modulus > 0")
    nu = checks.number("poisson", poisson, above=-1, most=0.5)
    alone = E / (1 - nu**2)
    if other is None:
        return alone
    other = checks.number("other", other, least=1 / LARGEST, expected="a finite modulus > 0")
    return 1 / (1 / alone + 1 / other)
