"""Contacts that age without adhesion and are pulled apart at once; beside closed forms."""

import math
import re
import warnings
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.errors import Remark
from tests.refusals import each_refuses

HALF_SPACE = asp.solids.half_space(modulus=1.0)
pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.Remark")


def squares(count: int, off: tuple[float, float]) -> Any:
    y, x = (np.arange(count) - (count - 1) / 2 + shift for shift in off)
    return y[:, np.newaxis] ** 2 + x**2


def surface(heights: Any, edges: Any = "free") -> asp.surfaces.Surface:
    return asp.surfaces.Surface(heights, pixel_size=(1.0, 1.0), edges=edges)


def ball(
    radius: float, off: tuple[float, float] = (0.23, 0.41), *, sites: float = 1.25
) -> tuple[Any, float, float]:
    """A ball whose contact has a radius of some pixels at its pull-off of 1.5 pi w R, in units of E*."""
    curvature = 10 * radius
    work = 8 * radius**3 / (9 * math.pi * curvature**2)
    heights = -squares(2 * math.ceil(sites * radius) + 8, off) / (2 * curvature)
    return heights, work, 1.5 * math.pi * work * curvature


def punch(radius: float, sides: tuple[float, float] = (1.0, 1.0), off: Any = (0.23, 0.41)) -> Any:
    """A flat punch of a radius in lengths, on pixels with these sides."""
    y, x = (
        (np.arange(count) - (count - 1) / 2 + shift) * side
        for side, shift in zip(sides, off, strict=True)
        for count in [2 * math.ceil(radius / side) + 8]
    )
    inside = y[:, np.newaxis] ** 2 + x**2 <= radius**2
    return asp.surfaces.Surface(np.where(inside, 0.0, -1e3), pixel_size=sides, edges="free")


def kendall(contact: asp.Contact, work: float) -> float:
    """F = sqrt(8 pi E* w a^3), K. Kendall, J. Phys. D 4, 1186 (1971); a is the radius of the pixels' area."""
    area = contact.area * contact.lattice.cell
    return math.sqrt(8 * math.pi * work * (area / math.pi) ** 1.5)


@pytest.mark.parametrize(
    ("radius", "sides", "tolerance"),
    [
        (3, (1, 1), 0.05),
        (5.2, (1, 3), 0.06),
        (10, (1, 1), 0.02),
        (14.2, (1, 2), 0.02),
        (17.4, (3, 1), 0.02),
    ],
)
def test_a_flat_punch_lets_go_as_kendall_says_whatever_it_bore(radius, sides, tolerance):
    """The contact set is fixed, so that the force of the bodies alone makes the tension at the rim."""
    for off in ((0.0, 0.0), (0.23, 0.41)):
        heights = punch(radius, sides, off)
        expected = kendall(asp.press(heights, HALF_SPACE, load=0.1), 1e-3)
        pulls = []
        for ratio in (0.01, 20.0, 100.0):
            contact = asp.press(heights, HALF_SPACE, load=ratio * expected)
            pulled = contact.pull_off(1e-3)
            pulls.append(pulled.force)
            assert pulled.force == pytest.approx(expected, rel=tolerance)
            # It lets go at once, after the approach of a punch.
            onset = float(pulled.path["force"][1])
            assert onset == pytest.approx(-pulled.force, rel=0.01)
            way = (contact.load - onset) / -float(pulled.path["approach"][1])
            assert way == pytest.approx(contact.normal_stiffness, rel=2e-3)
        np.testing.assert_allclose(pulls, pulls[0], rtol=3e-3)


