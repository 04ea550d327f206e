"""The rules that make a measurement ready: filling, tilt, spikes, unit, square pixels, periodicity."""

import dataclasses
import itertools
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.ndimage

from asperity import age, press
from asperity.errors import Remark, SurfaceFileError
from asperity.prediction.plausible import remarks_on_history
from asperity.prediction.results import resolved
from asperity.solids import half_space
from asperity.surfaces import Surface, combined, levelling, prepare, read, spectral
from tests.refusals import each_refuses, refuses

EDGES = "the contact would be at the edges"
U, V = np.meshgrid(np.linspace(-1, 1, 96), np.linspace(-1, 1, 80), indexing="ij")
pytestmark = pytest.mark.usefixtures("here")


def as_read(heights, **options):
    np.save("scan.npy", heights)
    return read("scan.npy", **{"periodic": "reflect", **options})


def rough(seed, **options):
    """A part of a larger surface, of rms height 1."""
    heights = spectral((256, 256), cutoff=4, seed=seed, **options)[:96, :80]
    return heights / heights.std()


def holed(shape, fraction, seed):
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=shape)
    heights[rng.random(shape) < fraction] = np.nan
    return heights


@pytest.mark.parametrize("shape", [(7, 6), (12,), (1, 9)])
def test_a_filled_pixel_is_the_mean_of_its_neighbors(shape):
    heights = holed(shape, 0.4, seed=8)
    heights.flat[0] = np.nan  # a corner too
    filled = prepare.fill(heights)
    for site in np.ndindex(shape):
        steps = [step * axis for axis in np.eye(len(shape), dtype=int) for step in (-1, 1)]
        around = [tuple(site + step) for step in steps]
        around = [other for other in around if all(0 <= i < n for i, n in zip(other, shape, strict=True))]
        known = not np.isnan(heights[site])
        expected = heights[site] if known else np.mean([filled[other] for other in around])
        assert filled[site] == pytest.approx(expected, abs=0 if known else 1e-12)


def test_fill_creates_no_summit():
    # Offsets bring out rounding: a filled pixel must not stick out even by one unit in the last place.
    for seed in range(5):
        heights = holed((40, 40), 0.5, seed) + 1e6
        filled = prepare.fill(heights)
        padded = np.pad(filled, 1, constant_values=-np.inf)
        around = np.stack([padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]])
        assert not (filled > around.max(axis=0))[np.isnan(heights)].any()
        assert filled.max() == np.nanmax(heights)
        assert filled.min() == np.nanmin(heights)
    level = np.full((20, 20), 0.1)
    level[3:9, 2:17] = np.nan
    assert np.unique(prepare.fill(level)).tolist() == [0.1]


@pytest.mark.parametrize("rule", ["mean", "plane", "quadratic"])
@pytest.mark.parametrize("shape", [(12, 9), (30,), (1, 8), (2, 2)])
def test_the_polynomial_of_least_squares_is_removed_and_told(shape, rule):
    axes = np.indices(shape).astype(float)
    pairs = list(itertools.combinations_with_replacement(axes, 2)) if rule == "quadratic" else []
    terms = [np.ones(shape), *axes, *(one * other for one, other in pairs)]
    heights = np.random.default_rng(1).normal(size=shape) + 1e4
    defined = np.ones(shape, dtype=bool)
    defined.flat[[3, 11] if heights.size > 20 else []] = False
    left, found = levelling.remove_tilt(np.where(defined, heights, 1e3), defined, rule)
    told = sum(number * term for number, term in zip(found, terms, strict=True))
    np.testing.assert_allclose(left, np.where(defined, heights, 1e3) - told, atol=1e-9)
    # What is left is orthogonal to each term, and nothing of a polynomial.
    for term in terms[:1] if rule == "mean" else terms:
        assert np.sum((left * term)[defined]) == pytest.approx(0, abs=1e-8 * max(np.sum(np.abs(term)), 1))
    if rule == "mean":
        assert not any(found[1:])
    else:
        assert not levelling.remove_tilt(told, np.ones(shape, dtype=bool), rule)[0].any()


