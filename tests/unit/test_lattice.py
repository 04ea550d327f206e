import numpy as np
import pytest

from asperity.lattice import Lattice
from tests.independent import laplacian
from tests.refusals import refuses


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
    for shape in ((), (0,), (3, 0), (2, 2, 2)):
        with refuses("shape"):
            Lattice(shape)


@pytest.mark.parametrize(("shape", "coarse"), [((12, 10), (5, 7)), ((12, 10), (6, 4)), ((11,), (4,))])
def test_long_waves_are_those_of_the_same_wave_numbers(shape, coarse):
    fine, coarse = Lattice(shape), Lattice(coarse)
    scale = [n / m for n, m in zip(coarse.shape, fine.shape, strict=True)]
    for axis, numbers in enumerate(fine.angles):
        spectrum = np.broadcast_to(numbers, fine.spectral_shape)
        expected = np.broadcast_to(coarse.angles[axis] * scale[axis], coarse.spectral_shape)
        np.testing.assert_allclose(np.abs(fine.long_waves(spectrum, coarse)), np.abs(expected), atol=1e-15)


@pytest.mark.parametrize(("shape", "coarse"), [((12, 10), (5, 7)), ((11,), (5,))])
def test_added_long_waves_are_a_smooth_field(shape, coarse):
    fine, coarse = Lattice(shape), Lattice(coarse)
    wave = [np.cos(2 * np.pi * 2 * np.arange(n[0]) / n[0] + 0.3) for n in (fine.shape, coarse.shape)]
    full, small = (
        w.reshape(-1, *(1,) * (fine.dimension - 1)) * np.ones(x.shape)
        for w, x in zip(wave, (fine, coarse), strict=True)
    )
    modes = np.zeros(fine.spectral_shape, complex)
    fine.add_long_waves(modes, coarse.forward(small), coarse)
    np.testing.assert_allclose(fine.backward(modes) * fine.sites / coarse.sites, full, atol=1e-14)
