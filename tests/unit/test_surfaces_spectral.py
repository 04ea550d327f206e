"""Surfaces of a given spectrum, and the spectrum and the Hurst exponent of any surface."""

import math
from typing import Any

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.surfaces import Surface, gaussian, power_spectrum, read, spectral, statistics
from tests.surfaces import correlated

HURST = (0.3, 0.5, 0.8)


def waves(heights: np.ndarray, spacing: Any = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Wave number and squared amplitude of all modes, by the full complex transform."""
    sizes = np.broadcast_to(spacing, heights.ndim)
    axes = [2 * np.pi * np.fft.fftfreq(n, d) for n, d in zip(heights.shape, sizes, strict=True)]
    q = np.sqrt(sum(k**2 for k in np.meshgrid(*axes, indexing="ij")))
    return q, np.abs(np.fft.fftn(heights) / heights.size) ** 2


@pytest.mark.parametrize("shape", [(96, 60), (45, 77), (301,), 256])
@pytest.mark.parametrize("hurst", [0.0, 0.3, 1.0])
def test_the_spectrum_falls_with_the_hurst_exponent(shape: Any, hurst: float) -> None:
    heights = spectral(shape, hurst=hurst, cutoff=4, seed=3)
    q, power = waves(heights)
    inside = (q > 0) & (q <= 2 * np.pi / 4)
    slope = np.polyfit(np.log(q[inside]), np.log(power[inside]), 1)[0]
    assert slope == pytest.approx(-2 * (1 + hurst) if heights.ndim == 2 else -(1 + 2 * hurst), abs=1e-9)
    assert power[~inside].max() < 1e-25 * power.max()


def test_roll_off_and_cutoff_are_wavelengths() -> None:
    q, power = waves(spectral((128, 96), roll_off=6.0, cutoff=1.5, spacing=(0.25, 0.5)), (0.25, 0.5))
    flat, kept = (q > 0) & (q < 2 * np.pi / 6.0), (q > 0) & (q <= 2 * np.pi / 1.5)
    assert np.ptp(power[flat]) < 1e-9 * power[flat].mean()
    assert power[kept].min() == pytest.approx(power[flat].mean() * 4**-3.6, rel=0.05)
    assert power[~kept].max() < 1e-25 * power.max()


@pytest.mark.parametrize(("shape", "spacing"), [((64, 48), (0.5, 2.0)), ((63, 31), 1e-7), ((200,), (3.0,))])
def test_roughness_is_exact(shape: Any, spacing: Any) -> None:
    for power, name in enumerate(("rms_height", "rms_slope", "rms_curvature")):
        heights = spectral(shape, spacing=spacing, seed=2, **{name: 0.25})
        q, squared = waves(heights, spacing)
        measured = math.sqrt(np.sum(q ** (2 * power) * squared))
        assert measured / (heights.ndim if power == 2 else 1) == pytest.approx(0.25, rel=1e-12)
        assert abs(heights.mean()) < 1e-12 * heights.std()


@pytest.mark.parametrize("shape", [(400, 300), (900,)])
def test_finite_differences_agree_where_waves_are_long(shape: tuple[int, ...]) -> None:
    size = (0.5, 0.4)[: len(shape)]
    for name in ("rms_height", "rms_slope", "rms_curvature"):
        heights = spectral(shape, spacing=size, roll_off=60, cutoff=15, seed=1, **{name: 0.1})
        assert getattr(statistics(heights, size), name) == pytest.approx(0.1, rel=0.03)


def test_seeds_differ_in_phases_only() -> None:
    one, other = spectral((32, 32), seed=1), spectral((32, 32), seed=2)
    assert np.abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.9
    np.testing.assert_allclose(waves(one)[1], waves(other)[1], atol=1e-15)
    np.testing.assert_array_equal(one, spectral((32, 32), seed=1))
    assert spectral(16).std() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"hurst": 1.1}, r"hurst: expected a number from 0 to 1, got 1\.1"),
        ({"cutoff": 1.0}, "cutoff: expected a wavelength from 2, two of the larger spacings, to 32"),
        ({"cutoff": 17.0, "roll_off": 16.0}, "cutoff: .* to 16, the roll-off, got 17"),
        ({"roll_off": 1.0}, "roll_off: expected a wavelength of 2 or more"),
        ({"rms_slope": 0.0}, "rms_slope: expected a finite number > 0"),
        (
            {"rms_slope": 1.0, "rms_height": 2.0},
            "expected one of rms_height, .*, got rms_height and rms_slope",
        ),
        ({"spacing": (1.0, 2.0, 3.0)}, "spacing: expected one number above 0, or 2, one an axis"),
        ({"spacing": 0.0}, "spacing: expected finite numbers above 0"),
        ({"cutoff": 50.0, "roll_off": 60.0}, "shape: expected a lattice on which a wave as long .* of 50$"),
    ],
)
def test_what_makes_no_spectrum_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        spectral((32, 16), **options)


@pytest.mark.parametrize("shape", [(40, 30), (64,)])
def test_the_power_is_that_of_its_definition(shape: tuple[int, ...]) -> None:
    """By the sum itself, mode by mode, at one wave vector; and all waves together are the rms height."""
    size = (0.5, 0.25)[: len(shape)]
    sites = np.meshgrid(*(d * np.arange(n) for n, d in zip(shape, size, strict=True)), indexing="ij")
    wave = [2 * np.pi * k / (n * d) for k, n, d in zip((0, 5), shape, size, strict=False)]
    heights = 3 * np.cos(sum(k * x for k, x in zip(wave, sites, strict=True)) + 0.7)
    if heights.ndim == 1:
        heights = 3 * np.cos(2 * np.pi * 5 / (64 * 0.5) * sites[0] + 0.7)
    measured = power_spectrum(Surface(heights, "nm", size, "um"))
    assert (measured.window, measured.unit, measured.length_unit) == ("none", "nm", "um")
    q = 2 * np.pi * 5 / (shape[-1] * size[-1])
    phase = np.exp(-1j * q * sites[-1])
    area = math.prod(size)
    power = area / heights.size * abs(np.sum(heights * phase)) ** 2
    at = int(np.argmax(measured.power))
    assert measured.power[at] * measured.modes[at] == pytest.approx(power)
    total = 2 * np.sum(measured.power * measured.modes) / (heights.size * area)
    assert total == pytest.approx(np.mean(heights**2))
    along_q, along = measured.along[-1]
    assert along_q[np.argmax(along)] == pytest.approx(q)
    assert 2 * along.sum() / (shape[-1] * size[-1]) == pytest.approx(np.mean(heights**2))


def test_white_noise_keeps_its_power_under_the_window() -> None:
    heights = gaussian((256, 256), seed=1)
    free = power_spectrum(heights)
    tilted = power_spectrum(heights + 3.0 * np.arange(256))
    assert (free.window, tilted.window) == ("none", "Hann")
    for measured in (free, tilted):
        assert np.average(measured.power, weights=measured.modes) == pytest.approx(1.0, rel=0.02)
        assert measured.fit is None


def test_profiles_agree_with_surface_topography() -> None:
    library = pytest.importorskip("SurfaceTopography", reason="needs asperity[instruments]")
    heights = spectral((48, 64), cutoff=4, spacing=(0.5, 0.25), seed=4)
    measured = power_spectrum(heights, (0.5, 0.25))
    for axis, turned in ((0, heights), (1, heights.T)):
        sizes = tuple(n * d for n, d in zip(turned.shape, (0.5, 0.25)[:: 1 - 2 * axis], strict=True))
        theirs = library.Topography(turned, sizes, periodic=True)
        q, power = theirs.power_spectrum_from_profile(resampling_method=None)
        mine = [values[: len(q) - 1] for values in measured.along[axis]]
        np.testing.assert_allclose(mine[0], q[1:])
        np.testing.assert_allclose(mine[1], power[1:], rtol=1e-9, atol=1e-9 * power.max())
        assert statistics(turned, (0.5, 0.25)[:: 1 - 2 * axis]).rms_curvature == pytest.approx(
            theirs.rms_curvature_from_area(), rel=0.05
        )


@pytest.mark.parametrize("hurst", HURST)
def test_the_hurst_exponent_is_found(hurst: float) -> None:
    surfaces = {
        "whole": lambda seed: spectral((256, 256), hurst=hurst, cutoff=4, seed=seed),
        "rolled off": lambda seed: spectral((256, 256), hurst=hurst, cutoff=2, roll_off=64, seed=seed),
        # A part of a larger one: no period, so a window; random amplitudes, from another generator.
        "part": lambda seed: spectral((512, 512), hurst=hurst, cutoff=4, seed=seed)[:200, :240],
        "random": lambda seed: correlated(256, hurst, seed),
        "profile": lambda seed: spectral(2048, hurst=hurst, seed=seed),
    }
    for name, make in surfaces.items():
        for seed in range(4):
            found = power_spectrum(make(seed))
            assert found.fit is not None, name
            assert found.window == ("Hann" if name == "part" else "none")
            low, high = found.fit.interval
            assert low <= hurst <= high, (name, seed, found.fit)
            assert high - low < 0.35, (name, seed, found.fit)
            middle = math.sqrt(found.wave_number[0] * found.wave_number[-1])
            near = int(np.argmin(np.abs(np.log(found.wave_number / middle))))
            assert float(found.fit.power(found.wave_number[near])) == pytest.approx(
                found.power[near], rel=0.5
            )


def test_the_range_ends_at_roll_off_and_cutoff() -> None:
    found = power_spectrum(spectral((512, 512), roll_off=128, cutoff=8, hurst=0.8)).fit
    assert found is not None
    assert 128 / 1.3 < found.longest < 128 * 2
    assert 8 <= found.shortest < 8 * 1.3


def test_a_range_may_be_given() -> None:
    heights = spectral((256, 256), roll_off=64, cutoff=4, hurst=0.6)
    found = power_spectrum(heights, longest=50.0, shortest=5.0).fit
    assert found is not None
    assert found.hurst == pytest.approx(0.6, abs=1e-9)
    assert found.shortest >= 5
    assert found.longest <= 50
    with pytest.raises(InputError, match=r"expected a range of wavelengths with three bins .*, got 0"):
        power_spectrum(heights, longest=2.2, shortest=2.1)
    with pytest.raises(InputError, match="shortest: expected a finite number > 0 and < 5"):
        power_spectrum(heights, longest=5.0, shortest=6.0)


def test_a_mirrored_scan_is_measured_once(tmp_path: Any) -> None:
    part = spectral((300, 300), hurst=0.7, cutoff=3, seed=2)[:120, :150]
    np.save(tmp_path / "scan.npy", part)
    mirrored, alone, edges = (
        power_spectrum(read(tmp_path / "scan.npy", periodic=rule, pixel_size=0.5))
        for rule in ("mirror", "wrap", "reflect")
    )
    assert mirrored.window == "Hann"
    np.testing.assert_array_equal(mirrored.power, alone.power)
    np.testing.assert_array_equal(mirrored.power, edges.power)
    assert mirrored.fit is not None
    assert mirrored.fit.longest <= 0.5 * 120 / 3


@pytest.mark.parametrize(
    "heights", [np.zeros((9, 9)), np.ones(1), np.ones((1, 5)), np.eye(2), np.arange(7.0)]
)
def test_surfaces_without_waves_have_no_exponent(heights: np.ndarray) -> None:
    assert power_spectrum(heights).fit is None
