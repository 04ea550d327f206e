"""Analysis: what a history, a prediction or an instrument says, by closed forms, counting, known spreads."""

import math
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr

import asperity as asp
from asperity import age, press, relax
from asperity.analysis import SiteState, aging_summary, contact_maps, with_limit
from asperity.analysis.aging import FAR_APART
from asperity.analysis.bands import OfScan, draws_of_solid
from asperity.figures.contacts import contact_figure
from asperity.prediction.results import Growth, growth_of
from asperity.protocols import Hold, Ramp, Step
from asperity.relaxation import PronySeries
from asperity.solids import spring_lattice
from asperity.surfaces import Surface, gaussian, self_affine
from asperity.theory import ExponentialHeights, GaussianHeights, exponential_growth, site_stiffness
from tests.refusals import each_refuses, refuses
from tests.unit.test_figures import some_maps
from tests.unit.test_fits import saturating

TIMES = np.geomspace(1e-2, 1e4, 25)


@pytest.fixture(scope="module")
def aged() -> xr.Dataset:
    """A self-affine surface on which contacts are won and lost."""
    contact = press(self_affine(32, hurst=0.8, seed=3), spring_lattice(k0=1.0, k1=0.1), load=2.0)
    history = age(contact, [1.0, 100.0, 1e4], fields_at=[0.0, 100.0, 1e4], rtol=1e-2)
    return with_limit(history.dataset, relax(contact))


