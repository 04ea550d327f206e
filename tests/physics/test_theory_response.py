"""A site under a force that changes, against closed integrals, superposition and plain quadrature."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from asperity.theory import compliance, compliance_rate, response, response_rate, site_stiffness

SOLIDS = [(0.02, 0.0, 2), (200.0, 0.4, 2), (3.0, 0.0, 1), (0.5, 30.0, 1)]


@pytest.mark.parametrize(("x1", "viscous", "dimension"), SOLIDS)
def test_a_step_is_the_compliance(x1: float, viscous: float, dimension: int) -> None:
    times = np.concatenate([[0.0, 0.0], np.logspace(-3, 14, 35)])
    force = np.full(times.size, 2.0)
    force[0] = 0.0
    depth = response(times, force, x1, viscous, dimension)
    rate = response_rate(times, force, x1, viscous, dimension)
    assert depth[0] == 0
    assert depth[1:] == pytest.approx(2 * compliance(x1, times[1:], viscous, dimension), rel=1e-13)
    # 17 decades down, the rate keeps its digits.
    assert rate[1:] == pytest.approx(2 * compliance_rate(x1, times[1:], viscous, dimension), rel=1e-12)
    # A first force that is not 0 is a jump too; the zero of time does not matter.
    later = response(times[1:] + 7.0, force[1:], x1, viscous, dimension)
    assert later[:8] == pytest.approx(depth[1:9], rel=1e-12)


def plain_quadrature(
    t: float, times: NDArray[np.float64], force: NDArray[np.float64], kernel: Callable[[float], float]
) -> float:
    """The sum of jumps times the kernel, and the integral of the slope times it, interval by interval."""
    total = float(force[0]) * kernel(t - times[0])
    for i in range(1, times.size):
        change, duration = force[i] - force[i - 1], times[i] - times[i - 1]
        if times[i] > t:
            break
        if duration == 0:
            total += change * kernel(t - times[i])
        else:
            part, _ = quad(lambda y: kernel(t - y), times[i - 1], times[i], epsabs=1e-13, epsrel=1e-12)
            total += change / duration * part
    return total


@pytest.mark.parametrize(("x1", "viscous", "dimension"), [(3.0, 0.0, 2), (0.5, 0.3, 1)])
def test_random_histories_against_plain_quadrature(x1: float, viscous: float, dimension: int) -> None:
    rng = np.random.default_rng(11)
    times = np.sort(rng.uniform(0, 40, 8))
    times = np.sort(np.concatenate([times, times[[2, 5]]]))
    force = rng.normal(size=times.size)
    depth = response(times, force, x1, viscous, dimension)
    letter = response_rate(times, force, x1, viscous, dimension, instantaneous=False)
    for i in (0, 4, 9):

        def sunk(y: float) -> float:
            return float(compliance(x1, y, viscous, dimension))

        def speed(y: float) -> float:
            return float(compliance_rate(x1, y, viscous, dimension))

        assert depth[i] == pytest.approx(plain_quadrature(times[i], times, force, sunk), rel=1e-10)
        assert letter[i] == pytest.approx(plain_quadrature(times[i], times, force, speed), rel=1e-9)


def test_rate_is_the_derivative_of_the_depth_but_for_the_term_that_the_paper_leaves_out() -> None:
    times = np.array([0.0, 5.0, 5.0, 9.0, 20.0])
    force = np.array([1.0, 3.0, -1.0, 2.0, 2.0])
    near = np.array([-1e-5, 1e-5])
    rate = response_rate(times, force, 3.0)
    letter = response_rate(times, force, 3.0, instantaneous=False)
    # Slopes at each time: of the interval that begins there; before the jump and at the end, that ends there.
    slopes = np.array([0.4, 0.4, 0.75, 0.0, 0.0])
    assert rate - letter == pytest.approx(slopes / site_stiffness(3.0), rel=1e-13, abs=1e-16)
    fine = np.sort(np.concatenate([times, 12.0 + near, [12.0]]))
    history = np.array([1.0, 3.0, -1.0, 2.0, 2.0, 2.0, 2.0, 2.0])
    depth = response(fine, history, 3.0)
    assert response_rate(fine, history, 3.0)[5] == pytest.approx((depth[6] - depth[4]) / 2e-5, rel=1e-7)


def test_one_time_alone_is_the_elastic_answer() -> None:
    assert response([4.0], [2.0], 3.0) == pytest.approx([2 * compliance(3.0, 0.0)], rel=1e-14)
    assert response_rate([4.0], [2.0], 3.0) == pytest.approx([2 * compliance_rate(3.0, 0.0)], rel=1e-14)
