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


@pytest.mark.parametrize("name", ["k0", "k1", "R", "R_viscous"])
def test_parameters_are_checked_when_the_solid_is_built(name):
    with refuses(name):
        spring_lattice(**({"k0": 1.0, "k1": 3.0} | {name: -1.0}))


def test_all_stiffness_zero_is_refused():
    with refuses("k0 and k1"):
        spring_lattice(k0=0.0, k1=0.0)


def test_numbers_of_any_real_kind_are_accepted():
    assert spring_lattice(k0=np.float64(1), k1=3).parameters == {
        "k0": 1.0,
        "k1": 3.0,
        "R": 1.0,
        "R_viscous": 0.0,
    }


def solid(permanent=None, stiffness=None, mobility=None):
    return Solid(
        permanent=permanent or LaplacianSpectrum(laplacian=1.0),
        branches=(
            CreepBranch(
                stiffness=stiffness or LaplacianSpectrum(uniform=1.0),
                mobility=mobility or LaplacianSpectrum(laplacian=1.0),
            ),
        ),
    )


@pytest.mark.parametrize(
    ("wrong", "name"),
    [
        (solid(stiffness=LaplacianSpectrum(laplacian=1.0)), "creeping stiffness"),
        (solid(mobility=LaplacianSpectrum(uniform=-1.0)), "mobility"),
        (solid(stiffness=lambda _: np.ones(3)), "creeping stiffness"),
        (solid(stiffness=lambda lattice: np.where(lattice.lam == 0, 1.0, np.nan)), "creeping stiffness"),
    ],
)
def test_spectra_are_checked_on_the_lattice(wrong, name):
    with refuses(name):
        wrong.on(Lattice((4, 4)))


def test_half_space_spectra():
    lattice = Lattice((6, 8))
    q = np.hypot(*np.meshgrid(2 * np.pi * np.fft.fftfreq(6), 2 * np.pi * np.fft.rfftfreq(8), indexing="ij"))
    spectra = half_space(modulus=3.0, branches=[(0.25, 4.0)]).on(lattice)
    np.testing.assert_allclose(spectra.permanent, 0.75 * 3.0 * q / 2)
    np.testing.assert_allclose(spectra.creeping, 0.25 * 3.0 * q[np.newaxis] / 2)
    (rate,) = spectra.rate
    assert rate[0, 0] == 0
    np.testing.assert_allclose(rate.flat[1:], 0.25)  # every wave but the mean relaxes in the same time


def test_a_half_space_that_does_not_creep():
    spectra = half_space(modulus=1.0).on(Lattice((8,)))
    assert spectra.creeping.shape == spectra.rate.shape == (0, 5)


@pytest.mark.parametrize(
    ("wrong", "name"),
    [
        ({"modulus": 0.0}, "modulus"),
        ({"modulus": "1"}, "modulus"),
        ({"branches": [(0.5, -1.0)]}, "relaxation time of branch 1"),
        ({"branches": [(1.5, 1.0)]}, "share of branch 1"),
        ({"branches": [(0.5, 1.0), (np.nan, 1.0)]}, "share of branch 2"),
        ({"branches": [(0.5, 1.0), (0.6, 1.0)]}, "branches"),
        ({"flow": (1.0, 0.0), "branches": [(0.5, 1.0)]}, "flow"),
        ({"apparatus": 0.0}, "apparatus"),
    ],
)
def test_half_space_parameters_are_checked(wrong, name):
    with refuses(name):
        half_space(**{"modulus": 1.0, **wrong})


def test_only_the_mean_may_have_no_stiffness():
    soft = Solid(
        permanent=lambda lattice: np.where(lattice.lam > 1, lattice.lam, 0.0),
        branches=(
            CreepBranch(stiffness=LaplacianSpectrum(laplacian=0.0), mobility=LaplacianSpectrum(uniform=1.0)),
        ),
        loaded_from_afar=True,
    )
    with refuses("stiffness"):
        soft.on(Lattice((16,)))


def test_contact_modulus_of_one_body_and_of_two():
    assert contact_modulus(3.0, 0.5) == 4.0
    assert 1 / contact_modulus([3.0, 210.0], [0.5, 0.3]) == pytest.approx(1 / 4 + 0.91 / 210)


@pytest.mark.parametrize(
    ("young", "poisson", "name"),
    [(0.0, 0.3, "young"), (1.0, 0.6, "poisson"), ([1.0, 2.0], 0.3, "young and poisson")],
)
def test_elastic_constants_are_checked(young, poisson, name):
    with refuses(name):
        contact_modulus(young, poisson)
