"""How far a scan suffices: growth is settled long before area is, on a separable solid under a light load."""

import math
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli import main
from asperity.prediction.predicting import bands_of
from asperity.progress import Progress

SOLID = asp.solids.half_space(modulus=1e9, branches=[(0.4, 1.0)])


@pytest.fixture(scope="module")
def scan():
    made = asp.surfaces.spectral((256, 256), hurst=0.8, roll_off=32.0, cutoff=4.0, rms_slope=0.2, seed=0)
    return asp.surfaces.Surface(1e-6 * made, "m", (1e-6, 1e-6), "m", edges="reflecting")


@pytest.fixture(scope="module")
def prediction(scan):
    how: dict[str, Any] = {"first": 1e-3, "last": 100.0, "per_decade": 1, "resolution_study": True}
    return asp.predict(SOLID, scan, pressure=0.002 * 1e9 * 0.2, **how)


def test_bands_are_what_the_filtered_scan_gives(scan, prediction):
    assert [band.shortest for band in prediction.bands] == pytest.approx([2e-6, 4e-6, 8e-6, 1.6e-5, 3.2e-5])
    whole, band = prediction.bands[0], prediction.bands[2]
    area = prediction.series("contact_area_corrected")
    assert whole.area == pytest.approx(area[-1], rel=1e-9)
    assert whole.growth == pytest.approx(area[-1] / area[0], rel=1e-9)
    load = float(prediction.dataset["load"][0])
    elastic = asp.press(scan.band(shortest=8e-6), asp.solids.half_space(modulus=0.6e9), load=load)
    assert band.area == pytest.approx(elastic.contact_area_corrected, rel=1e-6)
    assert band.pressure == pytest.approx(load / band.area, rel=1e-6)


def test_bands_see_the_ramp_that_puts_the_load_on():
    """Beside the effective load L = F [integral of J from t - ramp to t] / ramp on an elastic half-space."""
    made = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=16.0, cutoff=2.0, rms_slope=0.2, seed=0)
    surface = asp.surfaces.Surface(1e-6 * made, "m", (1e-6, 1e-6), "m", edges="reflecting")
    share, relaxing, ramp, pressure = 0.6, 1.0, 4.0, 4e6
    how: dict[str, Any] = {"first": ramp, "last": 100.0, "per_decade": 3, "resolution_study": True}
    solid = asp.solids.half_space(modulus=1e9, branches=[(share, relaxing)])
    bands = asp.predict(solid, surface, pressure=pressure, ramp=ramp, **how).bands
    retarding = relaxing / (1 - share)  # J E* = 1 + share / (1 - share) [1 - exp(-t / retarding)]

    def effective(t):
        left = retarding / ramp * (math.exp(-(t - ramp) / retarding) - math.exp(-t / retarding))
        return pressure * (1 + share / (1 - share) * (1 - left))

    for band, part in zip(bands, (surface, surface.band(shortest=4e-6)), strict=False):
        rigid = asp.solids.half_space(modulus=1e9)
        first, last = (
            asp.press(part, rigid, pressure=effective(t)).contact_area_corrected for t in (ramp, 100.0)
        )
        assert band.area == pytest.approx(last, rel=2e-3)
        assert band.growth == pytest.approx(last / first, rel=2e-3)


def test_growth_is_settled_where_area_is_not(prediction):
    """On one surface, whose few contacts scatter: growth moves ten times less than area."""
    change = prediction.bands[0].change_to(prediction.bands[2])
    assert change["area"] > 0.2
    assert change["pressure"] < -0.15
    assert abs(change["growth"]) < 0.1 * change["area"]


@pytest.mark.slow
def test_on_average_growth_changes_by_less_than_a_percent():
    """From the full to a quarter of the bandwidth, over surfaces of 512 x 512 sites at 0.8 % contact."""
    changes = []
    for seed in range(4):
        made = asp.surfaces.spectral(
            (512, 512), hurst=0.8, roll_off=64.0, cutoff=4.0, rms_slope=0.2, seed=seed
        )
        surface = asp.surfaces.Surface(1e-6 * made, "m", (1e-6, 1e-6), "m", edges="reflecting")

        def followed(surface, times):
            return asp.age(asp.press(surface, SOLID, pressure=8e5), times)

        bands = bands_of(surface, followed, [1e-3, 100.0], Progress())
        changes.append(bands[0].change_to(bands[2]))
    assert min(change["area"] for change in changes) > 0.2
    assert abs(np.mean([change["growth"] for change in changes])) < 0.01


def test_the_command_writes_them_and_says_what_would_change(tmp_path, coarse_pictures):
    made = 1e-7 * asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=16.0, seed=1)
    np.save(tmp_path / "scan.npy", made)
    out = tmp_path / "out"
    words = "predict --file-unit m --pixel-size 1e-6 --length-unit m --young 3GPa --first 0.1s --last 100s"
    words += f" --pressure 1MPa --quiet --resolution-study --surface {tmp_path / 'scan.npy'} --out {out}"
    assert main([*words.split(), "--branch", "0.5 1s"]) == 0
    rows = (out / "resolution.csv").read_text("utf-8").splitlines()
    assert len(rows) == 4
    assert "How far the scan suffices" in (out / "prediction.html").read_text("utf-8")
    assert "without waves below 4 um: area by" in (out / "summary.txt").read_text("utf-8")
