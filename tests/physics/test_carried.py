"""What a contact carries besides its load: current, heat, and shear; beside closed forms."""

import math

import numpy as np
import pytest

import asperity as asp
from tests.refusals import refuses

PIXEL, SITES = 1 / 256, 200
RADIUS, A = 8.0, 64 / 256
LOAD = 4 / 3 * A**3 / RADIUS  # Hertz: the contact has the radius A under E* = 1
MU, NU = 0.4, 0.3
RATIO = 2 * (1 - NU) / (2 - NU)
SOLID = asp.solids.half_space(modulus=1.0)


def squares(shape=(SITES, SITES), at=(0.5, 0.5), pixel=PIXEL):
    y, x = ((np.arange(n) - part * n + 0.5) * pixel for n, part in zip(shape, at, strict=True))
    return y[:, np.newaxis] ** 2 + x**2


def free(heights, pixel=PIXEL):
    return asp.surfaces.Surface(heights, pixel_size=(pixel, pixel), edges="free")


@pytest.fixture(scope="module")
def hertz():
    """A sphere whose contact is 64 sites in radius."""
    return asp.press(free(-squares() / (2 * RADIUS)), SOLID, load=LOAD)


def test_one_disc_has_the_resistance_of_holm(hertz):
    """R. Holm, *Electric Contacts* (1967): (rho_1 + rho_2) / (4 a)."""
    assert hertz.normal_stiffness == pytest.approx(2 * A, rel=2e-3)
    assert hertz.resistance(3.0) == pytest.approx(3.0 / (2 * A), rel=5e-3)
    assert hertz.resistance((1.0, 5.0)) == pytest.approx(hertz.resistance(3.0), rel=1e-12)
    assert hertz.thermal_resistance((1.0, 1 / 5)) == pytest.approx(hertz.resistance(3.0), rel=1e-12)
    assert hertz.tangential_stiffness(NU) == pytest.approx(RATIO * 2 * A, rel=2e-3)


def test_far_discs_conduct_side_by_side():
    """Conductances add, but for an influence of a / (pi d) of each on the other (J. A. Greenwood, 1966)."""
    shape, a = (64, 512), 12 * PIXEL
    discs = [np.where(squares(shape, (0.5, part)) <= a**2, 0.0, -1.0) for part in (0.125, 0.875)]
    one = asp.press(free(discs[0]), SOLID, load=1e-3)
    both = asp.press(free(np.maximum(*discs)), SOLID, load=2e-3)
    apart = 0.75 * shape[1] * PIXEL
    radius = 1 / (2 * one.resistance(1.0))
    expected = one.resistance(1.0) / 2 + 1 / (2 * math.pi * apart)
    assert both.resistance(1.0) == pytest.approx(expected, rel=2e-3)
    assert radius == pytest.approx(a, rel=0.02)


@pytest.mark.parametrize("part", [0.3, 0.95])
def test_a_sheared_sphere_sticks_and_gives_way_as_cattaneo_and_mindlin_say(hertz, part):
    """R. D. Mindlin, J. Appl. Mech. 16, 259 (1949): c / a = (1 - Q / (mu P))^(1/3)."""
    shear = part * MU * hertz.load
    slip = hertz.partial_slip(shear, MU, NU)
    radius = A * (1 - part) ** (1 / 3)
    assert math.sqrt(np.count_nonzero(slip.stick) / math.pi) == pytest.approx(radius / PIXEL, abs=1)
    assert not (slip.stick & slip.slip).any()
    np.testing.assert_array_equal(slip.stick | slip.slip, hertz.in_contact)
    assert slip.stick_fraction == pytest.approx((radius / A) ** 2, rel=0.02)
    way = MU / RATIO * A**2 / RADIUS * (1 - (1 - part) ** (2 / 3))
    assert slip.displacement == pytest.approx(way, rel=1e-3)
    assert slip.stiffness == pytest.approx(RATIO * 2 * radius, rel=2e-3)
    assert slip.traction.sum() * PIXEL**2 == pytest.approx(shear, rel=1e-6)
    np.testing.assert_allclose(slip.traction[slip.slip], MU * hertz.pressure[slip.slip], rtol=1e-12)


def test_a_cycle_loses_what_mindlin_and_deresiewicz_say():
    """R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20, 327 (1953), DOI 10.1115/1.4010702."""
    half = SITES // 2, SITES // 2
    sphere = free(-squares(half, pixel=2 * PIXEL) / (2 * RADIUS), 2 * PIXEL)
    part = 0.7
    slip = asp.press(sphere, SOLID, load=LOAD).partial_slip(part * MU * LOAD, MU, NU)
    rest = 1 - part
    lost = 1 - rest ** (5 / 3) - 5 * part / 6 * (1 + rest ** (2 / 3))
    scale = 24 * MU**2 * LOAD**2 / 5 * A**2 / (RADIUS * LOAD * RATIO)
    assert slip.energy_lost == pytest.approx(scale * lost, rel=5e-3)


def test_stiffness_is_the_derivative_of_the_load_on_rough_contacts():
    """By finite differences, on an aged contact: the area changes little while the load does."""
    heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=32.0, cutoff=8.0, seed=2, rms_height=0.1)
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])
    aged = asp.age(asp.press(free(heights, 1.0), solid, load=30.0), [3.0]).final
    more, less = (asp.press(aged, load=30.0 * factor) for factor in (1.01, 0.99))
    slope = (more.load - less.load) / (less.separation - more.separation)
    assert aged.normal_stiffness == pytest.approx(slope, rel=5e-3)


def test_units_are_read():
    surface = asp.surfaces.sphere((64, 64), radius="1 mm", pixel_size="1 um")
    contact = asp.press(surface, asp.solids.half_space(modulus="3 GPa"), load="1 mN")
    assert contact.resistance("17 nOhm m") == pytest.approx(contact.resistance(17e-9), rel=1e-12)
    assert contact.thermal_resistance(("200 mW/m/K", 400.0)) == contact.thermal_resistance((0.2, 400.0))
    assert contact.partial_slip("0.2 mN", MU).shear == pytest.approx(2e-4)


def test_what_cannot_be_told(hertz):
    for wrong in (0.0, (1.0, 2.0, 3.0), "17 nOhm m"):
        with refuses("units" if wrong == "17 nOhm m" else "resistivity"):
            hertz.resistance(wrong)
    heights = np.random.default_rng(0).normal(size=(16, 16))
    on_springs = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=1.0), load=5.0)
    layer = asp.press(heights, asp.solids.layer(modulus=1.0, poisson=0.3, thickness=3.0), load=5.0)
    for name, call in (
        ("shear", lambda: hertz.partial_slip(MU * LOAD, MU, NU)),
        ("friction", lambda: hertz.partial_slip(0.1 * LOAD, 0.0)),
        ("poisson", lambda: hertz.partial_slip(0.1 * LOAD, MU).stiffness),
        ("resistance", lambda: on_springs.resistance(1.0)),
        ("resistance", lambda: layer.thermal_resistance(1.0)),
        ("partial_slip", lambda: layer.partial_slip(0.1, MU)),
        ("tangential_stiffness", lambda: on_springs.tangential_stiffness(NU)),
    ):
        with refuses(name):
            call()
