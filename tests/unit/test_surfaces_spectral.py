"""Surfaces of a given spectrum, and the spectrum and the Hurst exponent of any surface."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.surfaces import (
    Surface,
    from_spectrum,
    gaussian,
    power_spectrum,
    read,
    read_spectrum,
    spectral,
    statistics,
)
from tests.refusals import refuses
from tests.surfaces import correlated

HURST = (0.3, 0.5, 0.8)


def waves(heights: np.ndarray, spacing: Any = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Wave number and squared amplitude of all modes, by the full complex transform."""
    sizes = np.broadcast_to(spacing, heights.ndim)
    axes = [2 * np.pi * np.fft.fftfreq(n, d) for n, d in zip(heights.shape, sizes, strict=True)]
    q = np.sqrt(sum(k**2 for k in np.meshgrid(*axes, indexing="ij")))
    return q, np.abs(np.fft.fftn(heights) / heights.size) ** 2


@pytest.mark.parametrize(("shape", "spacing"), [((64, 48), (0.5, 2.0)), ((63, 31), 1e-7), ((200,), (3.0,))])
def test_roughness_is_exact(shape: Any, spacing: Any) -> None:
    for power, name in enumerate(("rms_height", "rms_slope", "rms_curvature")):
        heights = spectral(shape, spacing=spacing, seed=2, **{name: 0.25})
        q, squared = waves(heights, spacing)
        measured = math.sqrt(np.sum(q ** (2 * power) * squared))
        assert measured / (heights.ndim if power == 2 else 1) == pytest.approx(0.25, rel=1e-12)
        assert abs(heights.mean()) < 1e-12 * heights.std()


def test_seeds_differ_in_phases_only() -> None:
    one, other = spectral((32, 32), seed=1), spectral((32, 32), seed=2)
    assert np.abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.9
    np.testing.assert_allclose(waves(one)[1], waves(other)[1], atol=1e-15)
    np.testing.assert_array_equal(one, spectral((32, 32), seed=1))
    assert spectral(16).std() == pytest.approx(1.0)


@pytest.mark.parametrize(("shape", "axis"), [((40, 30), 0), ((40, 30), 1), ((64,), 0)])
def test_the_power_is_that_of_its_definition(shape: tuple[int, ...], axis: int) -> None:
    """By the sum itself, mode by mode, at one wave vector; and all waves together are the rms height."""
    size = (0.5, 0.25)[: len(shape)]
    sites = np.meshgrid(*(d * np.arange(n) for n, d in zip(shape, size, strict=True)), indexing="ij")
    q, area = 2 * np.pi * 5 / (shape[axis] * size[axis]), math.prod(size)
    heights = 3 * np.cos(q * sites[axis] + 0.7)
    measured = power_spectrum(Surface(heights, "nm", size, "um"))
    assert (measured.window, measured.unit, measured.length_unit) == ("none", "nm", "um")
    power = area / heights.size * abs(np.sum(heights * np.exp(-1j * q * sites[axis]))) ** 2
    at = int(np.argmax(measured.power))
    assert measured.power[at] * measured.modes[at] == pytest.approx(power)
    total = 2 * np.sum(measured.power * measured.modes) / (heights.size * area)
    assert total == pytest.approx(np.mean(heights**2))
    along_q, along = measured.along[axis]
    assert along_q[np.argmax(along)] == pytest.approx(q)
    assert 2 * along.sum() / (shape[axis] * size[axis]) == pytest.approx(np.mean(heights**2))


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
        for seed in range(2):
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
    found = power_spectrum(
        spectral((256, 256), roll_off=64, cutoff=4, hurst=0.6), longest=50.0, shortest=5.0
    ).fit
    assert found is not None
    assert found.hurst == pytest.approx(0.6, abs=1e-9)
    assert found.shortest >= 5
    assert found.longest <= 50


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


def lorentzian(q: np.ndarray) -> np.ndarray:
    """A spectrum of no Hurst exponent."""
    return np.asarray(0.02 / (1 + (q / 0.6) ** 2) ** 2)


