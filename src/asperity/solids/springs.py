"""Jagla's lattice of springs."""

from __future__ import annotations

from typing import Annotated

from annotated_types import Ge

from asperity.base import checks
from asperity.base.parameters import Quantity
from asperity.creep import LocalCreep, checked_law
from asperity.errors import InputError
from asperity.solids.arguments import LARGEST, Hardness
from asperity.solids.solid import Solid, Springs


def spring_lattice(
    *,
    k0: Annotated[
        float,
        *(Ge(0), LARGEST),
        Quantity("stiffness of the springs between neighbors", dimension="stiffness unit", usual=1.0),
    ],
    k1: Annotated[
        float,
        *(Ge(0), LARGEST),
        Quantity("stiffness of the springs to the bulk", dimension="stiffness unit", usual=3.0),
    ],
    R: Annotated[
        float, *(Ge(0), LARGEST), Quantity("mobility of creep that conserves the mean", dimension="R unit")
    ] = 1.0,
    R_viscous: Annotated[
        float, *(Ge(0), LARGEST), Quantity("mobility of viscous creep", dimension="R unit")
    ] = 0.0,
    creep: LocalCreep | None = None,
    hardness: Hardness = None,
) -> Solid:
    """Build Jagla's lattice of springs (Eqs. e and dosrs).

    Parameters
    ----------
    k0
        Stiffness of the springs between nearest neighbors, force per length; H = k0 lam(q). With
        ``k0=0`` the surface is a bed of independent springs.
    k1
        Stiffness of the springs to the bulk, force per length; C = k1. With ``k1=0`` there is nothing
        through which to press: `asperity.press` refuses.
    R
        Mobility of creep that conserves the mean of u0, velocity per force; M = R lam(q) + R_viscous.
    R_viscous
        Mobility of viscous creep, the paper's R̃, velocity per force.
    creep
        A local law of creep v(s) beside both, such as `Eyring`: du0/dt = M s + v(s) with the force s of the
        springs to the bulk.
    hardness
        Largest force of a site, above which the rough surface yields; see
        `asperity.solids.Solid.with_hardness`.

    Raises
    ------
    InputError
        A value is negative or not finite, or both stiffnesses are zero.

    References
    ----------
    E. A. Jagla, "Towards a modeling of the time dependence of contact area between solid bodies".
    """
    given = {"k0": k0, "k1": k1, "R": R, "R_viscous": R_viscous}
    parameters = {name: checks.number(name, value, least=0) for name, value in given.items()}
    k0, k1, R, R_viscous = parameters.values()
    if k0 == 0 and k1 == 0:
        raise InputError("k0 and k1", expected="a stiffness above 0", got="both 0", advice="k0=1.0, k1=3.0")
    law = creep if creep is None else checked_law(creep)
    springs = Springs(k0, k1, k1 * R, k1 * R_viscous)
    solid = Solid(springs=springs, parameters=parameters, creep=law, kind="spring_lattice")
    return solid.with_hardness(hardness)
