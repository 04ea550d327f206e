"""Surfaces made at random, of a given spectrum or in closed form, and the spectrum of any surface."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
import scipy.stats

from asperity.surfaces import (
    Surface,
    array,
    exponential,
    from_spectrum,
    gaussian,
    paraboloid,
    power_spectrum,
    punch,
    read,
    read_spectrum,
    self_affine,
    spectral,
    sphere,
)
from tests.refusals import each_refuses, refuses
from tests.surfaces import correlated

LAWS = {gaussian: scipy.stats.norm(scale=2.5), exponential: scipy.stats.expon(scale=2.5)}


@pytest.mark.parametrize("make", LAWS)
def test_uncorrelated_heights_follow_their_law_and_their_seed(make):
    law, heights = LAWS[make], make((300, 300), rms=2.5, seed=11)
    # A right law fails this at one seed in a thousand; the seed is fixed.
    assert scipy.stats.kstest(heights.ravel(), law.cdf).pvalue > 1e-3
    # The standard error of the variance is sqrt((kurtosis - 1) / N) of it.
    kurtosis = 3 + float(law.stats("k"))
    assert heights.var() == pytest.approx(2.5**2, rel=4 * math.sqrt((kurtosis - 1) / heights.size))
    deviation = heights - heights.mean()
    for axis in (0, 1):
        correlation = np.mean(deviation * np.roll(deviation, 1, axis=axis)) / heights.var()
        assert abs(correlation) < 4 / math.sqrt(heights.size)
    np.testing.assert_allclose(make((300, 300), seed=np.int64(11)), heights / 2.5, rtol=1e-15)
    assert not np.array_equal(make((300, 300), rms=2.5, seed=12), heights)
    assert make(7).shape == make((7,)).shape == (7,)


def slow_self_affine(size, hurst, delta, seed):
    """The paper's text, site by site; the random values are drawn in the same order as in the package."""
    rng = np.random.default_rng(seed)
    xi = [[0.0] * size for _ in range(size)]
    side = size
    while side >= 2:
        half = side // 2
        distance = side / 2**0.5
        for i in range(half, size, side):
            for j in range(half, size, side):
                corners = [xi[(i + a) % size][(j + b) % size] for a in (-half, half) for b in (-half, half)]
                xi[i][j] = sum(corners) / 4 + rng.normal(0.0, distance**hurst * delta)
        distance /= 2**0.5
        turned = [(i, j) for i in range(half, size, side) for j in range(0, size, side)]
        turned += [(i, j) for i in range(0, size, side) for j in range(half, size, side)]
        known = [list(row) for row in xi]
        for i, j in turned:
            steps = ((half, 0), (-half, 0), (0, half), (0, -half))
            around = [known[(i + a) % size][(j + b) % size] for a, b in steps]
            xi[i][j] = sum(around) / 4 + rng.normal(0.0, distance**hurst * delta)
        side = half
    return np.array(xi)


@pytest.mark.parametrize(("size", "hurst", "delta"), [(2, 0.5, 0.01), (32, 0.3, 0.2)])
def test_self_affine_equals_the_paper_site_by_site(size, hurst, delta):
    fast, slow = self_affine(size, hurst=hurst, delta=delta, seed=9), slow_self_affine(size, hurst, delta, 9)
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-13 * np.abs(fast).max())


def test_what_is_no_self_affine_surface_is_refused():
    # Other types of numbers are tried on all public functions, in test_public_calls.
    wrong: dict[str, Any] = {"size": (1, 3, 100), "hurst": (0, 1.01), "delta": (0, -1.0), "seed": (-1,)}
    for name, values in wrong.items():
        each_refuses(*((name, value, partial(self_affine, **{"size": 8, name: value})) for value in values))


def waves(heights, spacing=1.0):
    """Wave number and squared amplitude of all modes, by the full complex transform."""
    sizes = np.broadcast_to(spacing, heights.ndim)
    axes = [2 * np.pi * np.fft.fftfreq(n, d) for n, d in zip(heights.shape, sizes, strict=True)]
    q = np.sqrt(sum(k**2 for k in np.meshgrid(*axes, indexing="ij")))
    return q, np.abs(np.fft.fftn(heights) / heights.size) ** 2


@pytest.mark.parametrize(("shape", "spacing"), [((64, 48), (0.5, 2.0)), ((63, 31), 1e-7), ((200,), (3.0,))])
def test_roughness_is_exact(shape, spacing):
    for power, name in enumerate(("rms_height", "rms_slope", "rms_curvature")):
        roughness: dict[str, Any] = {name: 0.25}
        heights = spectral(shape, spacing=spacing, seed=2, **roughness)
        q, squared = waves(heights, spacing)
        measured = math.sqrt(np.sum(q ** (2 * power) * squared))
        assert measured / (heights.ndim if power == 2 else 1) == pytest.approx(0.25, rel=1e-12)
        assert abs(heights.mean()) < 1e-12 * heights.std()


