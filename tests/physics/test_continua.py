"""Elastic half-spaces against an independent operator, Hertz, Westergaard, Johnson and Persson."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import asperity as asp
from tests.continua import pressed
from tests.equal_steps import orders
from tests.surfaces import correlated, uncorrelated

GPA, MICRON = 1e9, 1e-6


@cache
def sphere(rows, columns, load):
    """A sphere of 3 mm under a load, on a square of 100 micrometres, wherever its summit is between sites.

    Errors of area, area without its rim, largest pressure, approach and stiffness, relative to Hertz; their
    means over positions of the summit.
    """
    E, radius, period = 2.0 * GPA, 3e-3, 100 * MICRON
    hertz = asp.theory.hertz(load, modulus=E, radius=radius, period=period)
    misses = []
    for offset in np.stack(np.meshgrid(*2 * [(np.arange(4) + 0.5) / 8]), axis=-1).reshape(-1, 2):
        y, x = (
            period * ((np.arange(n) + shift) / n - 0.5)
            for n, shift in zip((rows, columns), offset, strict=True)
        )
        surface = asp.surfaces.Surface(
            -(y[:, None] ** 2 + x**2) / (2 * radius) / MICRON,
            unit="um",
            pixel_size=(100 / rows, 100 / columns),
            length_unit="um",
        )
        contact = asp.press(surface, asp.solids.half_space(modulus=E), load=load)
        assert contact.si
        assert contact.load == pytest.approx(load, rel=1e-8)
        misses.append(
            [
                contact.contact_area / hertz.area - 1,
                contact.contact_area_corrected / hertz.area - 1,
                contact.largest_pressure / hertz.largest_pressure - 1,
                -contact.separation / hertz.approach - 1,
                contact.normal_stiffness / hertz.stiffness - 1,
            ]
        )
    return np.mean(misses, axis=0)


@pytest.mark.parametrize("ratio", [1, 2], ids=["square", "oblong"])
def test_a_sphere_converges_to_hertz(ratio):
    # The contact's radius is 12 micrometres, of which (a/L)^5, what the closed form leaves out, is 2.5e-5.
    grids = np.array([32, 64, 128])
    misses = np.array([sphere(n // ratio, n, 1.536e-3) for n in grids])
    area, corrected, largest, approach, stiffness = misses.T
    # Counting sites errs by the rim, whose share falls as the spacing. The correction removes most of it.
    np.testing.assert_allclose(orders(np.abs(area)), 1.0, atol=0.15)
    assert (area > 0).all()
    assert (np.abs(corrected) < 0.35 * np.abs(area)).all()
    assert (corrected < 0).all()
    # The largest pressure is the value of a parabola's square root at its summit.
    assert (orders(np.abs(largest)) > 1.9).all()
    assert abs(largest[-1]) < 1.5e-3
    assert (np.abs(approach) < 4e-4 * (32 / grids) ** 2 + 2.5e-5).all()
    assert (np.abs(stiffness) < 3e-3 * 32 / grids).all()


@pytest.mark.parametrize("spacing", [(), (2.0, 0.5)], ids=["square", "oblong"])
@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_stiffness_is_the_slope_of_load_over_approach(edges, spacing):
    # So small a change of the load changes no contact, and a linear law has no error of differences.
    heights, solid = correlated(32, hurst=0.8), asp.solids.half_space(modulus=2.0)
    less, contact, more = (
        pressed(heights, solid, load=30.0 * factor, spacing=spacing, edges=edges)
        for factor in (1 - 1e-4, 1.0, 1 + 1e-4)
    )
    np.testing.assert_array_equal(less.in_contact, more.in_contact)
    slope = (more.load - less.load) / (less.separation - more.separation)
    assert contact.normal_stiffness == pytest.approx(slope, rel=1e-5)


def wave(sites, share, offset):
    """A line of wavelength 3 and amplitude 0.2 under a share of the pressure that closes it, E* = 5."""
    E, amplitude, length = 5.0, 0.2, 3.0
    full = np.pi * E * amplitude / length
    x = length * (np.arange(sites) + offset) / sites
    heights = amplitude * np.cos(2 * np.pi * x / length)
    contact = pressed(
        heights, asp.solids.half_space(modulus=E), load=share * full * length, spacing=(length / sites,)
    )
    return x / length, full, contact


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_a_wavy_line_converges_to_westergaard(share):
    E, amplitude, length = 5.0, 0.2, 3.0
    misses = []
    for sites in (64, 128, 256, 512):
        found = []
        for offset in (np.arange(8) + 0.5) / 16:
            x, full, contact = wave(sites, share, offset)
            law = {"modulus": E, "amplitude": amplitude, "wavelength": length}
            area = asp.theory.westergaard_area(contact.mean_pressure, **law)
            inside = np.maximum(share - np.sin(np.pi * x) ** 2, 0.0)
            pressure = 2 * full * np.abs(np.cos(np.pi * x)) * np.sqrt(inside)
            approach = amplitude * share * (1 - np.log(share))
            stiffness = -np.pi * E / np.log(share)  # per length; times the wavelength over which it acts
            found.append(
                [
                    contact.area / sites - area,
                    np.abs(contact.pressure - pressure).mean() / contact.mean_pressure,
                    (amplitude - contact.separation) / approach - 1,
                    contact.normal_stiffness / stiffness - 1,
                ]
            )
        misses.append(np.mean(found, axis=0))
    area, pressure, approach, stiffness = np.array(misses).T
    np.testing.assert_allclose(orders(np.abs(area)), 1.0, atol=0.25)
    # Where the pressure begins like a square root, its error is of the order 3/2.
    np.testing.assert_allclose(orders(pressure), 1.5, atol=0.1)
    assert orders(pressure).mean() == pytest.approx(1.5, abs=0.05)
    assert (orders(np.abs(approach)) > 1.9).all()
    assert abs(approach[-1]) < 1e-7
    assert abs(stiffness[-1]) < 2e-4


def crossed_waves(sites, share):
    """cos(qx) cos(qy) on a square of one wavelength, under a share of the pressure that closes it."""
    x = np.arange(sites) / sites
    heights = 0.02 * np.cos(2 * np.pi * x)[:, None] * np.cos(2 * np.pi * x)
    full = np.sqrt(2) * np.pi * 3.0 * 0.02
    solid = asp.solids.half_space(modulus=3.0)
    return pressed(heights, solid, load=share * full, spacing=(1 / sites, 1 / sites))


def test_crossed_waves_close_at_the_pressure_of_full_contact():
    # K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383 (1985).
    assert crossed_waves(32, 1 + 1e-9).area == 32**2
    assert crossed_waves(32, 1 - 1e-6).area < 32**2
    gap = 1 - crossed_waves(128, 0.97).contact_area_corrected
    assert gap == pytest.approx(3 / (2 * np.pi) * 0.03, rel=0.04)
    # Each of the two summits is a sphere of curvature amplitude * q^2.
    share = crossed_waves(256, 0.01).contact_area_corrected
    assert share == pytest.approx(np.pi * (3 / (8 * np.pi) * 0.01) ** (2 / 3), rel=0.03)


def self_affine(n, longest, shortest, hurst, seed):
    """Waves of random phase between two wavelengths in sites, and the rms slope."""
    q = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.fftfreq(n)[None, :])
    inside = (q >= 1 / longest) & (q <= 1 / shortest)
    amplitude = np.where(inside, np.maximum(q, 1 / n) ** -(1 + hurst), 0.0)
    modes = amplitude * np.fft.fft2(np.random.default_rng(seed).normal(size=(n, n)))
    slope = np.sqrt(np.sum((2 * np.pi * q) ** 2 * np.abs(modes) ** 2)) / n**2
    return np.fft.ifft2(modes).real / slope


@cache
def share_touching(pressure, hurst=0.8):
    """Contact area over nominal area, over four surfaces of slope 1 under a solid of modulus 1."""
    solid, n = asp.solids.half_space(modulus=1.0), 256
    surfaces = (self_affine(n, 64, 8, hurst, seed) for seed in range(4))
    contacts = [pressed(heights, solid, load=pressure * n**2) for heights in surfaces]
    return np.mean([contact.contact_area_corrected for contact in contacts]) / n**2


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_area_is_proportional_to_a_light_load(hurst):
    # A = kappa F / (E* slope). Persson has 1.6, Bush, Gibson and Thomas 2.5; computations give 2.2
    # (S. Hyun et al., Phys. Rev. E 70, 026117 (2004), DOI 10.1103/PhysRevE.70.026117) and 2 (L. Pastewka,
    # M. O. Robbins, PNAS 111, 3298 (2014), DOI 10.1073/pnas.1320846111).
    kappa = [share_touching(pressure, hurst) / pressure for pressure in (0.01, 0.02, 0.04)]
    assert np.ptp(kappa) < 0.05 * np.mean(kappa)
    assert np.mean(kappa) == pytest.approx(2.2, abs=0.1)


def test_area_approaches_what_persson_foresees():
    pressures = np.array([0.01, 0.1, 0.4, 0.8, 1.2])
    shares = np.array([share_touching(pressure) for pressure in pressures])
    excess = shares / asp.theory.persson_area(pressures, modulus=1.0, slope=1.0) - 1
    assert (np.diff(excess) < 0).all()
    assert 0.25 < excess[0] < 0.5
    assert abs(excess[-1]) < 0.01


def test_persson_is_a_diffusion_of_pressure_absorbed_at_zero():
    # dP/dV = P''/2 on a grid of pressures, from all at the mean pressure to a variance V of (E* slope / 2)^2.
    E, slope, cells, step = 2.0, 0.3, 400, 0.005
    diffusion = np.diag(np.full(cells - 1, 1.0), 1)
    generator = (diffusion + diffusion.T - 2 * np.eye(cells)) / (2 * step**2)
    reached = scipy.linalg.expm((E * slope / 2) ** 2 * generator)
    for index in (10, 40, 120):
        share = asp.theory.persson_area((index + 1) * step, modulus=E, slope=slope)
        assert reached[index].sum() == pytest.approx(share, abs=1e-4)


def forces(heights, u, modulus, load):
    """E*|q|/2 applied by numpy's complex transform, and the load spread evenly: no code of the package."""
    ny, nx = heights.shape
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(ny)[:, None], np.fft.fftfreq(nx)[None, :])
    return np.fft.ifft2(modulus * q / 2 * np.fft.fft2(u)).real + load / heights.size