LAYER: Any = {"modulus": 1.0, "poisson": 0.3}
FILM = asp.solids.coated_half_space(**LAYER, thickness=8.0, base_modulus=10.0, base_poisson=0.3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solid", "edges"),
    [
        (HALF_SPACE, "periodic"),
        (HALF_SPACE, "reflecting"),
        (asp.solids.layer(**LAYER, thickness=4.0), "periodic"),
        (asp.solids.layer(**LAYER, thickness=20.0, bonded=False), "reflecting"),
        (FILM, "periodic"),
    ],
)
def test_pillars_let_go_as_their_compliance_says(solid, edges):
    """Griffith: F^2 / 2 dC/dA = -w, with the compliance C of pillars of other radii, fitted by a cubic."""

    def pressed(radius: float, load: float) -> asp.Contact:
        return asp.press(
            surface(np.where(squares(48, (0.23, 0.41)) <= radius**2, 0.0, -1e4), edges), solid, load=load
        )

    others = [pressed(radius, 1.0) for radius in range(7, 16)]
    radii = np.sqrt([contact.area / math.pi for contact in others])
    cubic = np.polyfit(radii, [1 / contact.normal_stiffness for contact in others], 3)
    slope = np.polyval(np.polyder(cubic), radii[4]) / (2 * math.pi * radii[4])
    expected = math.sqrt(-2e-3 / slope)
    for ratio in (0.01, 20.0):
        assert pressed(11.0, ratio * expected).pull_off(1e-3).force == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("apparatus", [np.inf, 30.0, 0.1])
def test_a_spring_beside_the_contact_changes_no_force(apparatus):
    heights = np.random.default_rng(3).normal(size=(32, 32))
    for rough in (heights, ball(8)[0]):
        alone, beside = (
            asp.press(
                surface(rough, "periodic"), asp.solids.half_space(modulus=1.0, apparatus=one), load=40.0
            )
            .pull_off(1e-2)
            .force
            for one in (None, apparatus)
        )
        assert beside == pytest.approx(alone, rel=1e-3)


def test_a_rough_plateau_in_full_contact_lets_go_whatever_it_bore():
    """Above a rough base that never touches; its top is pressed flat by either load."""
    rough = np.random.default_rng(3).normal(size=(32, 32))
    heights = np.where(squares(32, (0.0, 0.0)) <= 100, 1e-3 * rough, rough - 1e4)
    contacts = [asp.press(surface(heights), HALF_SPACE, load=load) for load in (5.0, 500.0)]
    assert contacts[0].area == contacts[1].area
    light, heavy = (contact.pull_off(1e-3).force for contact in contacts)
    assert heavy == pytest.approx(light, rel=3e-3)


@pytest.mark.parametrize(
    ("radius", "tolerance"),
    [
        (11, 0.05),
        pytest.param(16, 0.03, marks=pytest.mark.slow),
        pytest.param(32, 0.02, marks=pytest.mark.slow),
    ],
)
def test_a_ball_lets_go_as_johnson_kendall_and_roberts_say(radius, tolerance):
    """Proc. R. Soc. A 324, 301 (1971): 1.5 pi w R, whatever the load was; the radius is that at pull-off."""
    heights, work, expected = ball(radius)
    contact = asp.press(surface(heights), HALF_SPACE, load=4 / 3 * (1.2 * radius) ** 3 / (10 * radius))
    assert contact.pull_off(work).force == pytest.approx(expected, rel=tolerance)


AGING = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])


def relaxed(time: float) -> tuple[float, float]:
    """E(t) and E0 J(t) of that half-space, over E0."""
    return 0.5 + 0.5 * math.exp(-time), 2 - math.exp(-time / 2)


@pytest.mark.slow
@pytest.mark.parametrize("time", [0.5, 1.0, 4.0])
def test_an_aged_ball_lets_go_as_its_relaxed_modulus_says(time):
    """Within the first contact the crept ball is one of the curvature E(t) / (E0 R).

    What touched first carries the pressure of Hertz times E(t) / E0, and rings that joined later add that of
    flat punches, within which nothing bends (E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960)).
    So it lets go at 1.5 pi w R E0 / E(t), above 1.5 pi w R E0 J(t). Its edge begins to recede at
    P - sqrt(6 pi w R P E0 J(t)).
    """
    curvature, load = 90.0, 4 * 4 / 3 * 9.0**3 / 90.0
    work = 0.3 * 8 * 7.5**3 / (9 * math.pi * curvature**2)
    modulus, compliance = relaxed(time)
    heights = -squares(52, (0.23, 0.41)) / (2 * curvature)
    aged = asp.age(asp.press(surface(heights), AGING, load=load), [time]).final
    pulled = aged.pull_off(work)
    assert pulled.force == pytest.approx(1.5 * math.pi * work * curvature / modulus, rel=0.04)
    edge = load - math.sqrt(6 * math.pi * work * curvature * load * compliance)
    assert float(pulled.path["force"][1]) == pytest.approx(edge, abs=0.03 * load)
    assert pulled.ratio == pytest.approx(load / pulled.force, rel=1e-12)


