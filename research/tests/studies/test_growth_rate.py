"""The study of the growth rate, on contacts that follow a closed form, computed here in another way."""

import math
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from asperity import fits, surfaces, theory
from asperity_research.studies import growth, growth_rate
from asperity_research.studies.evidence import Evidence

SEEDS, SIDE = (0, 1), 256
TIMES = np.append(0.0, np.geomspace(0.1, 1e6, 29))
END = 7e-3
"""Time times the square of the contact fraction at which areas are 0.9 of those of the closed form."""


@cache
def force_for(kind, side, seed):
    """Force times compliance at which the highest sites, each pressed in by its own force, reach the next."""
    ordered = np.sort(getattr(surfaces, kind)((side, side), seed=seed), axis=None)[::-1]
    return np.cumsum(ordered) - np.arange(1, ordered.size + 1) * ordered


def isolated(campaign):
    """A campaign on contacts that are isolated until dips meet, of two surfaces."""
    sweep = campaign.tables["sweep"] | {"seeds": SEEDS}
    every = [area(campaign, dict(zip(sweep, at, strict=True))) for at in product(*sweep.values())]
    axes = ["seed" if name == "seeds" else name for name in sweep]
    areas = np.reshape(every, (*map(len, sweep.values()), TIMES.size))
    where = dict(zip(axes, map(list, sweep.values()), strict=True)) | {"time": TIMES}
    return xr.Dataset({"area": ((*axes, "time"), areas), "sites": SIDE**2}, where)


def area(campaign, at):
    surface, seed = campaign.tables["surface"], at["seeds"]
    if surface["kind"] == "spectral":
        rate = 0.1 * at.get("cutoff", surface["cutoff"]) ** 0.5 * (1 + 1e-3 * seed)
        return 100.0 * (1 + rate * np.log1p(TIMES))
    load = at.get("load", campaign.tables["contact"]["load"]) / surface["shape"][0] ** 2
    G = theory.compliance(at.get("k1", 3.0), TIMES, at.get("R_viscous", 0.0))
    force = load / surface.get("rms", 1.0) * SIDE**2 * G
    touching = np.searchsorted(force_for(surface["kind"], SIDE, seed), force, side="right").astype(float)
    fallen = 1 / (1 + TIMES * (touching / SIDE**2) ** 2 / (9 * END))
    return touching * fallen if campaign.name in ("load", "rms", "side_128", "side_256") else touching


@pytest.fixture(scope="module")
def outcome():
    known = {campaign.name: isolated(campaign) for campaign in growth_rate.GROWTH_RATE.full}
    return growth_rate.analyse(Evidence(Path(), known))


def test_contacts_of_the_closed_form_are_found_to_be_that(outcome):
    points = outcome.tables["points"]
    own = points[points["of"].isin(["k1/k0", "R_viscous/R", "law"])]
    np.testing.assert_allclose(own["over_closed"], 1.0, rtol=1e-9)
    slopes = points[points["of"] == "k1/k0"].set_index("at")["B"]
    limits = [float(theory.late_slope(x1)) for x1 in (1.0, 10.0)]
    # Gaussian heights grow more slowly than exponential ones.
    assert all(0.5 * limit < slopes[x1] < limit for x1, limit in zip((1.0, 10.0), limits, strict=True))
    lines = outcome.tables["lines"]
    late = lines[lines["line"] == "late, exponential"].set_index("at")["B"]
    assert late.iloc[-1] == pytest.approx(float(theory.late_slope(30.0)))


def test_the_verdicts_on_them(outcome):
    found = {finding.key: finding for finding in outcome.findings}
    for agrees, keys in (
        ("agrees", ("ratio", "viscous_0.0001")),
        ("differs", ("proportional", "waves", "load")),
    ):
        assert {found[key].verdict for key in keys} == {agrees}
    for key, expected in (("waves", 0.5), ("rms", 1.0), ("size", 1.0)):
        numbers = [float(one.estimate.value) for one in found[key].measured]
        np.testing.assert_allclose(numbers, expected, rtol=1e-9)
    assert float(found["end"].measured[0].estimate.value) == pytest.approx(-2, abs=0.1)
    assert len(growth_rate.draw(outcome.tables).axes) == 6


def test_an_end_by_hand():
    time = np.array([0.0, 1.0, 10.0, 100.0])
    closed = np.array([[1.0, 2.0, 3.0, 4.0]])
    at, area = growth.end(time, closed * [1.0, 1.0, 0.95, 0.85], closed)
    assert at == pytest.approx(10 * math.sqrt(10))
    assert area == pytest.approx((3 * 0.95 + 4 * 0.85) / 2)
    assert np.isnan(growth.end(time, closed, closed)).all()
    assert np.isnan(growth.end(time, closed * 0.5, closed)).all()


def test_rates_of_a_logarithm_and_of_one_that_bends():
    time = np.append(0.0, np.geomspace(1.0, 1e3, 13))
    area = np.array([[10.0], [30.0]]) * (1 + 0.2 * np.log1p(1e9 * time) / 2)
    assert growth.rate(time, area) == pytest.approx(0.1, rel=1e-6)
    assert growth.straightness(time, area) == pytest.approx(1.0, rel=1e-6)
    measured = fits.growth_rate(time, area.mean(axis=0), 9.0, 1100.0)
    assert growth.rate(time, area) == pytest.approx(measured.B)
    assert growth.relative_rate(time, area) == pytest.approx(measured.relative)
    bent = np.exp(0.1 * np.log1p(time))[None]
    assert growth.relative_rate(time, bent) == pytest.approx(0.1, rel=0.02)
    assert growth.straightness(time, bent) > 1.2
