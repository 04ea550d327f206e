from typing import Any

import numpy as np
import pytest

from asperity.lattice import Lattice
from asperity.solids import CreepBranch, LaplacianSpectrum, Solid, contact_modulus, half_space, spring_lattice
from tests.refusals import refuses


def test_spring_lattice_spectra():
    lattice = Lattice((6, 5))
    spectra = spring_lattice(k0=2.0, k1=3.0, R=0.5, R_viscous=0.1).on(lattice)
    np.testing.assert_allclose(spectra.permanent, 2.0 * lattice.lam)
    np.testing.assert_array_equal(spectra.creeping, np.full((1, 6, 3), 3.0))
    np.testing.assert_allclose(spectra.rate[0], 3.0 * (0.5 * lattice.lam + 0.1))
    np.testing.assert_array_equal(spectra.mean_mobility, [0.1])
    numbers = {"k0": 1.0, "k1": 3.0, "R": 1.0, "R_viscous": 0.0}
    assert spring_lattice(k0=np.float64(1), k1=3).parameters == numbers


def test_half_space_spectra():
    lattice = Lattice((6, 8))
    q = np.hypot(*np.meshgrid(2 * np.pi * np.fft.fftfreq(6), 2 * np.pi * np.fft.rfftfreq(8), indexing="ij"))
    spectra = half_space(modulus=3.0, branches=[(0.25, 4.0)]).on(lattice)
    np.testing.assert_allclose(spectra.permanent, 0.75 * 3.0 * q / 2)
    np.testing.assert_allclose(spectra.creeping, 0.25 * 3.0 * q[np.newaxis] / 2)
    (rate,) = spectra.rate
    assert rate[0, 0] == 0
    np.testing.assert_allclose(rate.flat[1:], 0.25)  # every wave but the mean relaxes in the same time
    elastic = half_space(modulus=1.0).on(Lattice((8,)))
    assert elastic.creeping.shape == elastic.rate.shape == (0, 5)


def test_contact_modulus_of_one_body_and_of_two():
    assert contact_modulus(3.0, 0.5) == 4.0
    assert 1 / contact_modulus([3.0, 210.0], [0.5, 0.3]) == pytest.approx(1 / 4 + 0.91 / 210)


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
