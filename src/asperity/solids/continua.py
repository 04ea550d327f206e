"""Solids that are continua, in any consistent units: Pa, m and s where surfaces have units."""

from __future__ import annotations

import math
from collections.abc import Sequence

from asperity.base import checks, units
from asperity.creep import LocalCreep, checked_law
from asperity.errors import InputError
from asperity.relaxation import check_branches
from asperity.solids.laws import (
    FixedRate,
    LaplacianSpectrum,
    LayerSpectrum,
    PowerMobility,
    Scaled,
    SpectrumOf,
    WaveNumberSpectrum,
    WithApparatus,
)
from asperity.solids.solid import CreepBranch, Parameters, Solid

Branches = Sequence[tuple[float, float | str]]

_LEAST_PERMANENT = 0.02
"""Least share above 0 that may stand beside a local law: steps with less may not converge."""


def contact_modulus(young: float | Sequence[float], poisson: float | Sequence[float]) -> float:
    r"""Contact modulus E* of two elastic bodies: 1/E* = sum of (1 - nu^2) / E.

    Parameters
    ----------
    young
        Young's modulus E of the one body that is not rigid, or of both, > 0.
    poisson
        Poisson's ratio nu of the same, from -1 to 0.5.

    Returns
    -------
    float
        E*, in the unit of ``young``.

    Raises
    ------
    InputError
        A value is out of its range, or there are more of one kind than of the other.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), Eq. (4.24).
    """
    moduli = checks.positive("young", young).reshape(-1)
    ratios = checks.floats("poisson", poisson).reshape(-1)
    if not 1 <= moduli.size == ratios.size <= 2:
        got = f"{moduli.size} moduli and {ratios.size} ratios"
        raise InputError("young and poisson", expected="one of each for each of one or two bodies", got=got)
    for ratio in ratios.tolist():
        checked_poisson("poisson", ratio)
    return 1.0 / float(((1 - ratios**2) / moduli).sum())