PATCHES = {
    "edge": (slice(None), slice(0, 7)),
    "corner": (slice(80, None), slice(60, None)),
    "frame": (slice(0, 4), slice(None)),
    "hole": (slice(30, 50), slice(20, 45)),
    "middle": (slice(40, 44), slice(30, 50)),
}


@pytest.mark.parametrize("tilt", ["plane", "quadratic"])
@pytest.mark.parametrize("patch", PATCHES)
def test_levelling_an_exact_polynomial_leaves_nothing_anywhere(patch, tilt):
    exact = 40 * U - 700 * V + 300 + ((90 * U**2 - 55 * U * V) if tilt == "quadratic" else 0)
    exact[PATCHES[patch]] = np.nan
    surface = as_read(exact, tilt=tilt)
    assert not surface.heights.any()
    np.testing.assert_array_equal(surface.filled, np.isnan(exact))
    assert not as_read(exact, tilt="none").level(tilt).heights.any()  # filled while it is tilted
    exact[12, 30] += 900.0
    assert not as_read(exact, tilt=tilt, despike=True).heights.any()
    assert not as_read(exact, tilt="none").level(tilt, despike=True).heights.any()


@pytest.mark.parametrize("patch", PATCHES)
def test_no_filled_pixel_is_above_the_rim_of_its_hole(patch):
    whole = rough(5, roll_off=30)
    whole[70, 70] += 60.0
    tilted = whole + 120 * U + 80 * V + 9 * U**2  # a tilt of a hundred times the roughness, and a bow
    tilted[PATCHES[patch]] = np.nan
    for tilt, despike in itertools.product(("plane", "quadratic"), (False, True)):
        direct = as_read(tilted, tilt=tilt, despike=despike)
        later = as_read(tilted, tilt="none").level(tilt, despike=despike)
        np.testing.assert_allclose(direct.heights, later.heights, atol=1e-11)
        assert direct.filled is not None
        assert direct.filled[70, 70] == despike
        holes, count = scipy.ndimage.label(direct.filled)
        for hole in range(1, count + 1):
            own = holes == hole
            rim = scipy.ndimage.binary_dilation(own) & ~own
            assert direct.heights[own].max() <= direct.heights[rim].max()


def test_spikes_are_counted_and_filled_if_asked_and_no_other_pixel():
    heights = rough(2, roll_off=20) + 30 * V  # a tilt that hides spikes and is bent by them
    dusty = heights.copy()
    places = (np.array([3, 40, 41, 90]), np.array([70, 10, 10, 50]))
    dusty[places] += [40, 400, 400, 12]
    dusty[50, 50] -= 30.0  # a pit is none
    told, found = as_read(dusty, tilt="none"), as_read(dusty, despike=True)
    assert len(as_read(dusty).remarks) == 1
    np.testing.assert_array_equal(told.heights, dusty)
    assert found.remarks == ()
    assert (found.provenance["despiked_pixels"], found.provenance["outlying_pixels"]) == (4, 0)
    holed = dusty.copy()
    holed[places] = np.nan
    same = as_read(holed)
    np.testing.assert_array_equal(found.heights, same.heights)
    array = Surface(dusty, edges="reflecting").level(despike=True)
    np.testing.assert_array_equal(array.heights, same.heights)
    assert "despiked_pixels" not in same.provenance
    white = np.random.default_rng(3).normal(size=(50, 60))
    white[10, 7], white[20, 30] = 8.0, 30.0
    facts: Any = as_read(white).provenance
    assert (facts["outlying_pixels"], facts["outlying_height"]) == (2, pytest.approx(30, rel=0.1))