@pytest.mark.parametrize(
    "heights", [uncorrelated(64), correlated(128, hurst=0.8)], ids=["white", "self-affine"]
)
@pytest.mark.parametrize("pressure", [0.002, 0.1])
def test_contact_is_in_equilibrium_by_an_independent_operator(heights, pressure):
    load = pressure * heights.size
    contact = asp.press(heights, asp.solids.half_space(modulus=2.0), load=load)
    force = forces(heights, contact.u, 2.0, load)
    touching = contact.u == heights
    mean = load / touching.sum()
    assert (contact.u >= heights).all()
    assert np.abs(force[~touching]).max() <= 1e-8 * mean
    assert force[touching].min() >= -1e-8 * mean
    np.testing.assert_array_equal(touching, contact.in_contact)
    assert contact.load == pytest.approx(load, rel=1e-8)
    assert contact.separation == pytest.approx(contact.u.mean(), rel=1e-9)


@pytest.mark.parametrize("above", [1e-3, 3.0])
def test_heights_of_mean_zero_touch_everywhere_from_the_load_that_flattens_them_on(above):
    # The datum is then 0 but for rounding, beside which the last digit of the heights is large.
    heights = asp.surfaces.spectral((64, 64), rms_slope=0.1, seed=1)
    flattening = -forces(heights, heights, 1.0, 0.0).min()
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0), pressure=flattening * (1 + above))
    assert contact.area == heights.size
    assert contact.load == pytest.approx(flattening * (1 + above) * heights.size, rel=1e-12)
    less = asp.press(heights, asp.solids.half_space(modulus=1.0), pressure=flattening * (1 - 1e-3))
    assert less.area < heights.size


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 3.0)])
@pytest.mark.parametrize("load", [1.0, 100.0, 800.0])
@pytest.mark.parametrize("film", [False, True])
def test_a_rigid_apparatus_is_a_spring_of_known_stiffness(load, spacing, film):
    """Held where that spring is as short as the load makes it, the surface is that under the load."""
    heights = asp.surfaces.spectral((48, 48), roll_off=24.0, cutoff=4.0, rms_height=1.0, seed=2)
    rough = asp.surfaces.Surface(heights, unit="m", pixel_size=spacing, length_unit="m", edges="periodic")
    kind: Any = asp.solids.half_space
    of: dict[str, Any] = {"modulus": 1.0}
    if film:
        kind = asp.solids.coated_half_space
        of |= {"poisson": 0.3, "thickness": 5.0, "base_modulus": 4.0, "base_poisson": 0.3}
    free = asp.press(rough, kind(**of), load=load)
    stiffest = float(free.solid.on(free.lattice).permanent.max())
    place = free.separation - load / (1e4 * stiffest * heights.size)
    held = asp.press(rough, kind(**of, apparatus=math.inf), separation=place)
    assert held.load == pytest.approx(load, rel=1e-9)
    np.testing.assert_array_equal(held.in_contact, free.in_contact)
