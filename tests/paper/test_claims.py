"""The ledger: every claim is judged, from the data, by code."""

import math

import numpy as np
import pytest
import xarray as xr

from asperity.paper.claims import area_and_load, discussion, few_contacts, growth, ledger, self_affine
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Verdict

pytestmark = pytest.mark.xdist_group("reproduction")  # one process computes it

EXACT = {"a0", "a1", "relaxed-k1", "relaxed-full", "compliance-engine", "mean-u0"}


@pytest.fixture(scope="module")
def findings(evidence):
    return {finding.key: finding for finding in ledger(evidence)}


def test_every_claim_is_judged_by_numbers(findings):
    assert len(findings) > 30
    for finding in findings.values():
        assert finding.place
        assert finding.claim
        assert finding.measured
        for measurement in (*finding.measured, *finding.corrected):
            assert math.isfinite(float(measurement.estimate.value)), (finding.key, measurement.what)
            assert measurement.low <= measurement.high


def test_claims_without_chance_hold_on_any_lattice(findings):
    for key in EXACT:
        assert findings[key].verdict is Verdict.AGREES, key


class Altered(Evidence):
    """Evidence with one variable of one study changed."""

    def __init__(self, evidence, study, name, change):
        super().__init__(evidence.folder)
        data = evidence[study]
        self._opened[study] = data.assign({name: change(data[name])})


@pytest.mark.parametrize(
    ("claim", "study", "name", "change"),
    [
        # Areas that shrink, that know k1, that stay below full contact: each claim must notice.
        (area_and_load.relaxed_is_larger, "load", "relaxed_area", lambda area: area * 0),
        (area_and_load.relaxed_forgets_k1, "load", "relaxed_area", lambda area: area + area["k1"]),
        (area_and_load.relaxed_full_contact, "load", "relaxed_area", lambda area: area - 1),
        (area_and_load.no_lateral_spring, "no_lateral", "area", lambda area: area * 0.9),
        (growth.load_drifts, "separation", "load", xr.ones_like),
        (discussion.viscous_creep_kills_the_load, "separation", "load", xr.ones_like),
        (discussion.line_contact, "line_point", "approach", lambda depth: depth**2),
        (few_contacts.compliance_in_the_engine, "point", "approach", lambda depth: depth * 1.01),
    ],
)
def test_a_claim_that_is_wrong_differs(evidence, claim, study, name, change):
    assert claim(Altered(evidence, study, name, change)).verdict is Verdict.DIFFERS


def test_exponents_are_those_of_the_areas(evidence):
    # A(infinity) = F^0.8 exactly, for all seeds: the one exponent is 0.8 and does not drift.
    def power(area):
        return 400.0 * (area["load"] / 40**2) ** 0.8 * xr.ones_like(area)

    altered = Altered(evidence, "load", "relaxed_area", power)
    (measured,) = area_and_load.relaxed_exponent(altered).measured
    assert float(measured.estimate.value) == pytest.approx(0.8, abs=1e-12)
    (measured,) = area_and_load.relaxed_power_law(altered).measured
    assert float(measured.estimate.value) == pytest.approx(0.0, abs=1e-12)


def test_slopes_are_those_of_the_areas(evidence):
    # A/A(0) = 1 + k1 ln(1 + t)/10 whatever the load: proportional to k1, independent of the load.
    def logarithm(area):
        grown = 10 * (1 + area["k1"] / 10 * np.log1p(area["time"])) * xr.ones_like(area)
        return grown.transpose(*area.dims)

    altered = Altered(evidence, "self_affine_aging", "area", logarithm)
    assert self_affine.slope_and_load(altered).verdict is Verdict.AGREES
    finding = self_affine.slope_and_stiffness(altered)
    assert finding.verdict is Verdict.AGREES
    assert float(finding.measured[0].estimate.value) == pytest.approx(10 / 3, rel=1e-12)
