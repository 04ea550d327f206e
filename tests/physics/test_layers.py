"""Elastic layers: the equations of elasticity solved wave by wave."""

import numpy as np
import pytest

import asperity as asp
from asperity.lattice import Lattice
from tests.continua import stiffness_of_a_wave


def pressure_of_a_wave(q, *, modulus, poisson, thickness, bonded):
    """On the base W = 0, and U = 0 or T = 0."""
    return stiffness_of_a_wave(q, modulus, poisson, thickness, np.eye(4)[:, [2, 3] if bonded else [0, 3]])


@pytest.mark.parametrize("bonded", [True, False], ids=["bonded", "sliding"])
@pytest.mark.parametrize("thickness", [0.01, 0.3, 2.0])
def test_stiffness_is_that_of_the_equations_of_elasticity(thickness, bonded):
    lattice = Lattice((16,), (0.7,))
    for poisson in (-0.5, 0.0, 0.3, 0.49, 0.5):
        layer = {"modulus": 3.0, "poisson": poisson, "thickness": thickness, "bonded": bonded}
        stiffness = asp.solids.layer(**layer).on(lattice).permanent / lattice.cell
        expected = [pressure_of_a_wave(q, **layer) for q in lattice.wave_number[1:].tolist()]
        np.testing.assert_allclose(stiffness[1:], expected, rtol=1e-6)
        if poisson < 0.5 or not bonded:
            uniform = pressure_of_a_wave(1e-4, **layer)
            assert stiffness[0] == pytest.approx(uniform, rel=1e-4)
