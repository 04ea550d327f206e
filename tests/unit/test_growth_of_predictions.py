"""The growth that a prediction states, and how sure it is: histories made by hand, with known spreads."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.analysis.prediction import growth_of
from asperity.relaxation import PronySeries


def made_history(slope: float, spread: float) -> xr.Dataset:
    """A history of area 1 + slope log10 t, in sixteen tiles that grow alike, but for a spread."""
    time = np.geomspace(1.0, 1e4, 17)
    moments = time[::4]
    own = slope * (1 + spread * (-1.0) ** np.arange(4))
    filled = np.round(40 * (1 + own * np.log10(moments)[:, None]))
    sites = np.arange(100).reshape(10, 10) < filled[:, :, None, None]  # of each map in each column of tiles
    rows = np.tile(sites.swapaxes(1, 2).reshape(5, 10, 40), (1, 4, 1))
    area = np.append(np.nan, 1 + slope * np.log10(time))
    maps = ("field_time", "y", "x")
    return xr.Dataset(
        {
            "contact_area_corrected": ("time", area),
            "in_contact": (maps, rows),
            "pressure": (maps, np.ones(rows.shape)),
        },
        {"time": np.append(0.0, time), "field_time": moments},
    )


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
    growth = growth_of(made_history(0.1, 0.0), exact)
    assert growth.per_decade == pytest.approx(0.1)
    assert growth.straight is True
    assert [slope for *_, slope in growth.decades] == pytest.approx([0.1] * 4)
    assert [begin for begin, *_ in growth.decades] == pytest.approx([1, 10, 100, 1000])
    np.testing.assert_allclose(growth.of_scan, 0.1, rtol=1e-9)
    np.testing.assert_allclose(growth.of_table, 0.1, rtol=0.02)


def test_tiles_that_grow_differently_widen_the_band(exact: list[PronySeries]) -> None:
    # Half of the tiles grow by 5 %, half by 15 % a decade; of 16 drawn, the mean spreads by 5 % / 4.
    growth = growth_of(made_history(0.1, 0.5), exact)
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
        low, high = growth_of(history, drawn(found)).of_table
        widths.append(high - low)
    assert np.mean(widths) == pytest.approx(2 * 1.96 * np.std(slopes), rel=0.35)


def test_deviations_that_are_no_noise_give_no_band() -> None:
    time = np.geomspace(1.0, 1e4, 30)
    modulus = 1e9 * time**-0.05 * (1 + 0.01 * np.sin(np.log(time) * 1.5))
    wavy = asp.relaxation.Relaxation(time, modulus, noise=0.5)
    growth = growth_of(made_history(0.1, 0.0), drawn(asp.relaxation.fit(wavy, branches=2)))
    assert growth.of_table == (growth.per_decade, growth.per_decade)


def light(end: float = 0.0) -> tuple[xr.Dataset, PronySeries]:
    """A history whose area is its compliance, but at the last time; and that solid."""
    solid = PronySeries(1e9, ((0.2, 10.0), (0.2, 300.0)))
    history = made_history(0.1, 0.0)
    compliance = solid.compliance_at(np.asarray(history["time"])[1:])
    history["contact_area_corrected"][1:] = compliance / compliance[0]
    history["contact_area_corrected"][-1] *= 1 + end
    return history, solid


def test_all_of_many_draws_are_in_the_band() -> None:
    history, solid = light()
    growing = PronySeries(1e9, ((0.3, 10.0), (0.3, 300.0)))
    compliance = growing.compliance_at(np.array([1.0, 1e4]))
    for still, growers in ((1, 2), (250, 50)):
        growth = growth_of(history, [solid, *[solid] * still, *[growing] * growers])
        assert growth.ratio_band[1] == pytest.approx(compliance[1] / compliance[0], rel=1e-3)
        assert growth.ratio_band[0] == pytest.approx(growth.ratio)
    assert growth_of(history, [solid] * 5).of_table == pytest.approx((growth.per_decade,) * 2)


def test_a_pixel_at_the_end_is_not_taken_for_the_slope_of_the_curve() -> None:
    history, solid = light(end=1e-3)  # after ten relaxation times the compliance hardly grows
    x = np.log(solid.compliance_at(np.array([10**3.75, 1e4])))
    assert 1e-3 / np.diff(x)[0] > 50
    growing = PronySeries(1e9, ((0.3, 10.0), (0.3, 300.0)))
    compliance = growing.compliance_at(np.array([1.0, 1e4]))
    ratio = growth_of(history, [solid, growing, growing]).ratio_band
    np.testing.assert_allclose(ratio, compliance[1] / compliance[0], rtol=0.01)
