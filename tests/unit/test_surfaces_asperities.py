"""Single asperities: their shapes in closed form, their units, and what is refused."""

from typing import Any

import numpy as np
import pytest

from asperity.surfaces import Surface, array, paraboloid, punch, sphere
from tests.refusals import refuses

MICRON = 1e-6


def middle(n, step):
    return step * (np.arange(n) - (n - 1) / 2)


def test_a_ball_is_exact_and_stands_on_a_flat_at_its_center():
    shape, steps, radius = (40, 61), (1e-6, 0.5e-6), 12e-6
    ball = sphere(shape, radius=radius, pixel_size=steps)
    y, x = (middle(n, step) for n, step in zip(shape, steps, strict=True))
    distance = np.hypot(y[:, None], x)
    # Each point of the ball is at the distance R from its center, which is R below its summit.
    on_it = distance <= radius
    np.testing.assert_allclose(np.hypot(distance, ball.heights + radius)[on_it], radius, rtol=1e-14)
    assert (ball.heights[~on_it] == -radius).all()
    assert -radius < ball.heights[on_it].min()
    assert ball.heights.max() == pytest.approx(0, abs=max(steps) ** 2 / radius)
    np.testing.assert_array_equal(ball.heights, ball.heights[::-1, ::-1])
    assert (ball.unit, ball.length_unit, ball.pixel_size, ball.edges) == ("m", "m", steps, "free")
    made = {"kind": "sphere", "shape": list(shape), "radius": radius}
    assert ball.provenance == made | {"pixel_size": list(steps), "length_unit": "m"}


def test_a_large_ball_keeps_all_digits():
    # To the order that doubles hold, 1 km of radius fall by r^2 / 2 R: 1e-15 m, where R is known to 1e-13 m.
    ball = sphere((65, 65), radius="1 km", pixel_size="1 um")
    square = middle(65, MICRON) ** 2
    np.testing.assert_allclose(ball.heights, -(square[:, None] + square) / 2e3, rtol=1e-14)


def test_a_paraboloid_has_its_curvatures():
    one = paraboloid((30, 31), radius=("2 mm", "0.5 mm"), pixel_size=(2e-6, 1e-6))
    for axis, radius, step in ((0, 2e-3, 2e-6), (1, 0.5e-3, 1e-6)):
        np.testing.assert_allclose(np.diff(one.heights, 2, axis) / step**2, -1 / radius, rtol=1e-9)
    assert one.heights.max() == -(1e-6**2) / 4e-3


def test_a_punch_is_flat_on_the_sites_whose_center_is_within_its_edge():
    one = punch((64, 65), radius=20e-6, pixel_size=MICRON)
    within = np.hypot(np.arange(64)[:, None] - 31.5, np.arange(65) - 32) <= 20
    np.testing.assert_array_equal(one.heights, np.where(within, 0.0, -20e-6))
    # A site on the very edge counts on either side, whatever rounding does.
    edge = punch((9, 9), radius=3 * 0.1e-6, pixel_size=0.1e-6).heights == 0
    assert edge[4].tolist() == edge[:, 4].tolist() == [False, *[True] * 7, False]


def test_balls_stand_where_they_are_told_and_the_highest_wins():
    places, radii, tops = [[5.0, 6.0], [20.0, 30.0], [22.0, 33.0]], [4.0, 6.0, 5.0], [0.5, 0.0, -0.5]
    made = array((32, 48), places=places, radii=radii, heights=tops, pixel_size=1.0)
    grid = np.indices((32, 48))
    expected = np.full((32, 48), -6.0)
    for (y, x), radius, top in zip(places, radii, tops, strict=True):
        square = (grid[0] - y) ** 2 + (grid[1] - x) ** 2
        ball = top - radius + np.sqrt(np.maximum(radius**2 - square, 0))
        expected = np.where(square <= radius**2, np.maximum(expected, ball), expected)
    np.testing.assert_allclose(made.heights, expected, atol=1e-14)
    assert made.provenance["y"] == [5.0, 20.0, 22.0]
    texts: Any = {
        "radii": ["4 m", "600 cm", "5 m"],
        "heights": ["0.5 m", "0 m", "-50 cm"],
        "pixel_size": "1 m",
    }
    written = array((32, 48), places=[("5 m", "6 m"), ("20 m", "30 m"), ("22 m", "3300 cm")], **texts)
    np.testing.assert_allclose(written.heights, made.heights, atol=1e-12)


def test_on_a_periodic_lattice_a_ball_goes_on_at_the_other_edge():
    def ball(y, x, edges):
        return array((20, 24), places=[[y, x]], radii=7.0, pixel_size=1.0, edges=edges)

    inside, wrapped, cut = ball(9, 11, "periodic"), ball(1, 22, "periodic"), ball(1, 22, "free")
    np.testing.assert_array_equal(np.roll(inside.heights, (-8, 11), (0, 1)), wrapped.heights)
    assert wrapped.edges == "periodic"
    assert (cut.heights <= wrapped.heights).all()
    assert (cut.heights < wrapped.heights).any()


WRONG: list[tuple[Any, str, list[Any]]] = [
    (sphere, "shape", [256, (256,)]),
    (sphere, "radius", [0.9e-6, np.inf, "1", "1 s", (1e-3, 2e-3)]),
    (sphere, "pixel_size", [0.0, "1 kg"]),
    (sphere, "edges", ["open"]),
    (paraboloid, "radius", [(1e-3, 2e-3, 3e-3), (1e-3, -2e-3)]),
    (punch, "radius", [1e-7]),
    (array, "places", [[(1e-5, 1e-5), (1e-3, 1e-5)], [(1e-5, -2e-6)], (1e-5, 1e-5), []]),
    (array, "places", [[("1 um", "2 s")], None]),
    (array, "radii", [[1e-3, 2e-3, 3e-3], [1e-3, 0.0]]),
    (array, "heights", [[0.0, 1e-6, 0.0], np.inf]),
]


def test_what_is_no_asperity_is_refused():
    places = [(1e-5, 1e-5), (2e-5, 3e-5)]
    for make, name, values in WRONG:
        given: dict[str, Any] = {"shape": (64, 48), "pixel_size": 1e-6}
        given |= {"places": places, "radii": 1e-3} if make is array else {"radius": 1e-3}
        assert isinstance(make(**given), Surface)
        for wrong in values:
            with refuses(name):
                make(**given | {name: wrong})