def half_space(
    *,
    modulus: float | str,
    branches: Branches = (),
    flow: tuple[float, float] | None = None,
    apparatus: float | str | None = None,
    creep: LocalCreep | None = None,
    permanent: float = 0.0,
    hardness: float | str | None = None,
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
        Contact modulus E* at once, before anything relaxes, force per area; see `contact_modulus`. Under a
        surface with units, in Pa or with a unit: ``"3 GPa"``; so are all numbers here.
    branches
        Pairs (share of the modulus, relaxation time). Without any the half-space is elastic.
    flow
        Instead of branches: mobility m, velocity per pressure times length^n, and exponent n of
        M = m abs(q)^n (-1: bulk flow, 0: dissolution, 1: diffusion in the volume, 2: along the surface).
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

    Returns
    -------
    Solid
        It is separable unless it has ``flow``, ``creep`` or a hardness.

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
    modulus = units.number("modulus", modulus, "Pa", above=0)
    apparatus = checked_apparatus(apparatus)
    law = WaveNumberSpectrum(modulus / 2)
    parameters = {"modulus": modulus}
    permanent = checked_permanent(permanent)
    if permanent and creep is None:
        raise InputError(
            "permanent",
            expected="a law of creep beside it",
            got="none",
            advice="branches, whose rest is permanent",
        )
    if creep is not None:
        if branches or flow is not None:
            raise InputError("creep", expected="no branches and no flow beside it", got="both")
        creeping = Scaled(law, 1 - permanent) if permanent else law
        kept = {"permanent": permanent} if permanent else {}
        return Solid(
            permanent=Scaled(law, permanent),
            branches=(CreepBranch(_mounted(creeping, law, apparatus), LaplacianSpectrum()),),
            parameters={**parameters, **checked_law(creep).parameters, **kept, **_named(apparatus)},
            loaded_from_afar=True,
            in_lengths=True,
            creep=creep,
            kind="half_space",
        ).with_hardness(hardness)
    if flow is None:
        solid = _solid("half_space", law, parameters, branches, apparatus, loaded_from_afar=True)
        return solid.with_hardness(hardness)
    if others := check_branches(branches):
        raise InputError("flow", expected="no branches beside it", got=f"{len(others)} branches")
    law_of_flow = checks.line("flow", flow).tolist()
    if len(law_of_flow) != 2 or not (law_of_flow[0] > 0 and -2 <= law_of_flow[1] <= 4):
        expected = "a mobility above 0 and an exponent from -2 to 4"
        raise InputError("flow", expected=expected, got=checks.shown(flow), advice="flow=(1e-20, 0)")
    mobility, exponent = law_of_flow
    return Solid(
        permanent=_mounted(Scaled(law, 0.0), law, apparatus),
        branches=(CreepBranch(Scaled(law, 1.0), PowerMobility(mobility, exponent)),),
        parameters={**parameters, "flow": (mobility, exponent), **_named(apparatus)},
        loaded_from_afar=True,
        in_lengths=True,
        kind="half_space",
    ).with_hardness(hardness)


def layer(
    *,
    modulus: float | str,
    poisson: float,
    thickness: float | str,
    branches: Branches = (),
    bonded: bool = True,
    hardness: float | str | None = None,
) -> Solid:
    r"""Build an elastic or viscoelastic layer on a rigid base; see `asperity.solids.laws.LayerSpectrum`.

    Parameters
    ----------
    modulus
        Contact modulus E* = E / (1 - nu^2) of its material at once, force per area.
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

    Returns
    -------
    Solid
        It is separable.

    Raises
    ------
    InputError
        As for `half_space`; or Poisson's ratio is out of its range.
    """
    poisson = checked_poisson("poisson", poisson)
    modulus = units.number("modulus", modulus, "Pa", above=0)
    thickness = units.number("thickness", thickness, "m", above=0)
    law = LayerSpectrum(modulus, poisson, thickness, bonded)
    parameters = {"modulus": modulus, "poisson": poisson, "thickness": thickness, "bonded": float(bonded)}
    return _solid("layer", law, parameters, branches).with_hardness(hardness)


def _solid(
    kind: str,
    law: SpectrumOf,
    parameters: Parameters,
    branches: Branches,
    apparatus: float | None = None,
    *,
    loaded_from_afar: bool = False,
) -> Solid:
    """A generalized Maxwell solid: the share of each branch of one law of stiffness."""
    checked = check_branches(branches)
    parts = [(Scaled(law, share), time) for share, time in checked]
    rest = 1.0 - math.fsum(share for share, _ in checked)
    permanent = Scaled(law, rest if rest > 1e-12 else 0.0)
    return Solid(
        permanent=_mounted(permanent, law, apparatus),
        branches=tuple(CreepBranch(part, FixedRate(1 / time, part)) for part, time in parts),
        parameters={**parameters, "branches": checked, **_named(apparatus)},
        loaded_from_afar=loaded_from_afar,
        in_lengths=True,
        kind=kind,
    )


def _mounted(permanent: SpectrumOf, law: SpectrumOf, apparatus: float | None) -> SpectrumOf:
    return permanent if apparatus is None else WithApparatus(permanent, law, apparatus)


def _named(apparatus: float | None) -> dict[str, float]:
    return {} if apparatus is None else {"apparatus": apparatus}


def checked_apparatus(stiffness: float | str | None) -> float | None:
    """Stiffness of an apparatus, which may be infinite, or None without one."""
    if stiffness is None or stiffness == math.inf:
        return None if stiffness is None else math.inf
    expected = "a stiffness above 0, or math.inf"
    return units.number("apparatus", stiffness, "N/m", above=0, expected=expected)


def checked_permanent(share: float) -> float:
    """Check the share of the modulus beside a local law."""
    expected = f"0, or a share from {_LEAST_PERMANENT:g} to 0.99"
    share = checks.number("permanent", share, least=0, most=0.99, expected=expected)
    if 0 < share < _LEAST_PERMANENT:
        raise InputError("permanent", expected=expected, got=f"{share:g}")
    return share


def checked_poisson(name: str, ratio: float) -> float:
    """Check Poisson's ratio."""
    expected = "Poisson's ratio, from -1 to 0.5"
    return checks.number(name, ratio, above=-1, most=0.5, expected=expected, advice="0.3")