def test_what_is_no_spike_stays():
    heights = rough(3)
    before, after = (as_read(heights, despike=wanted) for wanted in (False, True))
    np.testing.assert_array_equal(before.heights, after.heights)
    assert after.provenance["despiked_pixels"] == 0
    # Where most heights are equal, no scale tells which are far.
    assert as_read(np.eye(9), tilt="none").remarks == ()
    # Pillars on a fifth of a plate: heights, whatever the median says.
    plate = 0.01 * rough(4) + 5.0 * (np.arange(80) % 5 == 0)
    each_refuses(
        ("despike", "0.2", lambda: as_read(plate, despike=True)),
        ("despike", "0.2", lambda: Surface(plate).level(despike=True)),
        ("tilt", "'parabola'", Surface(plate).level, "parabola"),
    )


@pytest.mark.parametrize("form", [V**2, 0.4 * U**2 + V**2 + 0.5 * U * V])
def test_a_bow_that_puts_the_contact_at_the_edges_is_remarked(form):
    bowed = rough(1, roll_off=20) + 12 * form + 3 * U
    bowed[1, 5] += 500.0  # which is most of the variance
    assert [remark.startswith(EDGES) for remark in as_read(bowed).remarks] == [False, True]
    assert as_read(bowed, tilt="quadratic", despike=True).remarks == ()
    assert not [r for r in as_read(bowed, longest=20.0).remarks if r.startswith(EDGES)]
    assert Surface(bowed).level(despike=True).remarks[0].startswith(EDGES)
    # The same upside down touches in the middle, and is a bow all the same.
    (remark,) = as_read(rough(0, roll_off=20) - 12 * form).remarks
    assert "a polynomial of second order has 9" in remark


@pytest.mark.parametrize(("most", "options"), [(1, {}), (0, {"roll_off": 40.0})])
def test_self_affine_surfaces_have_no_bow(most, options):
    fired = 0
    for seed in range(50):
        for heights in (rough(seed, **options), spectral((96, 96), cutoff=4, seed=seed, **options)):
            remarks = Surface(heights, edges="reflecting").level().remarks
            fired += any(remark.startswith(EDGES) for remark in remarks)
    assert fired <= most


def test_small_and_flat_surfaces_tell_no_bow():
    for heights in (np.zeros((20, 20)), U[:3, :3] ** 2, np.arange(9.0), np.ones((1, 1))):
        assert levelling.bow(heights) == {"bow_variance": 0.0, "highest_at_edges": 0.0}


def test_units_are_converted_or_kept_or_become_the_rms():
    heights = np.array([1.0, -1.0, 3.0, -3.0])
    for unit, target, factor in (("um", "nm", 1e3), ("angstrom", "um", 1e-4), ("V", None, 1.0)):
        assert prepare.scale_factor(heights, unit, target, largest=3.0) == (factor, target or unit)
    factor, unit = prepare.scale_factor(heights, "1", "rms", largest=3.0)
    assert unit == "rms"
    assert np.std(heights * factor) == pytest.approx(1.0)
    with refuses("unit", "heights in 'V'"):
        prepare.scale_factor(heights, "V", "nm", largest=1.0)


@pytest.mark.parametrize(("ratio", "kept"), [(3.0, 4), (2.5, 4), (1.3, 9)])
def test_oblong_pixels_are_averaged_along_the_finer_axis_when_asked(ratio, kept):
    heights = np.random.default_rng(1).normal(size=(5, 12))
    slow = np.zeros((5, kept))
    for pixel in range(kept):
        for place in range(12):
            overlap = min(place + 1, (pixel + 1) * ratio) - max(place, pixel * ratio)
            slow[:, pixel] += max(overlap, 0) / ratio * heights[:, place]
    asked = {"tilt": "none", "resample": True, "unit": "rms"}
    surface = as_read(heights, pixel_size=(ratio * 0.1, 0.1), **asked)
    np.testing.assert_allclose(surface.heights, slow / slow.std(), atol=1e-13)
    assert surface.pixel_size == pytest.approx((ratio * 0.1, ratio * 0.1))
    record: Any = surface.provenance
    assert (record["final_shape"], record["original_shape"]) == ([5, kept], [5, 12])
    assert record["resampled"]
    turned = as_read(heights.T, pixel_size=(0.1, ratio * 0.1), **asked)
    np.testing.assert_array_equal(turned.heights, surface.heights.T)