def test_a_punch_that_ages_lets_go_as_at_first():
    """Its contact set is fixed, and separation is elastic with E0."""
    heights = punch(10)
    expected = kendall(asp.press(heights, AGING, load=1.0), 1e-3)
    contact = asp.press(heights, AGING, load=20 * expected)
    history = asp.age(contact, [1.0, 10.0], carried=asp.Carried(work_of_adhesion=1e-3))
    np.testing.assert_allclose(history.dataset["pull_off"], expected, rtol=0.02)


def test_two_far_balls_bear_twice_one_and_edges_mirror():
    """And a quarter of a ball at a reflecting corner bears a quarter."""
    heights, work, _ = ball(4, (0.0, 0.0))
    side = len(heights)
    wide = np.full((side, 6 * side), -10.0)
    wide[:, :side] = heights
    load = 4 / 3 * 5.0**3 / 40
    one = asp.press(surface(wide), HALF_SPACE, load=load).pull_off(work)
    wide[:, -side:] = heights
    two = asp.press(surface(wide), HALF_SPACE, load=2 * load).pull_off(work)
    assert two.force == pytest.approx(2 * one.force, rel=0.02)
    assert two.path["let_go"].size == 2
    np.testing.assert_allclose(two.path["let_go"], two.path["approach"].min(), rtol=0.02)
    whole = asp.press(surface(heights, "periodic"), HALF_SPACE, load=load).pull_off(work)
    corner = heights[side // 2 :, side // 2 :]
    quarter = asp.press(surface(corner, "reflecting"), HALF_SPACE, load=load / 4).pull_off(work)
    assert 4 * quarter.force == pytest.approx(whole.force, rel=2e-3)


def test_a_path_is_a_way_apart():
    """Approach and area never grow, patches let go one after the other, and the first site is the last."""
    heights = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=16.0, cutoff=6.0, seed=2, rms_height=0.05)
    contact = asp.press(surface(heights, "periodic"), HALF_SPACE, load=8.0)
    pulled = contact.pull_off(2e-3)
    path = pulled.path
    assert (np.diff(path["approach"]) <= 0).all()
    assert (np.diff(path["area"])[2:] < 0).all()
    assert (int(path["area"][0]), int(path["area"][-1])) == (contact.area, 0)
    assert float(path["force"][0]) == pytest.approx(contact.load, rel=1e-6)
    assert pulled.force == -float(path["force"].min())
    assert (np.isfinite(pulled.opened) == contact.in_contact).all()
    assert path["let_go"].size == asp.patches.patches(contact.in_contact, edges="periodic").count > 3
    assert len(np.unique(path["let_go"])) > 3
    more = contact.pull_off(4e-3)
    assert more.force > 1.5 * pulled.force  # and in other units the same
    stiffer = asp.press(surface(heights, "periodic"), asp.solids.half_space(modulus=10.0), load=80.0)
    assert stiffer.pull_off(2e-2).force == pytest.approx(10 * pulled.force, rel=1e-3)


def test_the_force_of_a_rough_contact_grows_with_the_work():
    """No site that is pressed opens with pulled ones beside it: nothing would be left that pulls."""
    heights = asp.surfaces.spectral((32, 32), roll_off=12.0, cutoff=3.0, rms_slope=0.1, seed=1)
    contact = asp.press(surface(heights, "periodic"), HALF_SPACE, load=3.41)
    forces = np.array([contact.pull_off(work).force for work in (1.7e-5, 1.7e-4, 1.7e-3)])
    assert forces[0] > 0
    assert (forces[1:] > 5 * forces[:-1]).all()