def test_seeds_differ_in_phases_only():
    one, other = spectral((32, 32), seed=1), spectral((32, 32), seed=2)
    assert np.abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.9
    np.testing.assert_allclose(waves(one)[1], waves(other)[1], atol=1e-15)
    np.testing.assert_array_equal(one, spectral((32, 32), seed=1))
    assert spectral(16).std() == pytest.approx(1.0)


@pytest.mark.parametrize(("shape", "axis"), [((40, 30), 0), ((40, 30), 1), ((64,), 0)])
def test_the_power_is_that_of_its_definition(shape, axis):
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


def test_white_noise_keeps_its_power_under_the_window():
    heights = gaussian((256, 256), seed=1)
    for surface, window in ((heights, "none"), (heights + 3.0 * np.arange(256), "Hann")):
        measured = power_spectrum(surface)
        assert measured.window == window
        assert np.average(measured.power, weights=measured.modes) == pytest.approx(1.0, rel=0.02)
        assert measured.fit is None


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_the_hurst_exponent_is_found(hurst):
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
            middle = found.wave_number.size // 2
            there = found.fit.power(found.wave_number[middle])
            assert float(there) == pytest.approx(found.power[middle], rel=0.5)


def test_grooves_over_a_rough_background_have_no_exponent_but_one_along_each_axis():
    profile = spectral(256, hurst=0.8, cutoff=2, rms_height=1.0, seed=0)
    rough = spectral((256, 256), hurst=0.2, cutoff=2, rms_height=0.05, seed=100)
    found = power_spectrum(profile + rough)
    assert found.fit is None
    across = found.hurst_along[1]
    # As numpy's straight line through the logarithms of the waves themselves has it, to the mean over bins.
    q, power = found.along[1]
    slope = np.polyfit(np.log(q), np.log(power), 1)[0]
    assert across == pytest.approx(-(1 + slope) / 2, abs=0.005)
    assert across == pytest.approx(0.784, abs=0.001)
    (remark,) = found.remarks
    assert "along the rows 0.784, along the columns 0.27" in remark
    turned = power_spectrum((profile + rough).T)
    assert turned.hurst_along[0] == pytest.approx(across)
    # Isotropic ones are not remarked: the largest ratio of 280 was 1.28, of narrow strips.
    for seed in range(4):
        strip = spectral((512, 512), hurst=0.8, roll_off=64, cutoff=4, seed=seed)[:100, :300]
        assert power_spectrum(strip).remarks == ()
    assert power_spectrum(profile).remarks == ()


def test_the_range_ends_at_roll_off_and_cutoff_or_where_it_is_told():
    found = power_spectrum(spectral((512, 512), roll_off=128, cutoff=8, hurst=0.8)).fit
    assert found is not None
    assert 128 / 1.3 < found.longest < 128 * 2
    assert 8 <= found.shortest < 8 * 1.3
    rough = spectral((256, 256), roll_off=64, cutoff=4, hurst=0.6)
    found = power_spectrum(rough, longest=50.0, shortest=5.0).fit
    assert found is not None
    assert found.hurst == pytest.approx(0.6, abs=1e-9)
    assert 5 <= found.shortest < found.longest <= 50


def test_a_mirrored_scan_is_measured_once(tmp_path):
    part = spectral((300, 300), hurst=0.7, cutoff=3, seed=2)[:120, :150]
    np.save(tmp_path / "scan.npy", part)
    mirrored, *alone = (
        power_spectrum(read(tmp_path / "scan.npy", periodic=rule, pixel_size=0.5))
        for rule in ("mirror", "wrap", "reflect")
    )
    assert mirrored.window == "Hann"
    for other in alone:
        np.testing.assert_array_equal(mirrored.power, other.power)
    assert mirrored.fit is not None
    assert mirrored.fit.longest <= 0.5 * 120 / 3


def test_surfaces_without_waves_have_no_exponent():
    for heights in (np.zeros((9, 9)), np.ones(1), np.ones((1, 5)), np.eye(2), np.arange(7.0)):
        assert power_spectrum(heights).fit is None


def lorentzian(q):
    """A spectrum of no Hurst exponent."""
    return 0.02 / (1 + (q / 0.6) ** 2) ** 2


@pytest.mark.parametrize(
    ("shape", "size"), [((60, 96), 0.5), ((64, 45), (0.25, 2.0)), (301, 0.3), ((1, 64), 1.0)]
)
def test_a_surface_has_the_spectrum_that_it_is_given(shape, size):
    heights = from_spectrum(shape, lorentzian, pixel_size=size, seed=4)
    q, squared = waves(heights, size)
    # |h_q|^2 of the mean over sites, times the area, is C: (2 pi)^-d times its integral is the rms squared.
    area = heights.size * np.prod(np.broadcast_to(size, heights.ndim))
    np.testing.assert_allclose((squared * area)[q > 0], lorentzian(q[q > 0]), rtol=1e-9)
    assert abs(heights.mean()) < 1e-12


