r"""A film bonded to a half-space of another material: stiffness and creep depend on the wavelength.

At wave number q a film of thickness h, shear modulus G1 and Poisson's ratio nu1 on a base of G0, nu0 has

    K = G1 abs(q) / ((1 - nu1) S),

    S = [1 + 4 m x e^(-2x) - m n e^(-4x)] / [1 - (m + n + 4 m x^2) e^(-2x) + m n e^(-4x)],    x = abs(q) h,

    m = (g - 1)/(g + 3 - 4 nu1),    n = 1 - 4 (1 - nu1)/(1 + g (3 - 4 nu0)),    g = G1/G0

(A. H. O'Sullivan, T. C. King, J. Tribol. 110, 235 (1988), DOI 10.1115/1.3261591; B. N. J. Persson, J. Phys.:
Condens. Matter 24, 095008 (2012), DOI 10.1088/0953-8984/24/9/095008). Where film or base relax, both moduli
are functions of the Laplace variable s (the correspondence principle), and K(q, s) is once more that of a
generalized Maxwell solid at each q. Its branches get fixed relaxation times, and shares that depend on q by
non-negative least squares. At once and in the end, K is exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

import numpy as np
from annotated_types import Gt, Le

from asperity.adhesion import Adhesion
from asperity.base import units
from asperity.base.checks import Floats
from asperity.base.parameters import Quantity
from asperity.base.positive_sums import positive_weights
from asperity.errors import InputError
from asperity.lattice import Lattice, Spectrum
from asperity.solids.arguments import (
    AT_MOST_ALL,
    LARGEST,
    Apparatus,
    Branch,
    Branches,
    Hardness,
    Modulus,
    Poisson,
    Thickness,
    Young,
)
from asperity.solids.branches import check_branches
from asperity.solids.continua import checked_apparatus, checked_modulus, checked_poisson
from asperity.solids.solid import CreepBranch, Solid

_PER_DECADE, _TIMES_PER_DECADE, _FREQUENCIES_PER_DECADE = 24, 4, 8
_LEAST, _MOST = 1e-4, 30.0  # products of wave number and thickness between which film and base both count
_LARGEST_ERROR = 0.02  # error of K relative to the instantaneous one, with which a solid is refused
_NEGLIGIBLE = 1e-5  # shares below it, at every wave number, are left out


@dataclass(frozen=True)
class Material:
    """A viscoelastic material: instantaneous contact modulus E*, Poisson's ratio, branches (share, time)."""

    modulus: float
    poisson: float
    branches: tuple[tuple[float, float], ...]

    def shear(self, s: float) -> float:
        """Shear modulus at a Laplace variable s >= 0: relaxed at 0, instantaneous at infinity."""
        rest = 1.0 - math.fsum(share for share, _ in self.branches)
        parts = [share / (1 + 1 / (s * time)) for share, time in self.branches if s > 0]
        return self.modulus * (1 - self.poisson) / 2 * (math.fsum(parts) + (rest if rest > 1e-12 else 0.0))


@dataclass(frozen=True)
class Coated:
    """A film on a base; evaluates K for each area over abs(q)."""

    film: Material
    base: Material
    thickness: float

    def over_wave_number(self, x: Floats, s: float) -> Floats:
        """K / abs(q) at x = abs(q) thickness > 0, and a Laplace variable that may be 0 or infinite."""
        film, base = self.film.shear(s), self.base.shear(s)
        if film == 0:  # it has flowed
            return np.zeros_like(x)
        nu1, nu0, near = self.film.poisson, self.base.poisson, np.exp(-2 * x)
        # Multiplied by G1 + (3 - 4 nu1) G0 and by G0 + (3 - 4 nu0) G1, which leaves no quotient of moduli.
        M, N = film + (3 - 4 * nu1) * base, base + (3 - 4 * nu0) * film
        m, n = film - base, N - 4 * (1 - nu1) * base
        top = M * N + 4 * m * N * x * near - m * n * near**2
        bottom = M * N - (m * N + n * M + 4 * m * N * x**2) * near + m * n * near**2
        return np.asarray(film / (1 - nu1) * bottom / top)


