"""Numbers that the theory refuses, by name: each check once."""

from typing import Any

import numpy as np
import pytest

import asperity as asp
from tests.refusals import refuses

T: Any = asp.theory
GAUSS = T.GaussianHeights()
HISTORY = {"x2": [0.0, 1.0], "load_per_site": [1.0, 0.5], "k0": 1.0, "x1": 3.0, "heights": GAUSS}


def dispersed(law, x2=1.0):
    return T.compliance(1.0, x2, dispersion=law)


@pytest.mark.parametrize(
    ("name", "got", "call"),
    [
        ("dispersion", "'cubic'", lambda: dispersed("cubic")),
        ("dispersion", "0", lambda: dispersed(lambda qx, qy: 4 - 2 * np.cos(qx) - 2 * np.cos(qy), x2=1e14)),
        ("dispersion", "another", lambda: dispersed(lambda qx, qy: qx**2 + qy**2 + qx * qy)),
        ("dispersion", "1 near it", lambda: dispersed(lambda qx, qy: 1 + qx**2 + qy**2)),
        ("dispersion", "shape ()", lambda: dispersed(lambda *_: 1.0)),
        ("x1", "0.0", lambda: T.compliance(0.0, 1.0)),
        ("x2", "-1.0", lambda: T.compliance(1.0, -1.0)),
        ("x2", "inf", lambda: T.compliance(1.0, np.inf)),
        ("x1, x2, viscous", "(3,), (2,), ()", lambda: T.compliance([1, 2, 3], [1, 2])),
        ("viscous", "-1.0", lambda: T.compliance(1.0, 1.0, viscous=-1)),
        ("dimension", "3", lambda: T.compliance(1.0, 1.0, dimension=3)),
        ("x2", "0.0", lambda: T.compliance_asymptote(0.0)),
        ("x1", "-2.0", lambda: T.site_stiffness([1.0, -2.0])),
        ("shape", "(4, 4, 4)", lambda: T.torus_compliance(1.0, 1.0, (4, 4, 4))),
        ("rms", "0.0", lambda: T.GaussianHeights(rms=0.0)),
        ("rms", "[1.0, 2.0]", lambda: T.ExponentialHeights(rms=[1.0, 2.0])),
        ("heights", "shape (0,)", lambda: T.EmpiricalHeights([])),
        ("mean_excess", "0.0", lambda: GAUSS.separation_for(0.0)),
        ("load_per_site", "0.0", lambda: T.dilute_area(0.0, 1.0, GAUSS)),
        ("compliance", "-1.0", lambda: T.dilute_area(1.0, [1.0, -1.0], GAUSS)),
        ("load_per_site, compliance", "(2,), (3,)", lambda: T.dilute_area([1, 2], [1, 2, 3], GAUSS)),
        ("k1", "0.0", lambda: T.winkler_area(1.0, 0.0, GAUSS)),
        ("load", "0.0", lambda: T.contacts_at_start(0.0, 1.0, 1.0, k0=1.0)),
        (
            "load, rms, x1, k0",
            "(), (), (2,), (3,)",
            lambda: T.contacts_at_start_paper(1.0, 1.0, [1, 2], k0=[1, 2, 3]),
        ),
        ("dimension", "1", lambda: T.late_slope(1.0, dimension=1)),
        ("x1", "0.0", lambda: T.late_slope_paper(0.0)),
        ("load", "0.0", lambda: T.static_friction(1.0, 0.0, 1.0)),
        ("area", "-1.0", lambda: T.static_friction(-1.0, 1.0, 1.0)),
        ("area_fraction", "1.5", lambda: T.dilute_horizon(1.5)),
        ("heights", "3", lambda: T.full_contact_load(np.zeros((2, 2, 2)), k0=1.0, k1=1.0)),
        ("k0", "-1.0", lambda: T.full_contact_load([0.0, 1.0], k0=-1.0, k1=1.0)),
        ("k0", "-1.0", lambda: T.full_contact_load_relaxed([0.0, 1.0], k0=-1.0)),
        ("offset", "int64 of shape (3,)", lambda: T.displacement((1, 0, 0), 1.0, 1.0)),
        ("offset", "int64 of shape ()", lambda: T.displacement(3, 1.0, 1.0)),
        ("offset", "float64 of shape (2,)", lambda: T.displacement((0.5, 0.0), 1.0, 1.0)),
        ("offset", "3000", lambda: T.displacement((0, 3000), 1.0, 1.0)),
        (
            "x1, x2, viscous, offset",
            "(3,), (3,), (3,), (2,)",
            lambda: T.displacement([(1, 0), (1, 1)], 1.0, [1, 2, 3]),
        ),
        ("dimension", "3", lambda: T.displacement((1, 0), 1.0, 1.0, dimension=3)),
        ("x2", "shape (0,)", lambda: T.response([], [], 1.0)),
        ("force", "shape (3,)", lambda: T.response([0, 1], [0, 1, 2], 1.0)),
        ("x2", "2.0 before 1.0", lambda: T.response([0, 2, 1], [0, 1, 2], 1.0)),
        ("x1", "0.0", lambda: T.response([0, 1], [0, 1], 0.0)),
        ("viscous", "-1.0", lambda: T.response_rate([0, 1], [0, 1], 1.0, -1.0)),
        ("dimension", "3", lambda: T.response_rate([0, 1], [0, 1], 1.0, dimension=3)),
        ("load_per_site", "-1.0", lambda: T.dilute_history(**HISTORY | {"load_per_site": [1.0, -1.0]})),
        ("x2", "1.0 before 0.0", lambda: T.dilute_history(**HISTORY | {"x2": [1.0, 0.0]})),
        ("k0", "0.0", lambda: T.dilute_history(**HISTORY | {"k0": 0.0})),
        ("x1", "-1.0", lambda: T.dilute_history(**HISTORY | {"x1": -1.0})),
        ("dimension", "0", lambda: T.dilute_history(**HISTORY | {"dimension": 0})),
    ],
)
def test_bad_input_is_named(name, got, call):
    with refuses(name, got):
        call()