@pytest.mark.parametrize(
    ("shape", "size", "hurst"),
    [((64, 48), (1.0, 0.5), 0.7), ((45, 77), (2.0, 2.0), 0.0), ((301,), (0.3,), 1.0)],
)
def test_a_self_affine_surface_has_its_spectrum(shape, size, hurst):
    longest, shortest = 20 * max(size), 4 * max(size)
    own = spectral(shape, hurst=hurst, roll_off=longest, cutoff=shortest, spacing=size, seed=7)
    q, squared = waves(own, size)
    start, end = 2 * np.pi / longest, 2 * np.pi / shortest
    fall = -(own.ndim + 2 * hurst)
    kept = (q > 0) & (q <= end * (1 + 1e-9))
    law = np.maximum(q[kept] / start, 1) ** fall
    np.testing.assert_allclose(squared[kept], law / law.sum(), rtol=1e-9)
    assert squared[~kept].max() < 1e-25
    # In a table of two points the power law between them is exact; there is nothing outside.
    level = own.size * math.prod(size) / law.sum()
    band = (np.array([start, end]), level * np.array([1, (end / start) ** fall]))
    inside = (q >= start * (1 - 1e-9)) & kept
    _, of_table = waves(from_spectrum(shape, band, pixel_size=size, seed=7), size)
    np.testing.assert_allclose(of_table[inside], squared[inside], rtol=1e-9)
    assert of_table[~inside].max() < 1e-25


@pytest.mark.filterwarnings("ignore:invalid value")
def test_what_is_no_spectrum_is_refused():
    of_own: list[tuple[str, Any]] = [
        ("spectrum", ([1.0, 1.0], [2.0, 2.0])),
        ("spectrum", ([1.0, 2.0], [2.0, 2.0, 2.0])),
        ("spectrum", ([100.0, 200.0], [1.0, 1.0])),
        ("spectrum", 3.0),
        ("spectrum", lambda q: -q),
        ("spectrum", lambda q: np.log(q - 1.0)),
        ("spectrum", lambda q: q[:3]),
        ("q", ([0.0, 1.0], [1.0, 1.0])),
        ("C", ([1.0, 2.0], [1.0, 0.0])),
    ]
    each_refuses(
        *((name, from_spectrum, (32, 16), wrong) for name, wrong in of_own),
        got=" | shapes (2,) and (3,) | none | 3.0 | - | NaN among them | shape (3,) | 0.0 | 0.0",
    )
    of_hurst: list[tuple[str, dict[str, Any]]] = [
        ("hurst", {"hurst": 1.1}),
        ("cutoff", {"cutoff": 1.0}),
        ("cutoff", {"cutoff": 17.0, "roll_off": 16.0}),
        ("roll_off", {"roll_off": 1.0}),
        ("rms_slope", {"rms_slope": 0.0}),
        ("roughness", {"rms_slope": 1.0, "rms_height": 2.0}),
        ("spacing", {"spacing": (1.0, 2.0, 3.0)}),
        ("shape", {"cutoff": 50.0, "roll_off": 60.0}),
    ]
    each_refuses(
        *((name, partial(spectral, (32, 16), **options)) for name, options in of_hurst),
        got="1.1 | 1.0 | 17.0 | 1.0 | 0.0 | rms_height and rms_slope | (1.0, 2.0, 3.0) | 32",
    )
    for name, got, longest, shortest in (("longest, shortest", "0", 2.2, 2.1), ("shortest", "6", 5.0, 6.0)):
        with refuses(name, got):
            power_spectrum(gaussian((32, 32)), longest=longest, shortest=shortest)


@pytest.mark.parametrize(
    ("table", "options", "q", "power"),
    [
        ("q_1/um,C_um^4\n1,2\n3,4", {"unit": "m"}, 1e6, 1e-24),
        ("wave number [rad/m];PSD (nm^2 um^2)\n1;2\n3;4", {"unit": "um"}, 1e-6, 1e-6),
        ("power spectrum (m^4)\tq (1/nm)\n2\t1\n4\t3", {"unit": "nm"}, 1, 1e36),
        ("q,C(q)\n1,2\n3,4", {"unit": "um"}, 1, 1),
        ("1,2\n3,4", {}, 1, 1),
        ("q_1/um,C_um^3\n1,2\n3,4", {"unit": "nm", "dimension": 1}, 1e-3, 1e9),
    ],
)
def test_tables_of_spectra(tmp_path, table, options, q, power):
    path = tmp_path / "psd.csv"
    path.write_text(table)
    found = read_spectrum(path, **options)
    np.testing.assert_allclose(found, [[1 * q, 3 * q], [2 * power, 4 * power]])


def test_tables_that_are_no_spectrum(here):
    for header, got, name, unit in (
        ("f,C", "columns 'f', 'C'", "psd.csv", None),
        ("q,C,PSD", "columns 'q', 'C', 'PSD'", "psd.csv", None),
        ("q_1/um,C_um^4", "none", "unit", None),
        ("q (s),C", "'s'", "column 'q (s)' of psd.csv", None),
        ("q_1/um,C_um^3", "'um^3'", "column 'C_um^3' of psd.csv", "um"),
    ):
        row = ",".join("1" * (header.count(",") + 1))
        (here / "psd.csv").write_text(f"{header}\n{row}\n")
        with refuses(name, got):
            read_spectrum("psd.csv", unit=unit)


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
            with refuses(name, wrong if isinstance(wrong, str | float) else ""):
                make(**given | {name: wrong})
