"""The dilute theory under a load that changes: closed forms while it grows, brute force when it falls."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.stats import norm

from asperity.theory import (
    EmpiricalHeights,
    ExponentialHeights,
    GaussianHeights,
    HeightLaw,
    compliance,
    dilute_area,
    dilute_history,
)

Floats = NDArray[np.float64]


@pytest.mark.parametrize("heights", [GaussianHeights(0.7), ExponentialHeights(2.0)])
@pytest.mark.parametrize(("viscous", "dimension"), [(0.0, 2), (0.3, 2), (0.0, 1)])
def test_constant_load_is_the_closed_form(heights: HeightLaw, viscous: float, dimension: int) -> None:
    times = np.concatenate([[0.0, 0.0], np.logspace(-2, 9, 12)])
    load = np.full(times.size, 4e-4)
    load[0] = 0.0
    area = dilute_history(times, load, k0=1.7, x1=3.0, heights=heights, viscous=viscous, dimension=dimension)
    closed = dilute_area(4e-4, compliance(3.0, times[1:], viscous, dimension) / 1.7, heights)
    assert area[0] == 0
    assert area[1:] == pytest.approx(closed, rel=1e-11)
    # A load that is constant but for rounding is constant.
    noisy = load[1:] * (1 + 1e-15 * (-1.0) ** np.arange(load.size - 1))
    again = dilute_history(
        times[1:], noisy, k0=1.7, x1=3.0, heights=heights, viscous=viscous, dimension=dimension
    )
    assert again == pytest.approx(closed, rel=1e-11)


def test_growing_load_is_the_hereditary_integral() -> None:
    heights, slope = GaussianHeights(), 1e-5
    area = dilute_history([0, 10, 10, 50], slope * np.array([0, 10, 30, 30]), k0=2.0, x1=1.0, heights=heights)
    ramp, _ = quad(lambda y: float(compliance(1.0, y)), 40, 50, epsrel=1e-12)
    compression = slope * (ramp + 20 * compliance(1.0, 40.0)) / 2
    assert area[-1] == pytest.approx(norm.sf(heights.separation_for(compression)), rel=1e-10)


def test_population_agrees_with_the_closed_form_where_both_hold() -> None:
    # The load falls in the very end only; all that is before the fall is exact, the fall is computed by the
    # population, and tends to what is before it as the fall tends to nothing.
    times = np.concatenate([[0.0, 0.0], np.logspace(-1, 6, 8), [1e6 + 1e-9, 2e6]])
    load = np.full(times.size, 1e-3)
    load[0], load[-2:] = 0.0, 1e-3 * (1 - 1e-9)
    for heights in (GaussianHeights(), ExponentialHeights()):
        area = dilute_history(times, load, k0=1.0, x1=3.0, heights=heights)
        closed = dilute_area(1e-3, compliance(3.0, times[1:]), heights)
        assert area[1:-2] == pytest.approx(closed[:-2], rel=1e-11)
        assert area[-2:] == pytest.approx(closed[-2:], rel=1e-4)


def brute_force(heights: Floats, load: Callable[[float], float], kernel: Floats, step: float) -> Floats:
    """Count the contacts of equal heights: steps of one length, sums over the whole past, bisection.

    ``kernel[m]`` is G/k0 at (m + 1/2) steps; a force changes in the middle between two grid times.
    """
    increments = np.zeros((kernel.size, heights.size))
    force = np.zeros(heights.size)
    counts = np.zeros(kernel.size)
    for n in range(kernel.size):
        past = np.tensordot(kernel[n:0:-1], increments[:n], axes=1)

        def pressed(d: float, past: Floats = past, force: Floats = force) -> Floats:
            return np.asarray(np.maximum(force + (heights - d - past) / kernel[0], 0.0))

        low, high = -10.0, float(heights.max() + 10)
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if pressed(middle).sum() > load((n + 1) * step) else (low, middle)
        increments[n] = pressed(high) - force
        force = force + increments[n]
        counts[n] = np.count_nonzero(force)
    return counts


def cycle(t: float) -> float:
    """Load up, hold, down to a tenth, hold, up."""
    return float(np.interp(t, [0, 4, 10, 12, 24, 30, 40], [0, 1, 1, 0.1, 0.1, 1.2, 1.2]))


@pytest.mark.parametrize(("x1", "viscous", "dimension"), [(3.0, 0.0, 2), (0.5, 0.5, 1)])
def test_unloading_counts_a_handful_of_asperities_like_brute_force(
    x1: float, viscous: float, dimension: int
) -> None:
    heights = np.random.default_rng(6).normal(size=12)
    step, k0 = 0.05, 2.0
    times = step * np.arange(1, 801)
    kernel = compliance(x1, times - step / 2, viscous, dimension) / k0
    counts = brute_force(heights, lambda t: 8 * cycle(t), kernel, step)
    knots = np.array([0, 4, 10, 12, 24, 30, 40])
    at = np.union1d(knots, times[19::20])
    area = dilute_history(
        at,
        [8 / 12 * cycle(t) for t in at],
        k0=k0,
        x1=x1,
        heights=EmpiricalHeights(heights),
        viscous=viscous,
        dimension=dimension,
    )
    expected = counts[np.round(at[1:] / step).astype(int) - 1]
    assert (12 * area[1:]).round(9).tolist() == expected.tolist()
    assert len(set(expected.tolist())) > 4


def test_unloading_a_gaussian_surface_like_brute_force() -> None:
    # 1200 heights of equal probability in the tail above 2.5, that hold all contacts.
    count, tail = 1200, float(norm.sf(2.5))
    heights = norm.isf(tail * (np.arange(count) + 0.5) / count)
    step, at = 0.1, np.array([0, 4, 10, 11, 12, 18, 24, 27, 30, 40])
    times = step * np.arange(1, 401)
    load = 2e-3
    kernel = compliance(3.0, times - step / 2)
    counts = brute_force(heights, lambda t: load * cycle(t) * count / tail, kernel, step)
    area = dilute_history(at, [load * cycle(t) for t in at], k0=1.0, x1=3.0, heights=GaussianHeights())
    expected = tail / count * counts[np.round(at[1:] / step).astype(int) - 1]
    # To one asperity of the brute force.
    assert area[1:] == pytest.approx(expected, rel=0, abs=tail / count)
    assert expected[2] < expected[1]


def test_without_load_nothing_touches_and_dips_heal() -> None:
    heights, load = GaussianHeights(), 1e-3
    times = np.array([0, 0, 1e3, 1e3, 2e3, 2e3, 1e8, 1e8])
    area = dilute_history(times, load * np.array([0, 1, 1, 0, 0, 1, 1, 0]), k0=1.0, x1=3.0, heights=heights)
    fresh, crept = dilute_area(load, compliance(3.0, [0.0, 1e3]), heights)
    assert area[[0, 3, 4, 7]].tolist() == [0, 0, 0, 0]
    assert area[1:3] == pytest.approx([fresh, crept], rel=1e-11)
    # Reloaded after a rest: between a fresh contact and the old one.
    assert fresh * 1.001 < area[5] < crept
    # A rest of 1e11 leaves of a dip of 1e3 a part of 1e-8.
    times[4:6], times[6:] = 1e11, 2e11
    healed = dilute_history(times, load * np.array([0, 1, 1, 0, 0, 1, 1, 0]), k0=1.0, x1=3.0, heights=heights)
    assert healed[5] == pytest.approx(fresh, rel=2e-4)


def test_heights_too_low_to_be_followed_do_not_touch() -> None:
    heights = EmpiricalHeights([1.0, 1.0, 2.0, 0.5])
    given: Any = {"k0": 1.0, "x1": 3.0, "heights": heights}
    assert dilute_history([0, 1, 2, 3], [1e-3, 5e-4, 0, 2e-3], **given).tolist() == [0.25, 0.25, 0, 0.25]
    assert dilute_history([0, 1, 2], [50, 20, 20], **given).tolist() == [1, 1, 1]
