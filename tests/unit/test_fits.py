"""Fits of A(t): exact data, noise with known spread, units, and data that do not determine the law."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from asperity.fits import SaturationFit, compare, logarithm, saturation
from tests.refusals import refuses

Floats = NDArray[np.float64]

TIME = np.concatenate([[0.0], np.logspace(-2, 6, 60)])


def saturating(time: Floats, a: float, q: float, t0: float) -> Floats:
    return a - (a - 1) / (1 + time / t0) ** q


LAWS = [(1.5, 1.0, 100.0), (40.0, 0.02, 0.1), (2.0, 5.0, 1e4)]


@pytest.mark.parametrize(("a", "q", "t0"), LAWS)
@pytest.mark.parametrize("first", [0, 1])
def test_saturation_recovers_exact_parameters(a: float, q: float, t0: float, first: int) -> None:
    fit = saturation(TIME[first:], 7 * saturating(TIME[first:], a, q, t0))
    assert (fit.a, fit.q, fit.t0) == pytest.approx((a, q, t0), rel=1e-8)
    assert pytest.approx((a - 1) * q, rel=1e-8) == fit.C
    assert fit.initial_area == pytest.approx(7, rel=1e-10)
    assert fit.rms_residual < 1e-12
    assert fit.r_squared == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(("C", "t0"), [(0.01, 50.0), (4.0, 0.02)])
@pytest.mark.parametrize("first", [0, 1])
def test_logarithm_recovers_exact_parameters(C: float, t0: float, first: int) -> None:
    fit = logarithm(TIME[first:], 0.02 * (1 + C * np.log1p(TIME[first:] / t0)))
    assert (fit.C, fit.t0, fit.initial_area) == pytest.approx((C, t0, 0.02), rel=1e-8)
    assert fit.rms_residual < 1e-12


KNOWN: dict[str, float] = {"a": 3.0, "q": 0.4, "t0": 10.0, "C": 0.8, "initial_area": 1.0}
CASES: dict[str, tuple[Callable[..., Any], str]] = {
    "saturation": (saturation, "a q t0 C"),
    "saturation and A(0)": (saturation, "a q t0 C initial_area"),
    "saturation below a limit": (partial(saturation, limit=3.0), "q t0"),
    "logarithm": (logarithm, "C t0"),
}


@pytest.mark.parametrize("count", [40, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("case", CASES)
def test_standard_errors_are_the_spread_of_fits_to_noise(case: str, count: int) -> None:
    law, said = CASES[case]
    names, rng = said.split(), np.random.default_rng(21)
    time = TIME[1:] if "initial_area" in names else TIME
    model = 1 + 0.8 * np.log1p(time / 10) if case == "logarithm" else saturating(time, 3.0, 0.4, 10.0)
    rows = []
    for _ in range(count):
        fit = law(time, model + 2e-3 * rng.normal(size=time.size) * (time > 0))
        rows.append([(getattr(fit, n) - KNOWN[n]) / getattr(fit, f"{n}_stderr") for n in names])
    pull = np.array(rows)
    # The spread has a standard error of 1/sqrt(2 count), the mean one of 1/sqrt(count): three of these.
    assert pull.std(axis=0) == pytest.approx(np.ones(len(names)), abs=3 / math.sqrt(2 * count))
    assert pull.mean(axis=0) == pytest.approx(np.zeros(len(names)), abs=3.1 / math.sqrt(count))
    # 99.7 % are expected within 3.
    assert (np.abs(pull) < 3).mean() > 0.985


def noisy(seed: int = 1) -> Floats:
    area = saturating(TIME, 3.0, 0.3, 10.0) * (1 + 1e-3 * np.random.default_rng(seed).normal(size=TIME.size))
    area[0] = 1.0
    return area


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("law", [saturation, logarithm])
def test_units_of_time_and_area_only_scale(law: Callable[..., Any], first: int) -> None:
    time, area = TIME[first:], noisy()[first:]
    one, other = law(time, area), law(3600 * time, 1e-6 * area)
    assert other.t0 == pytest.approx(3600 * one.t0, rel=1e-6)
    assert other.t0_stderr == pytest.approx(3600 * one.t0_stderr, rel=1e-5)
    assert pytest.approx(one.C, rel=1e-6) == other.C
    assert other.C_stderr == pytest.approx(one.C_stderr, rel=1e-5)
    assert other.initial_area == pytest.approx(1e-6 * one.initial_area, rel=1e-7)
    assert other.initial_area_stderr == pytest.approx(1e-6 * one.initial_area_stderr, rel=1e-5)
    assert other.rms_residual == pytest.approx(one.rms_residual, rel=1e-8)
    assert other.r_squared == pytest.approx(one.r_squared, rel=1e-10)


@pytest.mark.parametrize("law", [saturation, logarithm])
def test_prediction_residual_and_r_squared_say_the_same(law: Callable[..., Any]) -> None:
    area = noisy()
    fit = law(TIME, area)
    assert (fit.initial_area, fit.initial_area_stderr, fit.predict(0.0)) == (1.0, 0.0, 1.0)
    after = fit.predict(TIME[1:])
    assert fit.rms_residual == pytest.approx(np.sqrt(np.mean((after / area[1:] - 1) ** 2)), rel=1e-12)
    squares = np.sum((after - area[1:]) ** 2) / np.sum((area[1:] - area[1:].mean()) ** 2)
    assert fit.r_squared == pytest.approx(1 - squares, rel=1e-12)
    assert np.array_equal(fit(TIME), fit.predict(TIME))
    assert np.array_equal(fit.area_ratio(TIME) * fit.initial_area, fit.predict(TIME))
    if isinstance(fit, SaturationFit):
        assert fit.area_ratio(TIME) == pytest.approx(saturating(TIME, fit.a, fit.q, fit.t0), rel=1e-12)
        assert fit.area_ratio(1e300) == pytest.approx(fit.a, rel=1e-12)
    with refuses("time"):
        fit.predict([1.0, -1.0])


@pytest.mark.parametrize("first", [0, 1])
def test_pure_logarithm_leaves_a_open_but_not_C(first: int) -> None:
    area = 1 + 0.3 * np.log1p(TIME[first:] / 2)
    fit = saturation(TIME[first:], area)
    assert pytest.approx(0.3, rel=1e-6) == fit.C
    assert fit.t0 == pytest.approx(2.0, rel=1e-5)
    assert math.isfinite(fit.a)
    assert fit.a_stderr == math.inf
    assert fit.q < 1e-6
    assert fit.predict(TIME[first:]) == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize("law", [saturation, logarithm])
def test_a_late_piece_of_a_logarithm_does_not_determine_its_beginning(law: Callable[..., Any]) -> None:
    time = TIME[40:]
    rng = np.random.default_rng(0)
    area = 7 * (1 + 0.3 * np.log1p(time / 2)) * (1 + 1e-3 * rng.normal(size=time.size))
    fit = law(time, area)
    assert all(math.isfinite(value) for value in (fit.C, fit.t0, fit.initial_area, fit.initial_area_stderr))
    assert fit.t0_stderr > fit.t0
    assert fit.initial_area_stderr > 0.1 * fit.initial_area
    # What the piece does determine, the curve itself, is there.
    assert fit.predict(time) == pytest.approx(area, rel=5e-3)


@pytest.mark.parametrize("seed", [8, 9])
def test_a_search_along_a_valley_ends(seed: int) -> None:
    """Times long after t0: along a line the squares hardly change, and a search for the last digit creeps."""
    time, noise = np.geomspace(10, 3e3, 36), np.random.default_rng(seed).normal(size=36)
    fit = saturation(time, 1 + 0.004 * np.log1p(time / 4e-3) + 6e-4 * noise)
    assert fit.rms_residual == pytest.approx(6e-4, rel=0.3)
    assert fit.t0_stderr > fit.t0


@pytest.mark.parametrize("law", [logarithm, saturation, compare])
def test_an_array_that_knows_its_time_is_fitted_alone(law: Callable[..., Any]) -> None:
    time = np.array([0.0, *np.geomspace(0.1, 100, 12)])
    area = xr.DataArray(50 * (3 - 2 * (1 + time / 2.0) ** -0.3), coords={"time": time}, dims="time")
    assert repr(law(area)) == repr(law(time, area.values))
    for wrong in (area.time, area.drop_vars("time"), area.values):
        with refuses("area"):
            law(wrong)


GROWING = np.linspace(1.0, 2.0, 8)


@pytest.mark.parametrize(
    ("time", "area", "name"),
    [
        (np.arange(8), np.ones(8), "area"),
        (np.arange(8), GROWING[::-1], "area"),
        (np.arange(8), GROWING[:7], "area"),
        (np.arange(8), GROWING - 1, "area"),
        (np.arange(8), np.where(GROWING > 1.5, np.nan, GROWING), "area"),
        (np.append(np.arange(7), np.inf), GROWING, "time"),
        (np.arange(8)[::-1], GROWING, "area"),
        (np.arange(8) - 1, GROWING, "time"),
        (np.zeros(8), GROWING, "time"),
        (np.repeat([1, 2], 4), GROWING, "time"),
        ([], [], "time"),
        (np.arange(8).reshape(2, 4), GROWING, "time"),
        ("late", GROWING, "time"),
        (np.arange(3), GROWING[:3], "time"),
        (np.arange(1, 4), GROWING[:3], "time"),
        (np.arange(8), [1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1.1], "area"),
    ],
)
def test_bad_data_are_named(time: ArrayLike, area: ArrayLike, name: str) -> None:
    with refuses(name):
        saturation(time, area)


def test_areas_that_grow_at_once_and_stay_have_no_variation_to_explain() -> None:
    fit = saturation([0.0, 1.0, 2.0, 4.0, 8.0, 16.0], [3.0, 4.0, 4.0, 4.0, 4.0, 4.0])
    assert np.isnan(fit.r_squared)
    np.testing.assert_allclose(fit.area_ratio(np.array([2.0, 16.0])), 4 / 3, rtol=0.1)


@pytest.mark.parametrize(("a", "q", "t0"), LAWS)
def test_a_known_limit_is_kept(a: float, q: float, t0: float) -> None:
    fit = saturation(TIME, 7 * saturating(TIME, a, q, t0), limit=7 * a)
    assert (fit.a, fit.q, fit.t0) == pytest.approx((a, q, t0), rel=1e-8)
    assert (fit.a_stderr, fit.degrees_of_freedom) == (0, TIME.size - 3)
    # Another limit: the search of scipy, in t0 and q alone, finds the same.
    other = saturation(TIME, saturating(TIME, a, q, t0), limit=1.1 * a)

    def misfit(logs: Floats) -> Floats:
        return saturating(TIME, 1.1 * a, *np.exp(logs)) - saturating(TIME, a, q, t0)

    found = least_squares(misfit, np.log([q, t0]), xtol=1e-14, ftol=1e-14)
    assert (other.q, other.t0) == pytest.approx(np.exp(found.x), rel=1e-5)
    assert other.a == pytest.approx(1.1 * a, rel=1e-14)


@pytest.mark.parametrize(("first", "limit"), [(0, 0.9), (0, math.nan), (1, 3.0)])
def test_a_limit_that_is_none_is_refused(first: int, limit: float) -> None:
    with refuses("limit"):
        saturation(TIME[first:], noisy()[first:], limit=limit)


def test_fits_are_short_in_words() -> None:
    text = repr(saturation(TIME, noisy()))
    assert text.startswith("<SaturationFit: C = 0.6")
    assert "60 points, misfit 0.0" in text
    assert len(text) < 250
