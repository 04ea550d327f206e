"""Analysis: what a history says, checked by closed forms and by counting again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from asperity import age, press, relax
from asperity.analysis import SiteState, aging_summary, contact_maps, with_limit
from asperity.analysis.aging import FAR_APART
from asperity.solids import spring_lattice
from asperity.surfaces import Surface, gaussian, self_affine
from asperity.theory import ExponentialHeights, GaussianHeights, exponential_growth, site_stiffness
from tests.refusals import refuses
from tests.unit.test_figures import some_maps

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
    conditions = {"k0": 1.0, "k1": 3.0, "R": 1.0, "R_viscous": 0.0, "held": "load", "held_load": 1e-3 * sites}
    return xr.Dataset(
        {
            "area": ("time", area),
            "load": ("time", np.full(area.size, 1e-3 * sites)),
            "heights": (("y", "x"), np.zeros((sites // 1000, 1000))),
        },
        coords={"time": np.concatenate([[0.0], times])},
        attrs=conditions | attrs,
    )


def saturating(times: np.ndarray, a: float, q: float, t0: float) -> np.ndarray:
    return a - (a - 1) / (1 + times / t0) ** q


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
    with refuses("dataset"):
        contact_maps(aged.drop_vars(["in_contact", "u"]))
    with refuses("limit"):
        with_limit(aged, press(gaussian((8, 8)), spring_lattice(k0=1.0, k1=3.0), load=1.0))
    with refuses("dataset"):
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
    logarithm = aging_summary(synthetic(1 + 0.3 * np.arange(25.0) / 4))
    assert logarithm.steepest_per_decade == pytest.approx(0.3, rel=1e-12)


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
    assert np.max(summary.fit_curve) <= 4
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
    assert summary.load_per_decade == pytest.approx(-120)
    held = aging_summary(synthetic(saturating(TIMES, 3.0, 0.4, 2.0)))
    assert held.load is None
    assert np.isnan(held.load_per_decade)


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
    assert np.isnan(few.steepest_per_decade)


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
