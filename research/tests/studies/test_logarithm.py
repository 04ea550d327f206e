"""The study of logarithms, on contacts whose answer is known in closed form."""

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from asperity_research.studies import logarithm
from asperity_research.studies.evidence import Evidence

EXPONENT = 0.9
TIMES = np.concatenate([[0.0], np.geomspace(1.0, 1e7, 29)])


def power_law(name, loads=None, time=TIMES):
    """Contacts whose elastic area is a power of the load, a little different a surface."""
    seeds = np.arange(4)
    power = (EXPONENT + 0.001 * (seeds - 1.5))[:, np.newaxis, np.newaxis]
    series = logarithm.RELAXATIONS[name].series
    factors = np.ones(1) if loads is None else loads
    areas = 1000.0 * (factors[:, np.newaxis] * series.compliance_at(time)) ** power
    data = xr.Dataset(
        {"area": (("seed", "load", "time"), areas)}, {"seed": seeds, "load": factors, "time": time}
    )
    return data.isel(load=0) if loads is None else data


@pytest.fixture(scope="module")
def outcome():
    known = {name.replace(".", "_"): power_law(name) for name in logarithm.RELAXATIONS}
    known["elastic"] = power_law("one_time", np.array(logarithm._FACTORS), np.zeros(1))
    known["loads"] = power_law(logarithm._OF_LOADS, np.array(logarithm._PRESSURES))
    return logarithm.analyse(Evidence(Path(), known))


def test_a_contact_that_is_a_power_of_load_has_its_closed_form(outcome):
    numbers = outcome.tables["numbers"].set_index(["number", "relaxation"])
    # d ln A/d ln t = exponent d ln J/d ln t; J = 1 + j log10(t/t0) is 1 at first and 1 + 8 j at last.
    for share in (0.01, 0.02, 0.03, 0.1):
        slope = numbers.loc[("B", f"compliance_{share:g}"), "value"]
        end, start = ((1 + share * (n + 0.25)) ** EXPONENT for n in (7, 1))
        assert abs(slope / ((end - start) / math.log(1e6)) - 1) < 0.02
        assert abs(numbers.loc[("B over prediction", f"compliance_{share:g}"), "value"] - 1) < 1e-3
    assert abs(numbers.loc[("d ln A/d ln F", "elastic"), "value"] - EXPONENT) < 1e-6
    found = numbers.loc[("share for B = 0.01", "compliance"), "value"]
    assert abs(found / (0.01 * math.log(10) / EXPONENT) - 1) < 0.03
    assert abs(numbers.loc[("straightness", "one_time"), "value"]) < 1e-6


def test_the_verdicts_on_it(outcome):
    agrees = {finding.key: finding.verdict == "agrees" for finding in outcome.findings}
    bent = dict.fromkeys(("one_time", "power", "modulus"), False)
    assert agrees == bent | dict.fromkeys(("compliance", "share", "prediction", "load"), True)
    assert len(logarithm.draw(outcome.tables).axes) == 2


def test_slopes_and_shares_of_an_exact_logarithm():
    time = np.geomspace(1.0, 1e7, 29)
    growth = 1 + 0.02 * np.log(time) * np.array([[0.9], [1.1]])
    assert abs(logarithm.rate(time, growth) - 0.02) < 1e-12
    assert abs(logarithm.straightness(time, growth) - 1) < 1e-9
    assert abs(logarithm.share_for(np.array([0.01, 0.1]), np.array([0.005, 0.05])) - 0.02) < 1e-12


def test_equal_parts_of_compliance_are_a_logarithm():
    compliance = logarithm.equal_compliance(0.03).compliance_at(np.array([1e1, 1e3, 1e5, 1e7]))
    np.testing.assert_allclose(np.diff(compliance), 0.06, rtol=0.01)
    modulus = logarithm.equal_modulus(0.03).modulus_at(np.array([1e1, 1e3, 1e5, 1e7]))
    np.testing.assert_allclose(np.diff(modulus), -0.06, rtol=0.01)