@pytest.mark.parametrize(
    ("shape", "size"), [((60, 96), 0.5), ((64, 45), (0.25, 2.0)), ((301,), 0.3), (128, 1.0), ((1, 64), 1.0)]
)
def test_a_surface_has_the_spectrum_that_it_is_given(shape: Any, size: Any) -> None:
    heights = from_spectrum(shape, lorentzian, pixel_size=size, seed=4)
    q, squared = waves(heights, size)
    # |h_q|^2 of the mean over sites, times the area, is C: (2 pi)^-d times its integral is the rms squared.
    area = heights.size * np.prod(np.broadcast_to(size, heights.ndim))
    np.testing.assert_allclose((squared * area)[q > 0], lorentzian(q[q > 0]), rtol=1e-9)
    assert abs(heights.mean()) < 1e-12
    cell = (2 * np.pi) ** heights.ndim / area
    integral = np.sum(lorentzian(q[q > 0])) * cell / (2 * np.pi) ** heights.ndim
    assert heights.std() == pytest.approx(math.sqrt(integral), rel=1e-12)


def test_what_the_library_measures_is_what_was_given() -> None:
    heights = from_spectrum((256, 256), lorentzian, pixel_size=0.5, seed=1)
    measured = power_spectrum(Surface(heights, "um", (0.5, 0.5), "um"))
    assert measured.window == "none"
    # Bins are a quarter wide, and C is convex across them.
    np.testing.assert_allclose(measured.power, lorentzian(measured.wave_number), rtol=0.04)
    # And the other way: a surface of what was measured has the same spectrum within its table.
    again = power_spectrum(
        from_spectrum((256, 256), (measured.wave_number, measured.power), pixel_size=0.5), (0.5, 0.5)
    )
    np.testing.assert_allclose(again.power[2:-1], measured.power[2:-1], rtol=0.04)


@pytest.mark.parametrize(
    ("shape", "size", "hurst"),
    [((64, 48), (1.0, 0.5), 0.7), ((45, 77), (2.0, 2.0), 0.0), ((301,), (0.3,), 1.0)],
)
def test_a_self_affine_spectrum_gives_the_spectral_surface(shape: Any, size: Any, hurst: float) -> None:
    longest, shortest = 20 * max(size), 4 * max(size)
    own = spectral(
        shape, hurst=hurst, roll_off=longest, cutoff=shortest, spacing=size, rms_height=2.0, seed=7
    )
    q, squared = waves(own, size)
    level = np.max(squared) * own.size * math.prod(size)
    start, end = 2 * np.pi / longest, 2 * np.pi / shortest
    fall = -(own.ndim + 2 * hurst)

    def law(q: np.ndarray) -> np.ndarray:
        return np.where(q <= end * (1 + 1e-9), level * np.maximum(q / start, 1) ** fall, 0)

    same = from_spectrum(shape, law, pixel_size=size, seed=7)
    np.testing.assert_allclose(same, own, atol=1e-12)
    # In a table of two points the power law between them is exact; there is nothing outside.
    band = (np.array([start, end]), level * np.array([1, (end / start) ** fall]))
    inside = (q >= start * (1 - 1e-9)) & (q <= end * (1 + 1e-9))
    _, of_table = waves(from_spectrum(shape, band, pixel_size=size, seed=7), size)
    np.testing.assert_allclose(of_table[inside], squared[inside], rtol=1e-9)
    assert of_table[~inside].max() < 1e-25


