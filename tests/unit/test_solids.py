from typing import Any

import numpy as np

from asperity.lattice import Lattice
from asperity.solids import CreepBranch, LaplacianSpectrum, Solid, contact_modulus, half_space, spring_lattice
from tests.refusals import refuses


def test_what_is_no_solid_is_refused():
    modulus, springs = {"modulus": 1.0}, {"k0": 1.0, "k1": 3.0}
    made: list[tuple[str, Any, dict[str, Any]]] = [
        *((name, spring_lattice, springs | {name: -1.0}) for name in ("k0", "k1", "R", "R_viscous")),
        ("k0 and k1", spring_lattice, {"k0": 0.0, "k1": 0.0}),
        ("modulus", half_space, {"modulus": 0.0}),
        ("modulus", half_space, {"modulus": "1"}),
        ("relaxation time of branch 1", half_space, modulus | {"branches": [(0.5, -1.0)]}),
        ("branches", half_space, modulus | {"branches": [(0.5, 1.0), (0.6, 1.0)]}),
        ("flow", half_space, modulus | {"flow": (1.0, 0.0), "branches": [(0.5, 1.0)]}),
        ("apparatus", half_space, modulus | {"apparatus": 0.0}),
        ("young", contact_modulus, {"young": 0.0, "poisson": 0.3}),
        ("poisson", contact_modulus, {"young": 1.0, "poisson": 0.6}),
        ("young and poisson", contact_modulus, {"young": [1.0, 2.0], "poisson": 0.3}),
    ]
    for name, make, wrong in made:
        with refuses(name):
            make(**wrong)


def test_spectra_are_checked_on_the_lattice():
    uniform, neighbors = LaplacianSpectrum(uniform=1.0), LaplacianSpectrum(laplacian=1.0)
    soft = Solid(
        lambda lattice: np.where(lattice.lam > 1, lattice.lam, 0.0),
        (CreepBranch(LaplacianSpectrum(laplacian=0.0), uniform),),
        loaded_from_afar=True,  # so the mean may have no stiffness, but nothing else
    )
    branches: list[tuple[str, Any, Any]] = [
        ("creeping stiffness", LaplacianSpectrum(laplacian=1.0), neighbors),
        ("mobility", uniform, LaplacianSpectrum(uniform=-1.0)),
        ("creeping stiffness", lambda _: np.ones(3), neighbors),
        ("creeping stiffness", lambda lattice: np.where(lattice.lam == 0, 1.0, np.nan), neighbors),
    ]
    solids = [(name, Solid(neighbors, (CreepBranch(*laws),))) for name, *laws in branches]
    for name, solid in (*solids, ("stiffness", soft)):
        with refuses(name):
            solid.on(Lattice((16,)))