def synthetic(
    ratio: np.ndarray, times: np.ndarray = TIMES, sites: int = 10**6, **attrs: float | str
) -> xr.Dataset:
    """A history with a given A(t)/A(0), without any simulation."""
    area = 1e4 * np.concatenate([[1.0], ratio])
    conditions: dict[str, float | str] = {
        "k0": 1.0,
        "k1": 3.0,
        "R": 1.0,
        "R_viscous": 0.0,
        "held": "load",
        "held_load": 1e-3 * sites,
    }
    conditions["sites"] = sites
    return xr.Dataset(
        {
            "area": ("time", area),
            "load": ("time", np.full(area.size, 1e-3 * sites)),
            "heights": (("y", "x"), np.zeros((sites // 1000, 1000))),
        },
        coords={"time": np.concatenate([[0.0], times])},
        attrs=conditions | attrs,
    )


def test_maps_account_for_every_site(aged: xr.Dataset) -> None:
    maps = contact_maps(aged)
    assert maps.times.tolist() == [0.0, 100.0, 1e4, np.inf]
    recorded = aged["area"].sel(time=[0.0, 100.0, 1e4]).values
    assert [maps.area(n) for n in range(4)] == [*recorded, aged.attrs["relaxed_area"]]
    for number in range(4):
        assert maps.count(number, SiteState.KEPT) + maps.count(number, SiteState.LOST) == recorded[0]
    assert maps.count(0, SiteState.NEW) == maps.count(0, SiteState.LOST) == 0
    assert min(maps.count(2, SiteState.LOST), maps.count(2, SiteState.NEW)) > 0
    kept, new = (maps.states == state for state in (SiteState.KEPT, SiteState.NEW))
    np.testing.assert_array_equal(kept.any(axis=0), aged["in_contact"].values[0])
    np.testing.assert_array_equal(maps.surfaces[3][new[3]], maps.heights[new[3]])


def test_what_cannot_be_used_is_refused(aged: xr.Dataset) -> None:
    with refuses("dataset", "none"):
        contact_maps(aged.drop_vars(["in_contact", "u"]))
    with refuses("limit", "(8, 8)"):
        with_limit(aged, press(gaussian((8, 8)), spring_lattice(k0=1.0, k1=3.0), load=1.0))
    with refuses("dataset", "none"):
        aging_summary(aged.assign(area=0 * aged["area"]))


def test_the_window_of_a_profile_has_most_contacts() -> None:
    contact = press(gaussian(400, seed=1), spring_lattice(k0=1.0, k1=3.0), load=10.0)
    maps = contact_maps(age(contact, [1.0], fields_at=[0.0, 1.0], rtol=1e-2).dataset)
    first, last = maps.window
    touching = np.isin(maps.states[-1], (SiteState.KEPT, SiteState.NEW))
    assert last - first == 160
    assert touching[first:last].sum() == np.convolve(touching, np.ones(160), "valid").max()


def test_a_known_law_is_found_again() -> None:
    dataset = synthetic(saturating(TIMES, 3.0, 0.4, 2.0), relaxed_area=30000.0)
    summary = aging_summary(dataset)
    assert summary.fit is not None
    assert (summary.fit.a, summary.fit.q, summary.fit.t0) == pytest.approx((3.0, 0.4, 2.0), rel=1e-6)
    assert summary.fit_note == ""
    expected = saturating(summary.curve_time, 3.0, 0.4, 2.0)
    np.testing.assert_allclose(np.asarray(summary.fit_curve), expected, rtol=1e-6)
    assert summary.relaxed_ratio == 3.0
    assert (summary.initial_area, summary.sites) == (10000, 10**6)
    assert summary.dilute_note == "the dilute theory needs independent sites"


def test_the_fit_ends_at_the_limit_that_is_known() -> None:
    # Not a saturation by Eq. (a): a free fit ends above 4, with a standard error that excludes 4.
    ratio = 4 - 3 * np.exp(-((TIMES / 10) ** 0.3))
    free = aging_summary(synthetic(ratio)).fit
    assert free is not None
    assert abs(free.a - 4) > 2 * free.a_stderr
    summary = aging_summary(synthetic(ratio, relaxed_area=40000.0))
    assert summary.fit is not None
    assert summary.fit.a == pytest.approx(4, rel=1e-14)
    assert summary.fit.a_stderr == 0
    assert np.asarray(summary.fit_curve).max() <= 4
    assert summary.fit_worst == pytest.approx(np.abs(1 - summary.fit.area_ratio(TIMES) / ratio).max())
    assert summary.fit_worst > summary.fit.rms_residual > free.rms_residual
    assert aging_summary(synthetic(ratio, relaxed_area=5000.0)).fit_note.startswith(
        "no fit: the relaxed area"
    )


def test_the_load_is_summarized_where_the_separation_is_held() -> None:
    dataset = synthetic(saturating(TIMES, 3.0, 0.4, 2.0), held="separation", relaxed_load=250.0)
    dataset["load"] = ("time", 1000 - 30 * np.arange(26.0))
    summary = aging_summary(dataset)
    assert summary.load is not None
    np.testing.assert_array_equal(summary.load, dataset["load"][1:])
    assert (summary.initial_load, summary.relaxed_load) == (1000.0, 250.0)
    assert aging_summary(synthetic(saturating(TIMES, 3.0, 0.4, 2.0))).load is None


def mirrored(scan: np.ndarray) -> Surface:
    """A scan of 0.5 um a pixel, as `asperity.surfaces.read` makes it periodic."""
    heights = np.pad(scan, [(0, n) for n in scan.shape], mode="symmetric")
    origin: dict[str, Any] = {"file": "scan.npy", "unit": "nm", "periodic_rule": "mirror"}
    origin |= {"pixel_size": [0.5] * scan.ndim, "length_unit": "um"}
    return Surface(heights, "nm", (0.5,) * scan.ndim, "um", origin)


@pytest.mark.parametrize("shape", [(24, 16), (40,)])
def test_maps_of_a_mirrored_scan_show_the_scan(shape: tuple[int, ...]) -> None:
    scan = gaussian(shape, seed=3)
    contact = press(mirrored(scan), spring_lattice(k0=1.0, k1=3.0), load=40.0)
    maps = contact_maps(with_limit(age(contact, [0.0], fields_at=[0.0]).dataset, relax(contact)))
    np.testing.assert_array_equal(maps.heights, scan)
    assert maps.copies == 2 ** len(shape)
    assert maps.states.shape == maps.surfaces.shape == (2, *shape)
    assert (maps.pixel_size, maps.length_unit, maps.unit) == (0.5, "um", "nm")
    assert maps.area(0) * maps.copies == pytest.approx(contact.area, rel=0.05)


def test_a_sample_of_contacts_has_their_share_and_their_places() -> None:
    rng = np.random.default_rng(4)
    states = np.where(rng.random((2, 302, 210)) < 0.03, SiteState.NEW, SiteState.FREE).astype(np.int8)
    states[:, 96:200, 96:200] = SiteState.KEPT  # 52 x 52 cells of 2 x 2 sites
    cells = some_maps(states).sampled(2)
    np.testing.assert_array_equal(cells[:, 48:100, 48:100], SiteState.KEPT)
    for one, drawn in zip(states, cells, strict=True):
        assert 4 * np.count_nonzero(drawn) == pytest.approx(np.count_nonzero(one), rel=0.05)
        blocks = one.reshape(151, 2, 105, 2).swapaxes(1, 2).reshape(151, 105, 4)
        assert (blocks == drawn[..., None]).any(axis=-1).all()
    np.testing.assert_array_equal(some_maps(states).sampled(1), states)


def test_a_fit_that_means_little_says_so() -> None:
    assert "not determined" in aging_summary(synthetic(1 + 0.3 * np.log1p(TIMES / 0.1))).fit_note
    two_steps = saturating(TIMES, 2.0, 3.0, 0.1) + saturating(TIMES, 9.0, 3.0, 300.0) - 1
    assert "misses these areas by" in aging_summary(synthetic(two_steps)).fit_note
    none = aging_summary(synthetic(np.empty(0), times=np.empty(0)))
    few = aging_summary(synthetic(np.array([1.5]), times=np.array([1.0])))
    for one, why in (
        (aging_summary(synthetic(np.ones(25))), "the area does not grow"),
        (few, "it takes 4 times above 0 or more"),
        (none, "only time 0 was asked for"),
    ):
        assert (one.fit, one.fit_curve, one.fit_note) == (None, None, f"no fit: {why}")
    assert none.time.size == none.curve_time.size == 0


def test_exponential_heights_grow_like_the_compliance_until_the_dips_meet() -> None:
    # The closed form G(x1, x2)/G(x1, 0) knows neither load nor height law: an independent path.
    dataset = synthetic(saturating(TIMES, 3.0, 0.4, 2.0), k0=2.0, k1=6.0, held_load=1e4)
    summary = aging_summary(dataset, law=ExponentialHeights(rms=1.0))
    np.testing.assert_allclose(
        summary.dilute_ratio, exponential_growth(3.0, 2.0 * summary.dilute_time), rtol=1e-9
    )
    x2 = 2.0 * summary.curve_time
    fraction = 1e-2 / 2.0 * exponential_growth(3.0, x2) / site_stiffness(3.0)
    apart = x2**0.25 < fraction**-0.5 / FAR_APART
    assert 0 < summary.dilute_time.size == np.count_nonzero(apart) < apart.size
    assert summary.dilute_note == ""


def test_viscous_creep_makes_the_dips_meet_sooner() -> None:
    ratio = saturating(TIMES, 3.0, 0.4, 2.0)
    still = aging_summary(synthetic(ratio, held_load=2e4), law=GaussianHeights())
    viscous = aging_summary(synthetic(ratio, held_load=2e4, R_viscous=1.0), law=GaussianHeights())
    assert viscous.dilute_time[-1] < still.dilute_time[-1] < TIMES[-1]


def test_the_dilute_theory_is_not_claimed_where_it_does_not_hold() -> None:
    dataset = synthetic(saturating(TIMES, 3.0, 0.4, 2.0))
    for attribute, value, note in (
        ("held", "separation", "needs a constant load"),
        ("R", 0.0, "needs k0, k1 and R above 0"),
        ("held_load", 1e6, "too dense"),
        ("k1", 1e-4, "too dense"),  # the elastic dips, (k0/k1)^(1/2) sites wide, meet at once
    ):
        summary = aging_summary(dataset.assign_attrs({attribute: value}), law=GaussianHeights())
        assert summary.dilute_time.size == summary.dilute_ratio.size == 0
        assert note in summary.dilute_note


def made_history(slope: float, spread: float) -> xr.Dataset:
    """A history of area 1 + slope log10 t, in sixteen tiles that grow alike, but for a spread."""
    time = np.geomspace(1.0, 1e4, 17)
    moments = time[::4]
    own = slope * (1 + spread * (-1.0) ** np.arange(4))
    filled = np.round(40 * (1 + own * np.log10(moments)[:, None]))
    sites = np.arange(100).reshape(10, 10) < filled[:, :, None, None]  # of each map in each column of tiles
    rows = np.tile(sites.swapaxes(1, 2).reshape(5, 10, 40), (1, 4, 1))
    area = np.append(1 - slope, 1 + slope * np.log10(time))
    maps = ("field_time", "y", "x")
    return xr.Dataset(
        {
            "contact_area_corrected": ("time", area),
            "load": ("time", np.ones_like(area)),
            "in_contact": (maps, rows),
            "pressure": (maps, np.ones(rows.shape)),
        },
        {"time": np.append(0.0, time), "field_time": moments},
    )


def grown(history: xr.Dataset, series: list[PronySeries]) -> Growth:
    """The growth of a history, with the bands of tiles and series."""
    never: Any = None
    heights = np.zeros(history["in_contact"].shape[1:])
    contact: Any = SimpleNamespace(solid=SimpleNamespace(separable=True), heights=heights, sites=heights.size)
    return growth_of(history, OfScan.of(history, contact), draws_of_solid(history, series, never, never))


def noisy(error: float, seed: int) -> asp.relaxation.Relaxation:
    """The modulus of a compliance of 1 + 0.1 log10 t, very nearly."""
    time = np.geomspace(1.0, 1e4, 30)
    exact = 1e9 / (1 + 0.1 * np.log10(time))
    deviations = np.random.default_rng(seed).normal(size=30)
    return asp.relaxation.Relaxation(time, exact * (1 + error * deviations), noise=0.5)


def drawn(found: asp.relaxation.Fit) -> list[PronySeries]:
    """The series of a table, and those that its noise would have given."""
    return [found.series, *(one.series for one in found.resampled)]


@pytest.fixture(scope="module")
def exact() -> list[PronySeries]:
    return drawn(asp.relaxation.fit(noisy(0.0, 0)))


def test_growth_of_a_straight_line(exact: list[PronySeries]) -> None:
    growth = grown(made_history(0.1, 0.0), exact)
    assert growth.per_decade == pytest.approx(0.1)
    assert [slope for *_, slope in growth.decades] == pytest.approx([0.1] * 4)
    assert [begin for begin, *_ in growth.decades] == pytest.approx([1, 10, 100, 1000])
    np.testing.assert_allclose(growth.of_scan, 0.1, rtol=1e-9)
    np.testing.assert_allclose(growth.of_table, 0.1, rtol=0.02)


def test_tiles_that_grow_differently_widen_the_band(exact: list[PronySeries]) -> None:
    # Half of the tiles grow by 5 %, half by 15 % a decade; of 16 drawn, the mean spreads by 5 % / 4.
    growth = grown(made_history(0.1, 0.5), exact)
    low, high = growth.of_scan
    assert high - low == pytest.approx(2 * 2.131 * 0.05 / np.sqrt(15), rel=0.15)
    assert (growth.band[0] <= low * 1.02, growth.band[1] >= high * 0.98) == (True, True)
    # In four decades half grow by 20 %, half by 60 %.
    assert growth.ratio == pytest.approx(1.4)
    low, high = growth.ratio_band
    assert high - low == pytest.approx(2 * 2.131 * 0.2 / np.sqrt(15), rel=0.15)
    assert growth.range == pytest.approx((0.1, 0.1))


@pytest.mark.slow
def test_a_noisy_table_widens_the_band_as_other_tables_spread() -> None:
    # The area is the compliance here: each table of the same noise gives a slope of its own.
    time = np.geomspace(1.0, 1e4, 17)
    slopes = []
    for seed in range(40):
        compliance = asp.relaxation.fit(noisy(0.01, seed)).series.compliance_at(time)
        slopes.append(np.polyfit(np.log10(time), compliance / compliance[0], 1)[0])
    widths = []
    for seed in (0, 1, 2):
        found = asp.relaxation.fit(noisy(0.01, seed))
        history = made_history(0.1, 0.0)
        compliance = found.series.compliance_at(time)
        history["contact_area_corrected"][1:] = compliance / compliance[0]
        history["contact_area_corrected"][0] = 1 / found.series.modulus / compliance[0]
        low, high = grown(history, drawn(found)).of_table
        widths.append(high - low)
    assert np.mean(widths) == pytest.approx(2 * 1.96 * np.std(slopes), rel=0.35)


def test_deviations_that_are_no_noise_give_no_band() -> None:
    time = np.geomspace(1.0, 1e4, 30)
    modulus = 1e9 * time**-0.05 * (1 + 0.01 * np.sin(np.log(time) * 1.5))
    wavy = asp.relaxation.Relaxation(time, modulus, noise=0.5)
    growth = grown(made_history(0.1, 0.0), drawn(asp.relaxation.fit(wavy, branches=2)))
    assert growth.of_table == (growth.per_decade, growth.per_decade)


def light(end: float = 0.0) -> tuple[xr.Dataset, PronySeries]:
    """A history whose area is its compliance, but at the last time; and that solid."""
    solid = PronySeries(1e9, ((0.2, 10.0), (0.2, 300.0)))
    history = made_history(0.1, 0.0)
    compliance = solid.compliance_at(np.asarray(history["time"]))
    history["contact_area_corrected"][:] = compliance / compliance[1]
    history["contact_area_corrected"][-1] *= 1 + end
    return history, solid


GROWING = PronySeries(1e9, ((0.3, 10.0), (0.3, 300.0)))
GROWS = np.divide(*GROWING.compliance_at(np.array([1e4, 1.0])))


def test_all_of_many_draws_are_in_the_band() -> None:
    history, solid = light()
    for still, growers in ((1, 2), (250, 50)):
        growth = grown(history, [solid, *[solid] * still, *[GROWING] * growers])
        assert growth.ratio_band[1] == pytest.approx(GROWS, rel=1e-3)
        assert growth.ratio_band[0] == pytest.approx(growth.ratio)
    assert grown(history, [solid] * 5).of_table == pytest.approx((growth.per_decade,) * 2)


def test_a_pixel_at_the_end_is_not_taken_for_the_slope_of_the_curve() -> None:
    history, solid = light(end=1e-3)  # after ten relaxation times the compliance hardly grows
    x = np.log(solid.compliance_at(np.array([10**3.75, 1e4])))
    assert 1e-3 / np.diff(x)[0] > 50
    ratio = grown(history, [solid, GROWING, GROWING]).ratio_band
    np.testing.assert_allclose(ratio, GROWS, rtol=0.01)


def brightness(shape):
    return np.random.default_rng(0).random(shape)


@pytest.fixture(scope="module")
def contact():
    heights = 1e-6 * asp.surfaces.gaussian((24, 32), seed=1)
    scan = asp.surfaces.Surface(
        heights, unit="m", pixel_size=(2e-6, 1e-6), length_unit="m", edges="reflecting"
    )
    return asp.press(scan, asp.solids.half_space(modulus=1e9), pressure=3e7)


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_a_sharp_eye_sees_the_sites_themselves(edges):
    touching = brightness((7, 12)) < 0.3
    seen = asp.observe(touching, threshold=0.5, edges=edges)
    np.testing.assert_allclose(seen.image, touching, atol=1e-14)
    np.testing.assert_array_equal(seen.seen, touching)
    assert seen.area == np.count_nonzero(touching)
    assert seen.fraction == touching.mean()
    ours, known = seen.patches, asp.analysis.patches(touching, edges=edges)
    np.testing.assert_array_equal(ours.sizes, known.sizes)


@pytest.mark.parametrize(
    ("pixel", "blur", "edges"), [(0.5, 0.3, "periodic"), (1.5, 2.0, "reflecting"), (6.0, 6.0, "reflecting")]
)
@pytest.mark.parametrize("shape", [(6, 12), (12,)])
def test_pixels_that_tile_the_surface_see_all_of_its_light(shape, pixel, blur, edges):
    light = brightness(shape)
    seen = asp.observe(light, pixel=pixel, blur=blur, edges=edges)
    assert seen.image.shape == tuple(round(n / pixel) for n in shape)
    assert seen.area == pytest.approx(light.sum(), rel=1e-12)
    assert seen.image.min() >= light.min() - 1e-12
    assert seen.image.max() <= light.max() + 1e-12


def test_a_pixel_is_the_mean_of_what_it_covers():
    light = brightness((10, 7))
    seen = asp.observe(light, pixel=2.5)
    assert seen.image.shape == (4, 2)  # two sites of the last axis are not seen
    part = np.array([1.0, 1.0, 0.5, 0, 0, 0, 0])
    columns = [part, np.array([0, 0, 0.5, 1.0, 1.0, 0, 0])]
    row = np.append(part, [0, 0, 0])
    np.testing.assert_allclose(seen.image[0], [row @ light @ column / 6.25 for column in columns])


def test_edges_are_seen_through_and_show_what_lies_beyond():
    light = brightness((9, 8))
    ours, moved = (asp.observe(one, blur=3.0).image for one in (light, np.roll(light, (4, 3), (0, 1))))
    np.testing.assert_allclose(np.roll(ours, (4, 3), (0, 1)), moved, rtol=1e-12)
    doubled = np.block([[light, light[:, ::-1]], [light[::-1], light[::-1, ::-1]]])
    alone = asp.observe(light, pixel=1.0, blur=5.0, edges="reflecting", threshold=0.5)
    images = asp.observe(doubled, pixel=1.0, blur=5.0, threshold=0.5)
    np.testing.assert_allclose(images.image[:9, :8], alone.image, rtol=1e-12)
    assert images.area == 4 * alone.area


@pytest.mark.parametrize("width", [12.0, 40.0])
def test_a_blurred_disc(width):
    # A point of the disc's image: the probability that a normal vector around it ends within the disc.
    n, radius, deviation = 160, 24.0, width / (2 * math.sqrt(2 * math.log(2)))
    place = np.arange(n) + 0.5 - n / 2
    distance = np.hypot(place[:, None], place)
    seen = asp.observe(distance < radius, blur=width, threshold=0.5)
    exact = scipy.stats.ncx2.cdf((radius / deviation) ** 2, 2, (distance / deviation) ** 2)
    # The edge of the disc runs along sites: the wider the blur, the less it matters.
    np.testing.assert_allclose(seen.image, exact, atol=0.15 / width)
    assert seen.area == pytest.approx(np.count_nonzero(exact > 0.5), rel=0.01)
    assert seen.patches.count == 1


def test_lengths_are_those_of_the_contact(contact):
    itself = asp.observe(contact, threshold=0.5)
    assert itself.spacing == (2e-6, 1e-6)
    assert itself.area == pytest.approx(contact.contact_area, rel=1e-12)
    assert itself.edges == "reflecting"
    written, counted = (
        asp.observe(contact, pixel=pixel, blur=blur, threshold=0.5)
        for pixel, blur in (("4 um", "3000 nm"), (4e-6, 3e-6))
    )
    assert written.image.shape == (12, 8)
    np.testing.assert_array_equal(written.image, counted.image)
    assert written.area == pytest.approx(np.sum(written.image >= 0.5) * 16e-12)


def test_a_dataset_is_seen_as_the_contact(contact):
    history = asp.age(contact, [1.0], fields_at=[0.0, 1.0])
    at_first = history.dataset.isel(field_time=0)
    ours, theirs = (asp.observe(image, blur="2um") for image in (at_first, contact))
    np.testing.assert_array_equal(ours.image, theirs.image)
    assert ours.spacing == theirs.spacing
    each_refuses(
        ("image", "fields of 2 times", asp.observe, history.dataset),
        ("image", "none", asp.observe, xr.Dataset()),
    )


def test_what_cannot_be_seen(contact):
    touching = brightness((6, 8)) < 0.5
    refused: list[tuple[Any, str, Any]] = [
        *((touching, "pixel", value) for value in (7.0, "1 um")),
        *((touching, name, value) for name, value in (("blur", -1.0), ("edges", "open"))),
        *((contact, name, value) for name, value in (("pixel", "1 MPa"), ("spacing", 1.0))),
    ]
    each_refuses(
        *((name, partial(asp.observe, image, **{name: value})) for image, name, value in refused),
        got="7.0 | '1 um' | -1.0 | 'open' | '1 MPa' | Contact",
    )
    with refuses("patches", "one without"):
        _ = asp.observe(touching).patches


@pytest.mark.parametrize(
    ("maps", "reference"),
    [([0, 1, 2, 9, 12, 15], 2), ([0, 1, 9, 12], 2), ([1, 2, 9], 0), ([2, 9, 12], 0), ([0], 0)],
)
def test_maps_after_a_ramp_from_no_load_compare_with_its_end(maps: list[float], reference: int) -> None:
    contact = press(gaussian((24, 24), seed=3), spring_lattice(k0=1.0, k1=3.0), load=0.0)
    legs = [Ramp(2.0, load=60.0), Hold(10.0), Step(load=15.0), Hold(3.0)]
    dataset = age(contact, [1.0, 9.0, 13.0], protocol=legs, fields_at=maps).dataset
    found = contact_maps(dataset)
    assert found.reference == reference
    touching = dataset["in_contact"].values.astype(bool)
    then = touching[reference]
    for number, (now, states) in enumerate(zip(touching, found.states, strict=True)):
        lost = then & ~now if number >= reference else np.zeros_like(then)
        for state, sites in (
            (SiteState.KEPT, now & then),
            (SiteState.NEW, now & ~then),
            (SiteState.LOST, lost),
        ):
            np.testing.assert_array_equal(states == state, sites)
    if 15 in maps:  # after the drop, sites of the end of the ramp are lost
        assert found.count(-1, SiteState.LOST) > 0
        assert "in contact then and at $t$ = $2$" in str(
            [text.get_text() for text in contact_figure(found).legends[0].get_texts()]
        )