@pytest.mark.filterwarnings("ignore:invalid value")
def test_what_is_no_spectrum_is_refused() -> None:
    rough = gaussian((32, 32))
    calls: list[tuple[str, Any, dict[str, Any]]] = [
        ("hurst", spectral, {"hurst": 1.1}),
        ("cutoff", spectral, {"cutoff": 1.0}),
        ("cutoff", spectral, {"cutoff": 17.0, "roll_off": 16.0}),
        ("roll_off", spectral, {"roll_off": 1.0}),
        ("rms_slope", spectral, {"rms_slope": 0.0}),
        ("roughness", spectral, {"rms_slope": 1.0, "rms_height": 2.0}),
        ("spacing", spectral, {"spacing": (1.0, 2.0, 3.0)}),
        ("spacing", spectral, {"spacing": 0.0}),
        ("shape", spectral, {"cutoff": 50.0, "roll_off": 60.0}),
        ("spectrum", from_spectrum, {"spectrum": ([1.0, 1.0], [2.0, 2.0])}),
        ("spectrum", from_spectrum, {"spectrum": ([1.0], [2.0])}),
        ("spectrum", from_spectrum, {"spectrum": ([1.0, 2.0], [2.0, 2.0, 2.0])}),
        ("spectrum", from_spectrum, {"spectrum": ([100.0, 200.0], [1.0, 1.0])}),
        ("spectrum", from_spectrum, {"spectrum": 3.0}),
        ("spectrum", from_spectrum, {"spectrum": lambda q: -q}),
        ("spectrum", from_spectrum, {"spectrum": lambda q: np.log(q - 1.0)}),
        ("spectrum", from_spectrum, {"spectrum": lambda q: 0 * q}),
        ("spectrum", from_spectrum, {"spectrum": lambda q: q[:3]}),
        ("q", from_spectrum, {"spectrum": ([0.0, 1.0], [1.0, 1.0])}),
        ("C", from_spectrum, {"spectrum": ([1.0, 2.0], [1.0, 0.0])}),
        ("longest, shortest", power_spectrum, {"longest": 2.2, "shortest": 2.1}),
        ("shortest", power_spectrum, {"longest": 5.0, "shortest": 6.0}),
    ]
    for name, make, options in calls:
        with refuses(name):
            make(rough if make is power_spectrum else (32, 16), **options)


@pytest.mark.parametrize(
    ("header", "unit", "q", "power"),
    [
        ("q_1/um,C_um^4", "um", 1, 1),
        ("q_1/um,C_um^4", "m", 1e6, 1e-24),
        ("wave number [rad/m];PSD (nm^2 um^2)", "um", 1e-6, 1e-6),
        ("power spectrum (m^4)\tq (1/nm)", "nm", 1, 1e36),
        ("q,C(q)", "um", 1, 1),
        ("q,C", None, 1, 1),
        ("", None, 1, 1),
    ],
)
def test_tables_of_spectra(tmp_path: Path, header: str, unit: Any, q: float, power: float) -> None:
    mark = next((mark for mark in ",;\t" if mark in header), ",")
    turned = header.startswith("power")
    rows = [(2.0, 1.0), (4.0, 3.0)] if turned else [(1.0, 2.0), (3.0, 4.0)]
    path = tmp_path / "psd.csv"
    path.write_text("\n".join([header, *(f"{a}{mark}{b}" for a, b in rows)]).strip() + "\n")
    found = read_spectrum(path, unit=unit)
    np.testing.assert_allclose(found[0], [1 * q, 3 * q])
    np.testing.assert_allclose(found[1], [2 * power, 4 * power])


def test_tables_that_are_no_spectrum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for header, name, unit in (
        ("f,C", "psd.csv", None),
        ("q,C,PSD", "psd.csv", None),
        ("q_1/um,C_um^4", "unit", None),
        ("q (s),C", "column 'q (s)' of psd.csv", None),
        ("q,C (1/m)", "column 'C (1/m)' of psd.csv", None),
        ("q_1/um,C_um^3", "column 'C_um^3' of psd.csv", "um"),
    ):
        row = ",".join("1" * (header.count(",") + 1))
        Path("psd.csv").write_text(f"{header}\n{row}\n")
        with refuses(name):
            read_spectrum("psd.csv", unit=unit)


def test_a_profile_has_a_spectrum_of_its_own_unit(tmp_path: Path) -> None:
    (tmp_path / "psd.csv").write_text("q_1/um,C_um^3\n1,2\n3,4\n")
    np.testing.assert_allclose(read_spectrum(tmp_path / "psd.csv", unit="nm", dimension=1)[1], [2e9, 4e9])
