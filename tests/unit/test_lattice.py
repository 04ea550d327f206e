import numpy as np
import pytest

from asperity.errors import InputError
from asperity.lattice import Lattice
from tests.independent import laplacian

SHAPES = [(1,), (2,), (5,), (6,), (5, 4), (4, 7), (9, 9), (2, 3), (1, 6)]


@pytest.mark.parametrize("shape", SHAPES)
def test_lam_is_the_spectrum_of_minus_the_laplacian(shape):
    field = np.random.default_rng(0).normal(size=shape)
    lattice = Lattice(shape)
    np.testing.assert_allclose(lattice.apply(lattice.lam, field), -laplacian(field), atol=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
def test_transforms_invert_each_other_and_the_zero_mode_is_the_sum(shape):
    field = np.random.default_rng(1).normal(size=shape)
    lattice = Lattice(shape)
    modes = lattice.forward(field)
    assert modes.shape == lattice.spectral_shape
    np.testing.assert_allclose(lattice.backward(modes), field, atol=1e-14)
    assert modes.flat[0].real == pytest.approx(field.sum(), abs=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_mean_over_modes_is_the_diagonal_and_obeys_parseval(shape):
    lattice = Lattice(shape)
    spike = np.zeros(shape)
    spike.flat[0] = 1.0
    assert lattice.mean_over_modes(lattice.lam) == pytest.approx(-laplacian(spike).flat[0], abs=1e-13)
    field = np.random.default_rng(2).normal(size=shape)
    power = np.abs(lattice.forward(field)) ** 2
    assert lattice.mean_over_modes(power) == pytest.approx(np.sum(field**2))


@pytest.mark.parametrize("shape", [(), (0,), (3, 0), (2, 2, 2)])
def test_other_shapes_are_refused(shape):
    with pytest.raises(InputError, match="shape: expected one or two positive lengths"):
        Lattice(shape)
