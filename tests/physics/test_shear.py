"""Contacts that are sheared: against closed forms of ellipses, and dense matrices of Cerruti's solution."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe, ellipk

import asperity as asp
from asperity.contact.contact import Direction
from tests.refusals import each_refuses

MODULUS, SHAPE, SIDES = 2.0, (14, 12), (1.0, 1.5)
SOLID = asp.solids.half_space(modulus=MODULUS)


def surface(heights, edges, sides=SIDES):
    return asp.surfaces.Surface(heights, pixel_size=sides, edges=edges)


def ellipse(a, b, sites):
    """Squared distance from the middle of a square, 1 at half axes a along x and b along y."""
    y, x = np.mgrid[:sites, :sites] - sites / 2 + 0.5
    return (x / a) ** 2 + (y / b) ** 2


def ratios(a, b, nu):
    """Tangential over normal stiffness of an ellipse, a >= b: along it, and across it.

    R. D. Mindlin, J. Appl. Mech. 16, 259 (1949); P. J. Vermeulen, K. L. Johnson, ibid. 31, 338 (1964).
    """
    m = 1 - (b / a) ** 2
    c = (ellipk(m) - ellipe(m)) / (m * ellipk(m)) if m else 0.5
    return [(1 - nu) / (1 - nu + nu * part) for part in (c, 1 - c)]


@pytest.mark.parametrize(("a", "b"), [(30, 30), (36, 18), (36, 9), (45, 5)])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_one_ellipse_is_softer_along_than_across(a, b, nu):
    heights = np.where(ellipse(a, b, 96) <= 1, 0.0, -1.0)
    contact = asp.press(surface(heights, "free", (1.0, 1.0)), SOLID, load=1e-3)
    found = [contact.tangential_stiffness(nu, axis) / contact.normal_stiffness for axis in ("x", "y")]
    assert found == pytest.approx(ratios(a, b, nu), rel=1e-3)
    mean = contact.tangential_stiffness(nu) / contact.normal_stiffness
    assert mean == pytest.approx(2 * (1 - nu) / (2 - nu), rel=1e-3)  # of every ellipse
    if nu == 0:
        assert found == pytest.approx([1.0, 1.0])


def of_waves(shape, sides, nu):
    """Displacement of each site along y and x by a force of each, periodic; by sums over waves."""
    waves = (2 * np.pi * np.fft.fftfreq(n) / side for n, side in zip(shape, sides, strict=True))
    y, x = np.meshgrid(*waves, indexing="ij")
    q = np.hypot(y, x)
    q[0, 0] = np.inf
    alternating = (np.abs(y * sides[0]) > 3.1415) | (np.abs(x * sides[1]) > 3.1415)  # such waves have no sign
    cross = np.where(alternating, 0.0, -nu * y * x / q**3)
    shear = MODULUS * (1 - nu) / 2 * math.prod(sides)
    of = {(0, 0): 1 / q - nu * y**2 / q**3, (1, 1): 1 / q - nu * x**2 / q**3, (0, 1): cross, (1, 0): cross}
    at = np.indices(shape).reshape(2, -1)
    apart = tuple((at[:, :, None] - at[:, None]) % np.reshape(shape, (2, 1, 1)))
    return {key: np.fft.ifft2(values / shear).real[apart] for key, values in of.items()}


def of_pixels(shape, sides, nu):
    """The same on an endless surface: the solution of a point force, integrated over pixels by quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(30)
    shear, half = MODULUS * (1 - nu) / 2 * math.prod(sides), np.array(sides) / 2
    at = np.indices(shape).reshape(2, -1)
    matrices = {}
    for i, j in itertools.product((0, 1), (0, 1)):

        def kernel(*place, i=i, j=j):
            return ((1 - nu) * (i == j) + nu * place[i] * place[j] / np.hypot(*place) ** 2) / np.hypot(*place)

        def ray(angle, kernel=kernel):  # along a ray r cancels 1 / r
            one = np.sin(angle), np.cos(angle)
            return kernel(*one) * min(h / max(abs(way), 1e-99) for h, way in zip(half, one, strict=True))

        corner = math.atan2(*half)
        parts = [corner, math.pi - corner, math.pi + corner, 2 * math.pi - corner]
        table = np.empty([2 * n - 1 for n in shape])
        for place in np.ndindex(table.shape):
            apart = (np.array(place) + 1 - shape) * sides
            if not apart.any():
                table[place] = quad(ray, 0, 2 * math.pi, points=parts)[0]
                continue
            y, x = apart[0] + half[0] * nodes[:, None], apart[1] + half[1] * nodes
            table[place] = math.prod(half) * (weights @ kernel(y, x) @ weights)
        way = at[:, :, None] - at[:, None] + np.reshape(shape, (2, 1, 1)) - 1
        matrices[i, j] = table[tuple(way)] / (2 * math.pi * shear)
    return matrices


def rough(kind):
    heights = np.random.default_rng(1).normal(size=SHAPE)
    return heights if kind == "random" else 0.3 * heights + heights[:, :1]


