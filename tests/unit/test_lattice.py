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
