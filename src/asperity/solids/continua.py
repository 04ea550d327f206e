"""Solids that are continua, in any consistent units: Pa, m and s where surfaces have units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

from annotated_types import Ge, Gt, Le, Len

from asperity.adhesion import Adhesion
from asperity.base import checks, units
from asperity.base.parameters import Quantity
from asperity.base.words import InUnits, written_with_units
from asperity.creep import LocalCreep, checked_law
from asperity.errors import InputError
from asperity.solids.arguments import (
    LARGEST,
    POISSON,
    RATIO,
    YOUNG,
    Apparatus,
    Branches,
    Hardness,
    Modulus,
    Poisson,
    Thickness,
    Young,
)
from asperity.solids.branches import check_branches
from asperity.solids.laws import LayerSpectrum, PowerMobility, WaveNumberSpectrum
from asperity.solids.solid import CreepBranch, Solid

_LEAST_PERMANENT = 0.02
"""Least share above 0 that may stand beside a local law: steps with less may not converge."""


OneOrTwo = float | str | Sequence[float | str]
"""A number or a text with a unit, of one body or of each of two."""


def contact_modulus(young: OneOrTwo, poisson: float | Sequence[float] | None = None) -> float:
    r"""Contact modulus E* of two elastic bodies: 1/E* = sum of (1 - nu^2) / E.

    Parameters
    ----------
    young
        Young's modulus E of the one body that is not rigid, or of both, > 0; also as texts: ``"3 GPa"``.
    poisson
        Poisson's ratio nu of the same, from -1 to 0.5; by default 0.35.

    Returns
    -------
    float
        E*, in the unit of ``young``; of texts in Pa.

    Raises
    ------
    InputError
        A value is out of its range, or there are more of one kind than of the other.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), Eq. (4.24).
    """
    young = units.either("young", young, "Pa")
    moduli = checks.positive("young", young).reshape(-1)
    ratios = checks.floats("poisson", [POISSON] * moduli.size if poisson is None else poisson).reshape(-1)
    if not 1 <= moduli.size <= 2:
        raise InputError("young", expected="one for each of one or two bodies", got=moduli.size)
    if ratios.size != moduli.size:
        expected, some = f"one for each of {moduli.size} in young", [POISSON] * moduli.size
        advice = f"poisson={some if moduli.size > 1 else some[0]}"
        raise InputError("poisson", expected=expected, got=ratios.size, advice=advice)
    for ratio in ratios.tolist():
        checked_poisson("poisson", ratio)
    modulus = 1.0 / float(((1 - ratios**2) / moduli).sum())
    written = next(written_with_units([young]), None)
    return modulus if written is None else InUnits.of(modulus, written.written, "Pa")


def checked_modulus(modulus: float | str | None, young: OneOrTwo | None, poisson: Any) -> float:
    """The instantaneous contact modulus, from the one of two moduli that is given."""
    if checks.one_of("modulus='3 GPa'", modulus=modulus, young=young) == "young":
        return contact_modulus(young, poisson)  # type: ignore[arg-type]
    return units.number("modulus", modulus, "Pa", above=0)


def half_space(
    *,
    modulus: Modulus = None,
    young: Annotated[float | str | Sequence[float | str] | None, Gt(0), LARGEST, Len(1, 2), YOUNG] = None,
    poisson: Annotated[float | Sequence[float] | None, Gt(-1), Le(0.5), Len(1, 2), RATIO] = None,
    branches: Branches = (),
    flow: Annotated[
        tuple[
            Annotated[float, Gt(0), Quantity("mobility")],
            Annotated[float, Ge(-2), Le(4), Quantity("power of the wave number")],
        ]
        | None,
        Quantity(
            "mobility of creep, and its power of the wave number (-1 bulk flow, 0 dissolution, 1 and 2 "
            "diffusion in the volume and along the surface), in place of branches."
        ),
    ] = None,
    apparatus: Apparatus = None,
    creep: LocalCreep | None = None,
    permanent: Annotated[
        float,
        *(Ge(0), Le(0.99)),
        Quantity("share of the modulus that does not creep by the local law. By default 0.", usual=None),
    ] = 0.0,
    hardness: Hardness = None,
    adhesion: Adhesion | None = None,
) -> Solid:
    r"""Build a half-space that is elastic, viscoelastic, or creeps by a mechanism of its surface.

    A periodic pressure of wave vector q on a half-space displaces its surface by 2 / (E* abs(q)) of it, so
    the stiffness is K = E* abs(q) / 2 for each area. Branch b takes the share g_b of it and relaxes, at
    every wave vector, in the time tau_b (a generalized Maxwell solid); the rest is permanent:

        H = (1 - sum g_b) K,    C_b = g_b K,    M_b = 1 / (tau_b C_b).

    With ``flow``, all of the stiffness is one branch whose mobility is a power of the wave number.

    Parameters
    ----------
    modulus
        Instantaneous contact modulus E*, force per area; see `contact_modulus`. Under a surface with units,
        all numbers here are in SI or texts with a unit: ``"3 GPa"``.
    young, poisson
        Instead of the modulus: instantaneous Young's modulus and Poisson's ratio, of one body or of both; by
        default the ratio is 0.35.
    branches
        Pairs (share of the modulus, relaxation time). Without any the half-space is elastic.
    flow
        Instead of branches: mobility m, velocity per pressure times length^n, and exponent n of
        M = m abs(q)^n (-1: bulk flow, 0: dissolution, 1: diffusion in the volume, 2: along the surface). The
        mean, at q = 0, does not flow.
    apparatus
        Stiffness of the apparatus, force per length, between the machine and the half-space, which may be
        `math.inf`. With it the position of the machine can be prescribed (``separation=``). Infinite stands
        for 1e4 times the largest stiffness of a mode.
    creep
        Instead of branches: a local law of creep, such as `Eyring`, in series with the stiffness C. Each site
        yields with the velocity v(s) under the pressure s that C has there.
    permanent
        Share of the modulus beside that law, 0 or from 0.02 to 0.99: H = permanent K, C = (1 - permanent) K.
        If it is 0, s is the contact pressure.
    hardness
        Pressure under which the rough surface yields; see `asperity.solids.Solid.with_hardness`.
    adhesion
        A law of adhesion, such as `Dugdale`; beside no law of creep and no hardness.

    Returns
    -------
    Solid
        It is separable unless it has ``flow``, ``creep``, a hardness or adhesion.

    Raises
    ------
    InputError
        A number is not positive and finite, or the shares add up to more than 1.

    Notes
    -----
    Without an apparatus nothing holds the mean of the surface: the load is prescribed, and the separation
    is the mean of u. Under a surface with free edges the half-space is held far away: a separation can be
    prescribed, and counts from there. It then has no flow, and nothing permanent beside a law of creep.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 13.2, DOI 10.1017/CBO9781139171731.
    """
    if modulus is not None and poisson is not None:
        expected = "none: the contact modulus contains it"
        raise InputError("poisson", expected=expected, got=checks.shown(poisson), advice="young=...")
    modulus = checked_modulus(modulus, young, poisson)
    least = _LEAST_PERMANENT if permanent else 0.0
    expected = f"0, or from {_LEAST_PERMANENT:g} to 0.99"
    permanent = checks.number("permanent", permanent, least=least, most=0.99, expected=expected)
    if permanent and creep is None:
        expected, advice = "a law of creep beside it", "branches, whose rest is permanent"
        raise InputError("permanent", expected=expected, got="none", advice=advice)
    law = WaveNumberSpectrum(modulus / 2)
    arguments: dict[str, Any] = {"modulus": modulus, "half_space": True, "kind": "half_space"}
    arguments |= {"apparatus": checked_apparatus(apparatus), "adhesion": adhesion}
    if creep is not None:
        if branches or flow is not None:
            raise InputError("creep", expected="no branches and no flow beside it", got="both")
        arguments |= {"stiffness": law, "shares": ((1 - permanent, math.inf),), "creep": checked_law(creep)}
        arguments["parameters"] = {"permanent": permanent} if permanent else {}
    elif flow is None:
        arguments |= {"stiffness": law, "shares": check_branches(branches)}
    else:
        if others := check_branches(branches):
            raise InputError("flow", expected="no branches beside it", got=f"{len(others)} branches")
        mobility = checks.line("flow", flow).tolist()
        if len(mobility) != 2 or not (mobility[0] > 0 and -2 <= mobility[1] <= 4):
            expected = "a mobility above 0 and an exponent from -2 to 4"
            raise InputError("flow", expected=expected, got=checks.shown(flow), advice="flow=(1e-20, 0)")
        arguments["branches"] = (CreepBranch(law, PowerMobility(*mobility)),)
        arguments["parameters"] = {"flow": tuple(mobility)}
    return Solid(**arguments).with_hardness(hardness)


def layer(
    *,
    modulus: Modulus = None,
    young: Young = None,
    poisson: Poisson,
    thickness: Thickness,
    branches: Branches = (),
    bonded: Annotated[
        bool,
        Quantity("whether the layer slides on its base, or is bonded to it.", key="frictionless"),
    ] = True,
    hardness: Hardness = None,
    adhesion: Adhesion | None = None,
) -> Solid:
    r"""Build an elastic or viscoelastic layer on a rigid base; see `asperity.solids.laws.LayerSpectrum`.

    Parameters
    ----------
    modulus
        Instantaneous contact modulus E* = E / (1 - nu^2) of its material, force per area.
    young
        Instead: its Young's modulus E.
    poisson
        Its Poisson's ratio nu, from -1 to 0.5, which does not relax. A bonded layer of 0.5 keeps its volume.
    thickness
        Length.
    branches
        As in `half_space`.
    bonded
        Whether the layer is bonded to the base; else it slides on it without friction. Pressed evenly, it
        then has E*/h, the limit of long waves in plane strain (free along one axis), not the confined modulus
        of a bonded one, which is (1 - nu)^2 / (1 - 2 nu) times that.
    hardness
        Pressure under which the rough surface yields; see `asperity.solids.Solid.with_hardness`.
    adhesion
        As in `half_space`.

    Returns
    -------
    Solid
        It is separable unless it has a hardness or adhesion.

    Raises
    ------
    InputError
        As for `half_space`; or Poisson's ratio is out of its range.
    """
    poisson = checked_poisson("poisson", poisson)
    modulus = checked_modulus(modulus, young, poisson)
    thickness = units.number("thickness", thickness, "m", above=0)
    return Solid(
        stiffness=LayerSpectrum(modulus, poisson, thickness, bonded),
        shares=check_branches(branches),
        parameters={"poisson": poisson, "thickness": thickness, "bonded": float(bonded)},
        in_lengths=True,
        modulus=modulus,
        adhesion=adhesion,
        kind="layer",
    ).with_hardness(hardness)


def checked_apparatus(stiffness: float | str | None) -> float | None:
    """Stiffness of an apparatus, which may be infinite, or None without one."""
    if stiffness is None or (isinstance(stiffness, float) and stiffness == math.inf):
        return stiffness
    expected = "a stiffness above 0, or math.inf"
    return units.number("apparatus", stiffness, "N/m", of_line="N/m^2", above=0, expected=expected)


def checked_poisson(name: str, ratio: float) -> float:
    """Check Poisson's ratio."""
    return checks.number(name, ratio, above=-1, most=0.5, advice="0.3")