@pytest.mark.slow
def test_the_tack_of_a_rough_surface_grows_as_its_area_does():
    """C. Creton, L. Leibler (1996): at light load ~ A(t) ~ J(t)."""
    heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=32.0, cutoff=12.0, seed=2, rms_height=0.1)
    contact = asp.press(surface(heights, "periodic"), AGING, load=10.0)
    times = [0.5, 1.0, 4.0]
    series = asp.age(contact, times, carried=asp.Carried(work_of_adhesion=8e-3)).dataset
    growth = series["pull_off"].values / float(series["pull_off"][0])
    np.testing.assert_allclose(growth[1:], [relaxed(time)[1] for time in times], rtol=0.2)
    assert (np.diff(growth) > 0).all()


def test_a_front_at_the_end_of_a_body_opens_too():
    """A flat square with a pit: it has no site beyond its outer rim; and one without, beside a wider body."""
    heights = np.zeros((20, 20))
    alone = asp.press(surface(heights), HALF_SPACE, load=1.0).pull_off(1e-3)
    within = asp.press(surface(np.pad(heights, 6, constant_values=-10.0)), HALF_SPACE, load=1.0)
    assert alone.force == pytest.approx(within.pull_off(1e-3).force, rel=0.05)
    heights[9:12, 9:12] = -1.0
    pitted = asp.press(surface(heights), HALF_SPACE, load=1.0).pull_off(1e-3)
    assert 0.7 * alone.force < pitted.force < alone.force


def test_what_cannot_be_pulled():
    rough = np.random.default_rng(0).normal(size=(16, 16))
    contact = asp.press(rough, HALF_SPACE, load=5.0)
    springs = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=1.0), load=5.0)
    line = asp.press(rough[0], HALF_SPACE, load=1.0)
    full = asp.press(surface(1e-3 * rough, "periodic"), HALF_SPACE, load=100.0)
    each_refuses(
        *(("work", wrong, contact.pull_off, wrong) for wrong in (0.0, -1.0, "50 mJ")),
        ("units", "50 mJ/m^2", contact.pull_off, "50 mJ/m^2"),
        ("pull_off", "a spring lattice", springs.pull_off, 1.0),
        ("pull_off", "a line contact", line.pull_off, 1.0),
        ("pull_off", "full contact", full.pull_off, 1.0),
    )


@pytest.mark.filterwarnings("default::asperity.errors.Remark")
def test_few_pixels_and_little_load_are_remarked():
    heights, work, _ = ball(3)
    contact = asp.press(surface(heights), HALF_SPACE, load=4 / 3 * 3.5**3 / 30)
    with pytest.warns(Remark, match="by up to .. %") as found:
        contact.pull_off(work)
    assert any("less than 10 times" in str(one.message) for one in found)


@pytest.mark.filterwarnings("default::asperity.errors.Remark")
@pytest.mark.parametrize(
    ("radius", "wide"),
    [(4, 1.0), (6, 1.05), (8, 1.0), *(pytest.param(8, x, marks=pytest.mark.slow) for x in (1.1, 1.5))],
)
def test_the_error_of_a_ball_is_at_most_that_of_the_remark(radius, wide):
    """Beside 1.5 pi w R; from hardly wider than at the pull-off, to half as wide again."""
    for off in ((0.0, 0.0), (0.23, 0.41)):
        heights, work, expected = ball(radius, off, sites=1.25 * max(1.0, wide / 1.2))
        contact = asp.press(surface(heights), HALF_SPACE, load=4 / 3 * (wide * radius) ** 3 / (10 * radius))
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            error = contact.pull_off(work).force / expected - 1
        (said, *_) = [*re.findall(r"up to (\d+) %", " ".join(str(one.message) for one in found)), "5"]
        assert 0 < error < int(said) / 100
