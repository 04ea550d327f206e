"""Elastic layers: the equations of elasticity solved wave by wave, and the limits of thick and thin."""

import math

import numpy as np
import pytest
import scipy.linalg

import asperity as asp
from asperity.lattice import Lattice
from tests.continua import pressed
from tests.surfaces import correlated


def pressure_of_a_wave(q, *, modulus, poisson, thickness, bonded):
    """Pressure that gives the top of a layer a displacement cos(qx), by the equations of plane strain.

    The displacements are U sin(qx) and W cos(qx), the stresses T sin(qx) (shear) and S cos(qx) (normal). By
    the laws of Hooke and of equilibrium y = (U, W, T, S) obeys dy/dz = A y. Nothing shears the top, at z =
    thickness. On the base W = 0, and U = 0 or T = 0.
    """
    shear = modulus * (1 - poisson) / 2
    ratio = poisson / (1 - poisson)
    A = np.array(
        [
            [0, q, 1 / shear, 0],
            [-ratio * q, 0, 0, (1 - 2 * poisson) / (2 * shear * (1 - poisson))],
            [2 * shear / (1 - poisson) * q**2, 0, 0, ratio * q],
            [0, 0, -q, 0],
        ]
    )
    up = scipy.linalg.expm(A * thickness)[:, [2, 3] if bonded else [0, 3]]
    at_base = np.linalg.solve(up[[2, 1]], [0.0, 1.0])
    return up[3] @ at_base


@pytest.mark.parametrize("bonded", [True, False], ids=["bonded", "sliding"])
@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.3, 0.49, 0.5])
@pytest.mark.parametrize("thickness", [0.01, 0.3, 2.0])
def test_stiffness_is_that_of_the_equations_of_elasticity(thickness, poisson, bonded):
    lattice = Lattice((16,), (0.7,))
    layer = {"modulus": 3.0, "poisson": poisson, "thickness": thickness, "bonded": bonded}
    stiffness = asp.solids.layer(**layer).on(lattice).permanent / lattice.cell
    expected = [pressure_of_a_wave(q, **layer) for q in lattice.wave_number[1:].tolist()]
    np.testing.assert_allclose(stiffness[1:], expected, rtol=1e-6)
    if poisson < 0.5 or not bonded:
        uniform = pressure_of_a_wave(1e-4, **layer)
        assert stiffness[0] == pytest.approx(uniform, rel=1e-4)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
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


@pytest.mark.parametrize("bonded", [True, False], ids=["bonded", "sliding"])
def test_a_thick_layer_is_a_half_space(bonded):
    heights, load = correlated(48, hurst=0.8), 0.03 * 48**2
    deep = asp.solids.layer(modulus=2.0, poisson=0.3, thickness=100.0, bonded=bonded)
    contact, known = (
        pressed(heights, solid, load=load) for solid in (deep, asp.solids.half_space(modulus=2.0))
    )
    np.testing.assert_array_equal(contact.in_contact, known.in_contact)
    np.testing.assert_allclose(contact.force, known.force, atol=1e-4 * known.force.max())
    # The layer also hangs on its base, by the stiffness of even compression.
    assert contact.mean_gap == pytest.approx(known.mean_gap, rel=1e-3)


def test_an_incompressible_layer_resists_long_waves():
    # Lubrication theory: it must flow sideways, against 3 E* / (4 q^2 t^3).
    lattice = Lattice((64,))
    layer = asp.solids.layer(modulus=2.0, poisson=0.5, thickness=0.005).on(lattice).permanent
    q = lattice.wave_number[1:]
    np.testing.assert_allclose(layer[1:], 3 * 2.0 / (4 * q**2 * 0.005**3), rtol=1e-3)
    assert layer[0] > 1e3 * layer[1]


def test_a_viscoelastic_layer_relaxes_as_its_branches_do():
    # In full contact every mode decays at its branch's rate; the mean too, at a held separation.
    heights = 1e-3 * correlated(16)
    branches = [(0.3, 0.5), (0.5, 8.0)]
    solid = asp.solids.layer(modulus=1.0, poisson=0.3, thickness=3.0, branches=branches)
    contact = asp.press(heights, solid, separation=-1.0)
    assert contact.area == heights.size
    times = np.array([0.25, 2.0, 20.0])
    load = asp.age(contact, times, rtol=1e-4).dataset["load"].values
    modulus = 1 - sum(g * -np.expm1(-times / tau) for g, tau in branches)
    np.testing.assert_allclose(load[1:] / load[0], modulus, atol=1e-4)
    assert math.isclose(asp.relax(contact).load / load[0], 0.2, rel_tol=1e-8)
