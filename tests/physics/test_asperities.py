"""Single asperities on half-spaces with free edges: Hertz, Johnson, Lee and Radok, and a dense program."""

import numpy as np
import pytest
import scipy.optimize
from scipy.special import ellipe, ellipk

import asperity as asp
from tests.continua import love
from tests.dense_reference import Dense

E = 3e9
SOLID = asp.solids.half_space(modulus=E)
OFFSETS = [(0, 0.5), (0.125, 0.375), (0.2, 0.2), (0.3, 0.05)]
P = asp.protocols


def spread(contact, axis):
    """Mean square distance of the load from its center along an axis."""
    place = contact.lattice.spacing[axis] * np.arange(contact.heights.shape[axis])
    share = contact.force.sum(axis=1 - axis) / contact.load
    return share @ (place - share @ place) ** 2


def radius_of(contact):
    """Radius of a contact with the pressure of Hertz, of which the mean square distance is 2 a^2 / 5."""
    return np.sqrt(2.5 * (spread(contact, 0) + spread(contact, 1)))


def test_a_ball_is_pressed_as_hertz_has_it():
    # A radius of 64 pixels, wherever the summit is between sites; a ball so large that it is a paraboloid.
    pixel, sites = 1e-6, 154
    a, radius = 64 * pixel, 1000 * 64 * pixel
    load = 4 * E * a**3 / (3 * radius)
    largest, approach = 3 * load / (2 * np.pi * a**2), a**2 / radius
    found = []
    for y, x in OFFSETS:
        places = [[(sites / 2 + y) * pixel, (sites / 2 + x) * pixel]]
        ball = asp.surfaces.array((sites, sites), places=places, radii=radius, pixel_size=pixel)
        contact = asp.press(ball, SOLID, load=load)
        counted = np.sqrt(np.array([contact.contact_area, contact.contact_area_corrected]) / np.pi)
        measured = *counted / a, contact.normal_stiffness / (2 * E * a), radius_of(contact) / a
        found.append([*measured, contact.largest_pressure / largest, -contact.separation / approach])
    misses = np.array(found) - 1
    counted, corrected, stiffness = misses.mean(axis=0)[:3]
    assert 0 < counted < 2.5e-3
    assert abs(corrected) < 1e-3
    assert abs(stiffness) < 5e-4
    assert np.abs(misses[:, 3:]).max() < 1e-4


@pytest.mark.parametrize("ratio", [1, 3, 1 / 3, 5, 1 / 5])
@pytest.mark.parametrize("body", ["ball", "cone"])
def test_the_corrected_area_does_not_depend_on_the_shape_of_pixels(body, ratio):
    """Hertz' ball and Sneddon's cone: a radius is 24 sides of a square pixel of the same area."""
    sides, misses = (ratio**-0.5, ratio**0.5), []
    for i in range(9):
        a = 24 * (1 + i / 90)
        y, x = (
            (np.arange(int(2.6 * a / side) + 4) - int(1.3 * a / side) - shift) * side
            for side, shift in zip(sides, (0.618 * i % 1, 0.382 * i % 1), strict=True)
        )
        r = np.hypot(y[:, None], x)
        heights, load = (
            (-0.01 * r, np.pi * a**2 * 0.01 / 2) if body == "cone" else (-(r**2) / 4800, a**3 / 1800)
        )
        scan = asp.surfaces.Surface(heights, unit="m", pixel_size=sides, length_unit="m", edges="free")
        contact = asp.press(scan, asp.solids.half_space(modulus=1.0), load=load)
        misses.append(contact.contact_area_corrected / (np.pi * a**2) - 1)
    assert abs(np.mean(misses)) < 5e-3


def ellipse(load, flat, steep):
    """Half axes, largest pressure and approach: K. L. Johnson, Contact Mechanics, Eqs. (4.24) to (4.28)."""

    def ratio_of(m):  # of the curvatures, with m = e^2
        return (ellipk(m) - ellipe(m)) / (ellipe(m) / (1 - m) - ellipk(m))

    m = scipy.optimize.brentq(lambda m: ratio_of(m) - steep / flat, 1e-6, 1 - 1e-9, xtol=1e-14)
    a = np.cbrt(3 * load * flat * (ellipk(m) - ellipe(m)) / (np.pi * E * m))
    b = a * np.sqrt(1 - m)
    largest = 3 * load / (2 * np.pi * a * b)
    return a, b, largest, largest * b * ellipk(m) / E