@pytest.mark.parametrize("kind", ["random", "ridged"])
@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.5])
@pytest.mark.parametrize("edges", ["periodic", "reflecting", "free"])
def test_compliance_is_that_of_dense_matrices(edges, nu, kind):
    contact = asp.press(surface(rough(kind), edges), SOLID, load=8.0)
    sites = contact.in_contact
    if edges == "reflecting":
        sites = np.pad(sites, [(0, n) for n in SHAPE], mode="symmetric")
    dense = (of_pixels if edges == "free" else of_waves)(sites.shape, SIDES, nu)
    at = np.flatnonzero(sites)
    matrix = np.block([[dense[i, j][np.ix_(at, at)] for j in (0, 1)] for i in (0, 1)])
    together = np.kron(np.eye(2), np.ones((at.size, 1)))
    stiffness = together.T @ np.linalg.solve(matrix, together) * contact.area / at.size
    found, expected = contact.tangential_compliance(nu), np.linalg.inv(stiffness)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * expected.max())
    along = np.array([math.sin(0.5), math.cos(0.5)])
    soft = 1 / (along @ expected @ along)
    assert contact.tangential_stiffness(nu, math.degrees(0.5)) == pytest.approx(soft, rel=1e-9)


@pytest.mark.parametrize("edges", ["periodic", "reflecting", "free"])
def test_a_turned_surface_has_the_stiffness_of_the_other_axis(edges):
    contacts = [
        asp.press(surface(heights, edges, sides), SOLID, load=8.0)
        for heights, sides in ((rough("random"), SIDES), (np.rot90(rough("random")), SIDES[::-1]))
    ]
    (yy, yx, _, xx), turned = (contact.tangential_compliance(0.3).ravel() for contact in contacts)
    assert turned == pytest.approx([xx, -yx, -yx, yy], rel=1e-8, abs=1e-12)
    stick = contacts[0].partial_slip(1.0, 0.4, 0.3, "x").stick
    np.testing.assert_array_equal(np.rot90(stick), contacts[1].partial_slip(1.0, 0.4, 0.3, "y").stick)


@pytest.mark.parametrize(("edges", "direction"), [("periodic", 30.0), ("free", 30.0), ("free", "y")])
def test_each_site_sticks_or_slips_under_its_share_of_the_load(edges, direction):
    """Coulomb's law site by site, by a dense matrix; displacement and energy follow from the same."""
    contact, nu, mu, shear = asp.press(surface(rough("ridged"), edges), SOLID, load=8.0), 0.5, 0.4, 1.0
    dense = (of_pixels if edges == "free" else of_waves)(SHAPE, SIDES, nu)
    angle = math.radians(90 if direction == "y" else direction)
    along = math.sin(angle), math.cos(angle)
    matrix = sum(along[i] * along[j] * part for (i, j), part in dense.items())
    slip = contact.partial_slip(shear, mu, nu, direction)
    force, most = slip.traction.ravel() * math.prod(SIDES), mu * contact.force.ravel()
    slipped, stick = slip.displacement - matrix @ force, slip.stick.ravel()
    scale = 1e-7 * slip.displacement
    assert 0 < slip.stick_fraction < 1
    assert force.sum() == pytest.approx(shear)
    assert (force <= most * (1 + 1e-9)).all()
    np.testing.assert_allclose(slipped[stick], 0, atol=scale)
    np.testing.assert_allclose(force[~stick], most[~stick], rtol=1e-9)
    assert (slipped[slip.slip.ravel()] >= -scale).all()
    assert slip.energy_lost == pytest.approx(4 * most @ slipped, rel=1e-5)
    more = contact.partial_slip(1.00001 * shear, mu, nu, direction)
    slope = (more.shear - shear) / (more.displacement - slip.displacement)
    assert slip.stiffness == pytest.approx(slope, rel=1e-4)


def test_an_ellipsoid_gives_way_as_under_normal_loads():
    """H. Deresiewicz, J. Appl. Mech. 24, 623 (1957): Cattaneo's solution for an ellipse."""
    heights = -ellipse(2.0, 1.0, 96) / 50
    contact = asp.press(surface(heights, "free", (1.0, 1.0)), SOLID, load=300.0)
    (a, b), mu, nu = (np.count_nonzero(contact.in_contact.any(axis=axis)) / 2 for axis in (0, 1)), 0.4, 0.3
    part = 0.4
    less = asp.press(contact, load=(1 - part) * contact.load)
    directions: list[Direction] = ["x", "y"]
    for direction, ratio in zip(directions, ratios(a, b, nu), strict=True):
        slip = contact.partial_slip(part * mu * contact.load, mu, nu, direction)
        assert np.count_nonzero(slip.stick ^ less.in_contact) <= 8
        way = mu / ratio * (less.separation - contact.separation)
        assert slip.displacement == pytest.approx(way, rel=3e-3)
        weak = contact.partial_slip(1e-6 * contact.load, mu, nu, direction)
        assert weak.stiffness == pytest.approx(ratio * contact.normal_stiffness, rel=3e-3)


def test_what_has_no_shear():
    contact = asp.press(surface(rough("random"), "reflecting"), SOLID, load=8.0)
    wrong: Any = "z"
    flat = asp.press(surface(np.zeros((8, 8)), "periodic"), SOLID, load=8.0)
    assert flat.tangential_stiffness(0.3) == math.inf
    layer = asp.press(rough("random"), asp.solids.layer(modulus=1.0, poisson=0.3, thickness=3.0), load=5.0)
    each_refuses(
        ("tangential_compliance", "a layer", lambda: layer.tangential_compliance(0.3)),
        ("direction", "z", lambda: contact.tangential_stiffness(0.3, wrong)),
        ("direction", "30.0", lambda: contact.partial_slip(1.0, 0.4, 0.3, 30.0)),
        ("poisson", "0.6", lambda: contact.tangential_stiffness(0.6)),
    )
