"""The simulation against closed forms."""

import numpy as np
import pytest

from asperity import age, press, relax
from asperity.aging import creep
from asperity.contact.contact import control_of
from asperity.solids import spring_lattice
from asperity.theory import (
    EmpiricalHeights,
    GaussianHeights,
    compliance,
    dilute_area,
    dilute_horizon,
    full_contact_load,
    full_contact_load_relaxed,
    site_stiffness,
    torus_compliance,
    winkler_area,
)
from tests.surfaces import correlated, uncorrelated


def spike(shape):
    """One asperity."""
    heights = np.full(shape, -10.0)
    heights[tuple(n // 3 for n in shape)] = 0.0
    return heights


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(64, 64), (64,), (15, 20)])
@pytest.mark.parametrize("R_viscous", [0.0, 0.2])
def test_one_contact_on_a_torus(shape, R_viscous):
    x1, load = 3.0, 0.5
    contact = press(spike(shape), spring_lattice(k0=1.0, k1=x1, R=1.0, R_viscous=R_viscous), load=load)
    times = np.array([1.0, 1e2, 1e4])
    separation = age(contact, times, rtol=1e-5).dataset["separation"].values
    expected = -load * torus_compliance(x1, np.concatenate([[0.0], times]), shape, viscous=R_viscous)
    deformation = contact.u.std()
    digits = 1e-12 if len(shape) > 1 else 1e-11  # conjugate gradients end at a residual of 1e-9
    np.testing.assert_allclose(separation[0], expected[0], rtol=digits)
    np.testing.assert_allclose(separation, expected, atol=1e-4 * deformation + 2e-4 * abs(expected[-1]))
    assert relax(contact).separation == pytest.approx(
        -load * torus_compliance(x1, np.inf, shape, viscous=R_viscous), rel=1e-11
    )


def test_site_stiffness_on_a_large_lattice():
    for x1 in (1.0, 10.0):
        contact = press(spike((200, 200)), spring_lattice(k0=2.0, k1=2.0 * x1), load=1.0)
        fall = -contact.separation
        assert 1.0 / fall / 2.0 == pytest.approx(site_stiffness(x1), rel=2e-4)


def test_independent_springs_are_the_winkler_foundation():
    rough = uncorrelated(64)
    solid = spring_lattice(k0=0.0, k1=3.0)
    for p in (1e-4, 0.03, 3.0, 30.0):
        contact = press(rough, solid, load=p * rough.size)
        expected = winkler_area(p, 3.0, EmpiricalHeights(rough))
        assert contact.area == round(float(expected) * rough.size)
        np.testing.assert_allclose(contact.u, np.maximum(rough, contact.separation), atol=1e-12)
    large = uncorrelated(1000, seed=5)
    share = press(large, solid, load=0.03 * large.size).area / large.size
    probability = float(winkler_area(0.03, 3.0, GaussianHeights()))
    assert abs(share - probability) < 3 * np.sqrt(probability / large.size)


@pytest.mark.parametrize("rough", [uncorrelated(32), correlated(32), uncorrelated(32)[0]])
def test_full_contact_begins_where_it_should(rough):
    solid = spring_lattice(k0=0.5, k1=2.0)
    at_once = full_contact_load(rough, k0=0.5, k1=2.0)
    assert press(rough, solid, load=at_once * (1 + 1e-9)).area == rough.size
    assert press(rough, solid, load=at_once * (1 - 1e-6)).area < rough.size
    relaxed = full_contact_load_relaxed(rough, k0=0.5)
    assert relax(press(rough, solid, load=relaxed * (1 + 1e-9))).area == rough.size
    assert relax(press(rough, solid, load=relaxed * (1 - 1e-6))).area < rough.size


@pytest.mark.parametrize(
    ("R", "R_viscous", "hold"), [(0.5, 0.0, "load"), (0.5, 0.2, "load"), (0.5, 0.2, "separation")]
)
def test_modes_decay_exponentially_in_full_contact(R, R_viscous, hold):
    k1 = 2.0
    rough = correlated(16)
    start = full_contact_load(rough, k0=1.0, k1=k1)
    contact = press(rough, spring_lattice(k0=1.0, k1=k1, R=R, R_viscous=R_viscous), load=3 * start)
    times = [0.01, 0.1, 0.5]
    qx, qy = (2 * np.pi * np.fft.fftfreq(n) for n in rough.shape)
    lam = 4 - 2 * np.cos(qx)[:, None] - 2 * np.cos(qy)[None, :]
    rate = k1 * (R * lam + R_viscous)
    if hold == "load":
        rate[0, 0] = 0.0
    before = np.fft.fft2(contact.u0 - rough)
    for frame in creep(contact, times, control=control_of(contact, hold), rtol=1e-5):
        assert frame.contact.area == rough.size
        exact = np.fft.ifft2(before * np.exp(-rate * frame.time)).real
        error = np.sqrt(np.mean((frame.contact.u0 - rough - exact) ** 2))
        # Where the mean of u0 creeps too, the stretch of the springs counts as deformation.
        scale = rough.std() if hold == "load" else np.sqrt(np.mean((rough - contact.u0) ** 2))
        assert error <= 1e-5 * scale


def test_dilute_theory_where_it_claims_to_hold():
    # The heights are the same on both sides, so that no sampling error enters; what is left is the
    # influence of contacts on each other, of relative size area fraction times range squared.
    rough = uncorrelated(256)
    p, x1 = 1e-3, 3.0
    contact = press(rough, spring_lattice(k0=1.0, k1=x1), load=p * rough.size)
    times = np.array([1.0, 1e2, 1e4])
    area = age(contact, times).dataset["area"].values
    fraction = dilute_area(p, compliance(x1, np.concatenate([[0.0], times])), EmpiricalHeights(rough))
    assert dilute_horizon(fraction[-1]) > times[-1]
    np.testing.assert_allclose(area / rough.size, fraction, rtol=0.06)
