"""Elastic layers: the equations of elasticity solved wave by wave, and the limits of thick and thin."""

import numpy as np
import pytest

import asperity as asp
from asperity.lattice import Lattice
from tests.continua import pressed, stiffness_of_a_wave


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


@pytest.mark.parametrize("poisson", [0.0, 0.45])
@pytest.mark.parametrize("bonded", [True, False], ids=["bonded", "sliding"])
def test_a_thin_layer_is_a_bed_of_springs(bonded, poisson):
    # A sphere on springs of stiffness k for each area: F = pi k a^4 / (4 R).
    E, thickness, radius, n = 2.0, 0.002, 5.0, 128
    k = E / thickness * ((1 - poisson) ** 2 / (1 - 2 * poisson) if bonded else 1.0)
    x = (np.arange(n) + 0.5) / n - 0.5
    y = (np.arange(n // 2) + 0.5) / (n // 2) - 0.5
    heights = -(y[:, None] ** 2 + x**2) / (2 * radius)
    load = np.pi * k * 0.3**4 / (4 * radius)
    solid = asp.solids.layer(modulus=E, poisson=poisson, thickness=thickness, bonded=bonded)
    contact = pressed(heights, solid, load=load, spacing=(2 / n, 1 / n))
    # A bed of springs touches where the heights exceed a level: its sites need no correction for the rim.
    assert contact.contact_area == pytest.approx(np.pi * 0.3**2, rel=5e-3)
    assert contact.largest_pressure == pytest.approx(k * 0.3**2 / (2 * radius), rel=2e-3)
    assert -contact.separation == pytest.approx(0.3**2 / (2 * radius), rel=3e-4)
    assert contact.normal_stiffness == pytest.approx(np.pi * k * 0.3**2, rel=5e-3)
    again = pressed(heights, solid, separation=contact.separation, spacing=(2 / n, 1 / n))
    assert again.load == pytest.approx(load, rel=1e-6)