@pytest.mark.parametrize("ratio", [1.5, 16.0])
def test_two_radii_make_an_ellipse(ratio):
    pixel, steep = 1e-6, 0.1
    a, b, largest, approach = ellipse(1.0, ratio * steep, steep)
    load = (32 * pixel / b) ** 3
    a, b, largest, approach = ellipse(load, ratio * steep, steep)
    assert b == pytest.approx(32 * pixel)
    shape = (80, 2 * int(1.2 * a / pixel))
    body = asp.surfaces.paraboloid(shape, radius=(steep, ratio * steep), pixel_size=pixel)
    contact = asp.press(body, SOLID, load=load)
    assert np.sqrt(5 * spread(contact, 0)) == pytest.approx(b, rel=3e-4)
    assert np.sqrt(5 * spread(contact, 1)) == pytest.approx(a, rel=3e-4)
    assert contact.largest_pressure == pytest.approx(largest, rel=3e-4)
    assert -contact.separation == pytest.approx(approach, rel=1e-4)


@pytest.mark.parametrize(("cells", "within"), [(8, 4e-3), (16, 1e-3), (64, 1e-4)])
def test_a_flat_punch_is_as_stiff_as_a_circle_less_a_tenth_of_a_pixel(cells, within):
    # The area of its sites defines a; at the edge even pressures on pixels miss a part of what is singular.
    for more in (0.0, 0.3, 0.6, 0.9):
        body = asp.surfaces.punch(2 * (int(2.5 * cells),), radius=cells + more, pixel_size=1.0)
        contact = asp.press(body, SOLID, load=1.0)
        np.testing.assert_array_equal(contact.in_contact, body.heights == 0)
        radius = np.sqrt(contact.contact_area / np.pi) - 0.116
        assert contact.normal_stiffness == pytest.approx(2 * E * radius, rel=within)
        assert -contact.separation * contact.normal_stiffness == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("distance", [4.0, 8.0])
