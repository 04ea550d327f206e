"""Lattices with their transforms, and solids: what is refused."""

from functools import partial
from typing import Any

import numpy as np
import pytest

from asperity.lattice import Lattice
from asperity.solids import (
    CreepBranch,
    LaplacianSpectrum,
    Norton,
    Solid,
    Springs,
    contact_modulus,
    half_space,
    spring_lattice,
)
from tests.independent import laplacian
from tests.refusals import each_refuses, refuses


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
        ("poisson", contact_modulus, {"young": [1.0, 2.0], "poisson": 0.3}),
    ]
    each_refuses(
        *((name, partial(make, **wrong)) for name, make, wrong in made),
        got=(
            "-1.0 | -1.0 | -1.0 | -1.0 | both 0 | 0.0 | '1' | -1.0 | 1.1 together | 1 branches | 0.0 | "
            "0.0 | 0.6 | 1"
        ),
    )


def test_a_ratio_that_is_not_given_is_that_of_the_commands():
    assert half_space(young="3 GPa").modulus == pytest.approx(3e9 / (1 - 0.35**2))
    assert contact_modulus([3e9, 7e9]) == contact_modulus([3e9, 7e9], [0.35, 0.35])


def test_what_is_stated_twice_or_in_part_is_refused():
    law, springs = LaplacianSpectrum(uniform=1.0), Springs(1.0, 3.0)
    shares: dict[str, Any] = {"stiffness": law, "shares": [(0.5, 1.0)]}
    made: list[tuple[str, dict[str, Any]]] = [
        ("permanent", {"permanent": law, "springs": springs}),
        ("branches", {"branches": [CreepBranch(law, law)], **shares}),
        ("stiffness", {"shares": [(0.5, 1.0)]}),
        ("branches", shares | {"shares": [(0.5, 1.0), (0.6, 1.0)]}),
        ("modulus", shares | {"half_space": True}),
    ]
    each_refuses(
        *((name, partial(Solid, **wrong)) for name, wrong in made), got="both | both | none | 1.1 | none"
    )
    assert Solid(**shares).with_hardness(1.0).branches == Solid(**shares).branches
    creeping = Solid(springs=springs, creep=Norton(1.0, 1.0, 2.0))
    assert creeping.without_law().springs == Springs(1.0, 3.0, 0.0, 3.0)


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


@pytest.mark.parametrize("shape", [(1,), (2,), (5,), (5, 4), (4, 7), (1, 6)])
def test_transforms_and_the_laplacian(shape):
    field, lattice = np.random.default_rng(0).normal(size=shape), Lattice(shape)
    np.testing.assert_allclose(lattice.apply(lattice.lam, field), -laplacian(field), atol=1e-13)
    modes = lattice.forward(field)
    assert modes.shape == lattice.spectral_shape
    np.testing.assert_allclose(lattice.backward(modes), field, atol=1e-14)
    assert modes.flat[0].real == pytest.approx(field.sum(), abs=1e-12)
    # The mean over modes is the diagonal, and obeys Parseval.
    spike = np.zeros(shape)
    spike.flat[0] = 1.0
    assert lattice.mean_over_modes(lattice.lam) == pytest.approx(-laplacian(spike).flat[0], abs=1e-13)
    assert lattice.mean_over_modes(np.abs(modes) ** 2) == pytest.approx(np.sum(field**2))


def test_other_shapes_are_refused():
    each_refuses(
        *(("shape", Lattice, shape) for shape in ((), (0,), (3, 0), (2, 2, 2))), got="() | 0 | 0 | (2, 2, 2)"
    )
