"""Indenters on viscoelastic half-spaces, beside a slow quadrature and a half-space pressed numerically."""

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import asperity as asp
from tests.refusals import each_refuses

SHARES, TIMES, MODULUS, RADIUS = (0.3, 0.3), (0.1, 1.0), 1000.0, 1e-5
SERIES = asp.relaxation.PronySeries(MODULUS, tuple(zip(SHARES, TIMES, strict=True)))
KNOTS, DEPTHS = (0.25, 1.0, 3.0, 4.0), (0.0, 2e-6, 2e-6, -1e-6)
"""From the first contact on: approach, hold, retraction."""
TIPS: dict[str, tuple[float, float, dict[str, Any]]] = {
    "ball": (4 * np.sqrt(RADIUS) / 3, 1.5, {"radius": RADIUS}),
    "cone": (2 * np.tan(np.radians(70)) / np.pi, 2.0, {"angle": 70}),
    "punch": (2 * RADIUS, 1.0, {"radius": RADIUS}),
}


def relaxing(t):
    parts = (share * np.exp(-t / time) for share, time in zip(SHARES, TIMES, strict=True))
    return MODULUS * (1 - sum(SHARES) + sum(parts))


def integral(function, low, high):
    """Integral between knots, so that the integrand is smooth."""
    ends = [low, *(knot for knot in KNOTS if low < knot < high), high]
    return sum(
        quad(function, *part, epsabs=0, epsrel=1e-9, limit=200)[0] for part in itertools.pairwise(ends)
    )


def slow_force(t, factor, exponent):
    """Lee and Radok, and Ting, as they are printed."""

    def depth(s):
        return np.interp(s, KNOTS, DEPTHS)

    def rate(s):
        return next(
            (b - a) / (e - i)
            for i, e, a, b in zip(KNOTS, KNOTS[1:], DEPTHS, DEPTHS[1:], strict=False)
            if s <= e
        )

    def pressing(s):
        return relaxing(t - s) * exponent * depth(s) ** (exponent - 1) * rate(s)

    def excess(t1):
        return integral(lambda s: relaxing(t - s) * rate(s), t1, t)

    if t <= KNOTS[0]:
        return 0.0
    if t <= KNOTS[2]:
        return factor * integral(pressing, KNOTS[0], t)
    if excess(KNOTS[0]) <= 0:
        return 0.0
    return factor * integral(pressing, KNOTS[0], brentq(excess, *KNOTS[:2], xtol=1e-13))


@pytest.mark.parametrize("tip", TIPS)
def test_the_force_is_that_of_a_slow_quadrature(tip):
    factor, exponent, size = TIPS[tip]
    time = np.array([0.0, 0.25, 0.3, 0.6, 1.0, 1.5, 3.0, 3.02, 3.1, 3.2, 3.3, 3.4, 3.6, 4.0])
    force = asp.theory.ting(time, np.interp(time, (0.0, *KNOTS), (-1e-6, *DEPTHS)), SERIES, tip=tip, **size)
    slow = np.array([slow_force(t, factor, exponent) for t in time])
    assert slow[7] > slow[9] > 0 == slow[-1]
    np.testing.assert_allclose(force, slow, rtol=0, atol=1e-7 * slow.max())


def test_steps_between_times_change_nothing():
    knots = np.array([0.0, *KNOTS])
    coarse = np.interp(knots, knots, (-1e-6, *DEPTHS))
    fine = np.linspace(0, 4, 4001)
    force = asp.theory.ting(fine, np.interp(fine, knots, coarse), SERIES, RADIUS)
    at = asp.theory.ting(knots, coarse, SERIES, RADIUS)
    np.testing.assert_allclose(at, np.interp(knots, fine, force), rtol=0, atol=1e-9 * force.max())


def test_an_elastic_solid_obeys_hertz_both_ways():
    solid = asp.relaxation.PronySeries(MODULUS)
    time = np.linspace(0, 4, 101)
    depth = np.interp(time, (0.0, *KNOTS), (-1e-6, *DEPTHS))
    force = asp.theory.ting(time, depth, solid, "10 um")
    hertz = asp.theory.hertz(force, modulus=MODULUS, radius=RADIUS)
    np.testing.assert_allclose(hertz.approach, np.maximum(depth, 0), rtol=1e-9, atol=1e-15)


def test_a_depth_held_from_the_first_time_relaxes():
    time = np.geomspace(1e-3, 10, 20)
    force = asp.theory.ting(time, np.full(20, 1e-6), SERIES, RADIUS)
    relaxed = SERIES.modulus_at(time - time[0]) / MODULUS
    np.testing.assert_allclose(force / force[0], relaxed, rtol=1e-12)


def test_shapes_times_and_sizes_are_refused():
    time, depth, ting = np.arange(4.0), np.array([0.0, 1e-6, 2e-6, 0.0]), asp.theory.ting
    each_refuses(
        ("depth", "shape (3,)", ting, time, depth[:3], SERIES, RADIUS),
        ("time", "3.0 before 2.0", ting, time[::-1], depth, SERIES, RADIUS),
        ("radius", "none", ting, time, depth, SERIES),
        ("angle", "none", lambda: ting(time, depth, SERIES, RADIUS, tip="cone")),
        ("depth", "a rise up to 3 s", ting, np.arange(5.0), [0.0, 2e-6, 1e-6, 1.9e-6, 0.0], SERIES, RADIUS),
    )


@pytest.mark.slow
def test_a_half_space_with_free_edges_is_pressed_and_withdrawn_alike():
    ball = asp.surfaces.paraboloid((64, 64), radius=RADIUS, pixel_size=5e-8)
    solid = asp.solids.half_space(modulus=1e6, branches=[(0.4, 0.3), (0.3, 3.0)])
    series = asp.relaxation.PronySeries(1e6, ((0.4, 0.3), (0.3, 3.0)))
    first, most = 2e-9, 1e-7
    ramp = asp.protocols.Ramp
    legs = [
        ramp(1.0, separation=-most),
        asp.protocols.Hold(2.0, hold="separation"),
        ramp(1.0, separation=first),
    ]
    times = np.concatenate([np.linspace(0.1, 3, 12), np.linspace(3.05, 3.6, 12)])
    history = asp.age(asp.press(ball, solid, separation=-first), times, protocol=legs).dataset
    time = history.time.values
    knots, depths = [0, 1, 3, 4], [first, most, most, -first]
    force = asp.theory.ting(time, np.interp(time, knots, depths), series, RADIUS)
    assert (force[time > 3] > 0).sum() > 8
    np.testing.assert_allclose(history["load"].values, force, rtol=0, atol=0.01 * force.max())
