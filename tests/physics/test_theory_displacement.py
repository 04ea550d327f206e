"""The dip around a point load, against its equations, closed forms, and sums over every mode of a torus."""

import math

import numpy as np
import pytest

from asperity.theory import compliance, displacement


def torus_sum(offset: tuple[int, ...], x1: float, x2: float, viscous: float, length: int) -> float:
    """Every mode of a torus, with lam = 0 as on the infinite lattice: it sinks by r x2 per site."""
    q = 2 * np.pi * np.arange(length) / length
    axes = np.meshgrid(*[q] * len(offset), indexing="ij")
    lam = np.sum([4 * np.sin(axis / 2) ** 2 for axis in axes], axis=0)
    lam.flat[0] = 1.0
    depth = (1 - x1 / lam * np.expm1(-x2 * x1 * lam * (lam + viscous) / (x1 + lam))) / (x1 + lam)
    depth.flat[0] = 1 / x1 + viscous * x2
    for axis, n in zip(axes, offset, strict=True):
        depth = depth * np.cos(n * axis)
    return float(depth.mean())


@pytest.mark.parametrize("offset", [(3, 4), (200, 300)])
@pytest.mark.parametrize(("x2", "viscous"), [(0.0, 0.0), (1.0, 0.3), (1e4, 0.0)])
def test_a_torus_that_is_large_enough_has_the_same_dip(
    offset: tuple[int, int], x2: float, viscous: float
) -> None:
    # The images of the load are 724 and more sites away.
    assert displacement(offset, 3.0, x2, viscous) == pytest.approx(
        torus_sum(offset, 3.0, x2, viscous, 1024), rel=0, abs=1e-14
    )


@pytest.mark.parametrize(("x2", "viscous"), [(0.0, 0.0), (30.0, 0.0), (1e4, 0.0), (10.0, 2.0)])
def test_so_has_a_ring(x2: float, viscous: float) -> None:
    far = displacement(np.arange(300)[:, None], 0.7, x2, viscous, dimension=1)
    expected = [torus_sum((n,), 0.7, x2, viscous, 4096) for n in range(300)]
    assert far == pytest.approx(expected, rel=0, abs=1e-13)


@pytest.mark.parametrize("dimension", [1, 2])
def test_at_the_load_it_is_the_compliance(dimension: int) -> None:
    x1 = np.array([1e-3, 3.0, 1e4])[:, None, None]
    x2 = np.array([0.0, 1.0, 1e4, 1e12])[:, None]
    viscous = np.array([0.0, 1e-2, 1e6])
    here = np.zeros(dimension, dtype=int)
    assert displacement(here, x1, x2, viscous, dimension) == pytest.approx(
        compliance(x1, x2, viscous, dimension), rel=1e-13
    )


def test_late_it_falls_off_like_the_potential_kernel_of_the_lattice() -> None:
    # Spitzer, Principles of Random Walk (1976), section 15: G(0) - u(r) -> a(r), a quarter of his.
    sites = [(1, 0), (1, 1), (2, 0), (2, 1), (2, 2)]
    kernel = np.array([1 / 4, 1 / math.pi, 1 - 2 / math.pi, 2 / math.pi - 1 / 4, 4 / (3 * math.pi)])
    for x1 in (0.5, 20.0):
        fall = compliance(x1, 1e14) - displacement(sites, x1, 1e14)
        # What is missing falls as r^2 / sqrt(x2).
        assert fall == pytest.approx(kernel, rel=0, abs=1e-7)
    # Far away, but well within the dip: (ln r + gamma_E + 3/2 ln 2) / (2 pi) + O(r^-2).
    far = compliance(3.0, 1e20) - displacement((240, 320), 3.0, 1e20)
    closed = (math.log(400) + np.euler_gamma + 1.5 * math.log(2)) / (2 * math.pi)
    assert far == pytest.approx(closed, rel=0, abs=1e-6)


def test_signs_shapes_and_scalars() -> None:
    table = displacement([(2, -1), (-2, 1), (1, 2)], 3.0, np.array([0.0, 5.0])[:, None])
    assert table.shape == (2, 3)
    assert table[:, 0] == pytest.approx(table[:, 1], rel=1e-13)
    assert table[:, 0] == pytest.approx(table[:, 2], rel=1e-13)
    assert isinstance(displacement((1, 0), 1.0, 1.0), float)
    assert displacement(-3, 1.0, 1.0, dimension=1) == displacement([3], 1.0, 1.0, dimension=1)
    assert displacement(np.zeros((0, 2), dtype=int), 1.0, 1.0).shape == (0,)