def test_square_and_unknown_pixels_stay():
    heights = np.random.default_rng(1).normal(size=(4, 5))
    sizes: list[Any] = [None, (2.0, 2.01)]
    for size in sizes:
        kept = as_read(heights, tilt="none", pixel_size=size, resample=True)
        np.testing.assert_array_equal(kept.heights, heights)
        assert kept.pixel_size == size
    with refuses("resample", "5 along an axis"):
        as_read(heights, pixel_size=(3.0, 1.0), resample=True)


def test_taper_is_half_a_cosine_toward_the_mean_along_each_axis():
    def weight(n):
        """Half a cosine over a tenth of n pixels, at their middles."""
        place = np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5)
        return np.where(place < 0.1 * n, 0.5 * (1 - np.cos(np.pi * place / (0.1 * n))), 1.0)

    profile = np.where(np.arange(40) % 2, 1.0, 5.0)  # deviations of -2 and 2 from the mean 3
    tapered = prepare.make_periodic(profile, "taper")
    np.testing.assert_allclose(tapered, 3 + weight(40) * (profile - 3), atol=1e-14)
    sign = np.where(np.add.outer(np.arange(20), np.arange(30)) % 2, 1.0, -1.0)
    tapered = prepare.make_periodic(sign, "taper")
    np.testing.assert_allclose(tapered, sign * np.outer(weight(20), weight(30)), atol=1e-14)


LENGTHS: dict[str, Any] = {"file_unit": "um", "pixel_size": 1.0, "length_unit": "um"}


def test_filled_pixels_are_remembered_wherever_the_surface_goes():
    heights = rough(6)
    heights[:3, 5:9] = np.nan
    mask = np.isnan(heights)
    surface = as_read(heights)
    np.testing.assert_array_equal(surface.filled, mask)
    np.testing.assert_array_equal(as_read(heights, periodic="mirror").scan.filled, mask)
    assert as_read(heights, periodic="mirror").filled.shape == (192, 160)
    np.testing.assert_array_equal(as_read(heights, crop=[1, 60, 6, 70]).filled, mask[1:60, 6:70])
    np.testing.assert_array_equal(surface.crop([1, 60, 6, 70]).filled, mask[1:60, 6:70])
    np.testing.assert_array_equal(surface.band(longest=30.0).level().filled, mask)
    other = Surface(rough(7), edges="reflecting")
    for pair in ((surface, other), (other, surface)):
        np.testing.assert_array_equal(combined(*pair).filled, mask)
    assert combined(other, other).filled is None
    assert as_read(rough(6)).filled is None
    oblong = as_read(heights, pixel_size=(2.0, 1.0), resample=True)
    np.testing.assert_array_equal(oblong.filled, mask[:, ::2] | mask[:, 1::2])
    with refuses("filled", "(95, 80)"):
        Surface(rough(6), filled=mask[1:])


def test_load_on_filled_pixels_is_remarked():
    heights = rough(8)
    heights[40:55, 30:50] = np.nan  # 300 of 7680 pixels
    surface = as_read(heights, **LENGTHS)
    solid = half_space(modulus=1e9)
    press(surface, solid, load="1 mN")
    lifted = dataclasses.replace(surface, heights=surface.heights + 20 * surface.filled)
    with pytest.warns(Remark, match=r"100 % of the load is on filled pixels.*crop the scan"):
        press(lifted, solid, load="1 mN")
    # Under a load that grows they bear at last what every pixel bears; a history says so.
    with pytest.warns(Remark, match="on filled pixels"):
        flat = press(surface, solid, pressure="200 GPa")
    dataset = age(flat, [1.0], fields_at=[0.0, 1.0]).dataset
    on_filled, *limits = remarks_on_history(surface, solid, dataset, resolved(dataset, solid, surface.filled))
    assert float(on_filled.split()[0]) == pytest.approx(300 / 76.80, rel=0.2)
    assert [*remarks_on_history(surface, solid, dataset, resolved(dataset, solid))] == limits