def test_two_balls_feel_each_other(distance):
    # Each is lowered by what the other displaces, F / (pi E* d), and flattened by its curvature, as in the
    # closed form of `asperity.theory.continua` for an array (with one other, c = -1 and k = 1/4). On the
    # slope g = F / (pi E* d^2) a contact rests s = R g further out: that takes 2 g s - s^2 / 2 R off.
    a, radius = 16.0, 1e4
    d, load = distance * a, 4 * E * a**3 / (3 * radius)
    near = load / (np.pi * E)
    flattened = 1 / (1 / radius + near / (2 * d**3))
    contact_radius = np.cbrt(3 * load * flattened / (4 * E))
    approach = contact_radius**2 / flattened + near * (1 / d + 0.1 * contact_radius**2 / d**3)
    approach -= 1.5 * radius * (near / d**2) ** 2
    shape = (48, 48 + int(d))
    alone = asp.surfaces.array(shape, places=[[23.5, 23.5]], radii=radius, pixel_size=1.0)
    both = asp.surfaces.array(shape, places=[[23.5, 23.5], [23.5, 23.5 + d]], radii=radius, pixel_size=1.0)
    one, two = asp.press(alone, SOLID, load=load), asp.press(both, SOLID, load=2 * load)
    further = one.separation - two.separation
    assert further == pytest.approx(approach - a**2 / radius, rel=0.5 / distance**4 + 2e-4)
    assert further == pytest.approx(near / d, rel=0.6 / distance**2)
    assert two.force[:, : shape[1] // 2].sum() == pytest.approx(load, rel=1e-8)


@pytest.mark.parametrize("share", [0.6, 1.0], ids=["standard linear solid", "Maxwell"])
def test_a_ball_under_constant_load_follows_lee_and_radok(share):
    # E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020. While the contact
    # grows, a is that of Hertz under F J(t), and what each growth adds to the pressures of Hertz relaxes:
    # any linear measure X(a) of them, for a modulus of 1, becomes the integral of E(t - s) dX(a(s)).
    radius, first, rest = 1e4, 20.0, 1 - share
    load = 4 * E * first**3 / (3 * radius)
    ball = asp.surfaces.sphere((72, 72), radius=radius, pixel_size=1.0)
    contact = asp.press(ball, asp.solids.half_space(modulus=E, branches=[(share, 1.0)]), load=load)
    for time in (0.3, 3.0):
        s = np.linspace(0, time, 5001)
        creep = 1 + s if rest == 0 else (1 - share * np.exp(-rest * s)) / rest  # E* J(s), tau = 1
        a = np.cbrt(0.75 * radius * load * creep / E)
        modulus = E * (rest + share * np.exp(0.5 * (s[1:] + s[:-1]) - time))

        def relaxed(measure, modulus=modulus, time=time):
            return E * (rest + share * np.exp(-time)) * measure[0] + modulus @ np.diff(measure)

        aged = asp.age(contact, [time], rtol=1e-3).final
        assert -aged.separation == pytest.approx(a[-1] ** 2 / radius, rel=2e-4)
        assert np.sqrt(aged.contact_area_corrected / np.pi) == pytest.approx(a[-1], abs=0.15)
        assert load == pytest.approx(relaxed(4 / (3 * radius) * a**3), rel=1e-6)
        square = relaxed(8 / (15 * radius) * a**5) / load
        assert spread(aged, 0) + spread(aged, 1) == pytest.approx(square, rel=1e-3)
        middle = aged.pressure[35:37, 35:37].mean()
        assert middle == pytest.approx(2 / (np.pi * radius) * relaxed(a), rel=1e-3)


SHAPE, SIDES, BRANCHES = (16, 20), (1.0, 0.75), [(0.3, 0.5), (0.5, 5.0)]
BALLS = asp.surfaces.array(
    SHAPE, places=[[4.0, 5.0], [9.0, 9.0]], radii=[40.0, 60.0], heights=[0.0, 0.1], pixel_size=SIDES
)


@pytest.fixture(scope="module")
def dropped():
    """Forces, position and contacts by a dense program after a hold, a drop and two more holds; relaxed."""
    compliance = love(SHAPE, SIDES) / 0.75
    dense, v, found = Dense.of_compliance(BALLS.heights, compliance, BRANCHES), np.zeros((2, 320)), []
    for duration, load in ((1.0, 2.0), (0.2, 0.5), (4.0, 0.5)):
        v = dense.creep(v, duration, load_at=lambda _, load=load: load)
        found.append((dense.contact(v, load), dense.touching))
    relaxed = Dense.of_compliance(BALLS.heights, 5 * compliance)
    return [*found, (relaxed.contact([], 2.0), relaxed.touching)]


@pytest.mark.parametrize("exact", [True, False])
def test_a_drop_of_the_load_is_what_a_dense_program_finds(dropped, exact):
    frames: list[asp.Frame] = []
    start = asp.press(BALLS, asp.solids.half_space(modulus=1.0, branches=BRANCHES), load=2.0)
    protocol = [P.Hold(1.0), P.Step(load=0.5), P.Hold(4.2)]
    asp.age(start, [1.0, 1.2, 5.2], protocol=protocol, exact=exact, rtol=3e-5, progress=frames.append)
    states = [*(frames[number].contact for number in (1, 3, 4)), asp.relax(start)]
    for state, ((_, position, force), touching) in zip(states, dropped, strict=True):
        np.testing.assert_array_equal(state.in_contact.ravel(), touching)
        np.testing.assert_allclose(state.force.ravel(), force * touching, atol=2e-4 * force.max())
        assert state.separation == pytest.approx(position, rel=2e-5)
    touched = [state.area for state in states]
    assert touched[0] > touched[2] > touched[1] > 0  # the drop loses contacts, and creep wins some anew