@lru_cache(maxsize=16)
def shares_of(coated: Coated) -> tuple[Floats, Floats, Floats, float]:
    """Grid of ln x, relaxation times, shares of what relaxes (times, grid), and the largest error of K.

    The error is relative to the instantaneous K, over the grid and all Laplace variables.
    """
    x = np.geomspace(_LEAST, _MOST, round(math.log10(_MOST / _LEAST) * _PER_DECADE))
    relaxation = [time for material in (coated.film, coated.base) for _, time in material.branches]
    low, high = math.log10(min(relaxation)), math.log10(max(relaxation)) + 3
    times = np.logspace(low, high, round((high - low) * _TIMES_PER_DECADE) + 1)
    decades = math.log10(times[-1] / times[0]) + 4
    s = np.geomspace(1e-2 / times[-1], 1e2 / times[0], round(decades * _FREQUENCIES_PER_DECADE))
    first, last = coated.over_wave_number(x, math.inf), coated.over_wave_number(x, 0.0)
    measured = (np.array([coated.over_wave_number(x, value) for value in s]) - last) / first
    kernel = 1 / (1 + 1 / np.outer(s, times))
    shares = np.array([positive_weights(kernel, column, np.ones(s.size)) for column in measured.T]).T
    error = float(np.abs(kernel @ shares - measured).max())
    kept = shares.max(axis=1) > _NEGLIGIBLE
    shares, times = shares[kept], times[kept]
    total = shares.sum(axis=0)
    return np.log(x), times, np.divide(shares, total, out=np.zeros_like(shares), where=total > 0), error


@dataclass(frozen=True)
class CoatedStiffness:
    """The permanent stiffness of a coated half-space, or that of one branch."""

    coated: Coated
    branch: int | None = None

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        q = lattice.wave_number
        x = np.maximum(q * self.coated.thickness, 1e-12)
        part = self.coated.over_wave_number(x, 0.0)
        if self.branch is not None:
            grid, _, shares, _ = shares_of(self.coated)
            relaxing = np.maximum(self.coated.over_wave_number(x, math.inf) - part, 0.0)
            part = np.interp(np.log(x), grid, shares[self.branch]) * relaxing
        return np.asarray(part * q * lattice.cell)


def coated_half_space(
    *,
    modulus: Modulus = None,
    young: Young = None,
    poisson: Poisson,
    thickness: Thickness,
    base_modulus: Annotated[
        float | str, Gt(0), LARGEST, Quantity("contact modulus of the base, unrelaxed.", "Pa")
    ],
    base_poisson: Annotated[float, Gt(-1), Le(0.5), Quantity("Poisson's ratio of the base")],
    branches: Branches = (),
    base_branches: Annotated[
        Sequence[Branch],
        AT_MOST_ALL,
        Quantity("share of the modulus and relaxation time of each branch of the base"),
    ] = (),
    apparatus: Apparatus = None,
    hardness: Hardness = None,
    adhesion: Adhesion | None = None,
) -> Solid:
    r"""Build a film bonded to a half-space of another material; each is elastic or viscoelastic.

    Parameters
    ----------
    modulus, poisson
        Instantaneous contact modulus E* = E / (1 - nu^2) of the film, force per area, and Poisson's ratio.
    young
        Instead of the modulus: Young's modulus of the film.
    thickness
        Thickness of the film, length.
    base_modulus, base_poisson
        The same of the base.
    branches, base_branches
        Pairs (share of the modulus, relaxation time) of the film and of the base; see `half_space`.
    apparatus, hardness, adhesion
        As in `half_space`.

    Returns
    -------
    Solid
        It is not separable, if anything relaxes: waves that are long against the thickness feel the base,
        short ones the film. Its parameter ``largest_error`` is that of the stiffness as a function of
        the Laplace variable, relative to the instantaneous stiffness; at first and in the end it is exact.

    Raises
    ------
    InputError
        A number is out of its range.
    """
    film = _material("", checked_modulus(modulus, young, poisson), poisson, branches)
    stiff = units.number("base_modulus", base_modulus, "Pa", above=0)
    base = _material("base_", stiff, base_poisson, base_branches)
    coated = Coated(film, base, units.number("thickness", thickness, "m", above=0))
    parameters: dict[str, Any] = {
        "poisson": film.poisson,
        "thickness": coated.thickness,
        "branches": film.branches,
        **{f"base_{name}": value for name, value in vars(base).items()},
    }
    creeping: tuple[CreepBranch, ...] = ()
    if film.branches or base.branches:
        _, times, _, error = shares_of(coated)
        if error > _LARGEST_ERROR:
            expected = "a film and a base that both keep a part of their stiffness"
            got = f"relaxation that no times up to {times[-1]:.3g} describe (error {error:.2g})"
            raise InputError("branches", expected=expected, got=got, advice="shares of less than 1 in sum")
        parameters["largest_error"] = error
        creeping = tuple(CreepBranch(CoatedStiffness(coated, n), time=time) for n, time in enumerate(times))
    return Solid(
        permanent=CoatedStiffness(coated),
        branches=creeping,
        parameters=parameters,
        loaded_from_afar=True,
        in_lengths=True,
        modulus=film.modulus,
        apparatus=checked_apparatus(apparatus),
        adhesion=adhesion,
        kind="coated_half_space",
    ).with_hardness(hardness)


def _material(prefix: str, modulus: float, poisson: float, branches: Branches) -> Material:
    try:
        checked = check_branches(branches)
    except InputError as error:
        raise InputError(f"{prefix}branches", expected=error.expected, got=error.got) from error
    return Material(modulus, checked_poisson(f"{prefix}poisson", poisson), checked)