@pytest.mark.parametrize("void", [-9999.0, -32768.0, 0.0, 1e38])
def test_a_void_value_is_doubted(void):
    heights = rough(9, roll_off=30) + 100.0
    assert as_read(heights).remarks == ()
    heights[70:, 70:] = void
    said = " ".join(as_read(heights).remarks)
    assert f"260 pixels have the height {void:.10g}" in said
    assert f"try undefined_value = {void:.10g}" in said
    # Among the others it is told by being frequent; heights in steps are not doubted.
    assert "260 pixels have the height 100," in as_read(np.where(heights == void, 100.0, heights)).remarks[0]
    assert as_read(np.round(rough(9), 1)).remarks == ()
    # What was told to be undefined is no doubt.
    heights[70:, 70:] = np.nan
    (filled,) = as_read(heights).remarks
    assert f"{100 * np.isnan(heights).mean():.3g} % of the pixels are undefined and were filled" in filled
    assert as_read(heights, undefined="no-body").remarks == ()


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        ({**LENGTHS, "pixel_size": 1.0, "length_unit": "m"}, "an rms slope of {:.2g} and a side of 96 m: "),
        ({**LENGTHS, "file_unit": "m"}, "an rms slope of {:.2g}: "),
        ({**LENGTHS, "length_unit": "mm", "file_unit": "nm"}, "an rms slope of {:.2g}: "),
        (LENGTHS, ""),
        ({"pixel_size": 5.0}, ""),
    ],
)
def test_slopes_and_sizes_that_no_scan_has_are_doubted(lengths, said):
    surface = as_read(rough(3), **lengths)
    begins = said.format(surface.describe().rms_slope)
    assert len(surface.remarks) == bool(said)
    for remark in surface.remarks:
        assert remark.startswith(begins)
        assert "try file_unit, or pixel_size" in remark
    if said:  # made, not measured
        made = Surface(rough(3), "um", (1.0, 1.0), "m", {"kind": "spectral"})
        assert made.remarks == ()


def test_lines_are_levelled_by_their_medians():
    wrong: Any = "mean"
    heights = rough(10, roll_off=20)
    offsets = 3 * np.random.default_rng(0).normal(size=(96, 1))
    lined = heights + offsets + 5 * V
    lined[50:53, 10:30] = np.nan
    lined[60] = np.nan
    filled, remark = as_read(lined, max_undefined=0.2).remarks
    assert "lines = 'median'" in remark
    found = as_read(lined, lines="median", max_undefined=0.2)
    assert found.remarks == (filled,)
    known = ~np.isnan(lined)
    # The least-squares plane, then the median of each row, then the plane again, by other means.
    grid = np.stack([np.ones(lined.shape), U, V], axis=-1)
    level = lined.copy()
    for turn in range(2):
        level -= grid @ np.linalg.lstsq(grid[known], level[known], rcond=None)[0]
        if not turn:
            level -= np.nan_to_num(pd.DataFrame(level).median(axis=1).to_numpy())[:, None]
    np.testing.assert_allclose(found.heights[known], level[known], atol=1e-12)
    array = as_read(lined, tilt="none", max_undefined=0.2).level(lines="median")
    np.testing.assert_allclose(array.heights, found.heights, atol=1e-12)
    assert (array.edges, array.provenance["tilt_rule"]) == (found.edges, "plane")
    each_refuses(
        ("lines", "'median'", lambda: as_read(lined[0], lines="median", max_undefined=0.5)),
        ("lines", "'mean'", lambda: Surface(heights).level(lines=wrong)),
    )


def test_an_undefined_frame_is_told_how_to_be_cropped():
    framed = np.full((40, 50), np.nan)
    framed[4:30, 7:50] = rough(1)[4:30, 7:50]
    for first in ({}, {"crop": [2, 40, 0, 50]}):
        with refuses("scan.npy", kind=SurfaceFileError):
            as_read(framed, **first)
    assert as_read(framed, crop=[4, 30, 7, 50]).filled is None
    framed[::2] = np.nan
    with refuses("scan.npy", "1441", kind=SurfaceFileError):  # which no crop helps
        as_read(framed)
