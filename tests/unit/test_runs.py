"""One run from its configuration: what is kept when a part of it fails, and the numbers it chooses itself."""

import numpy as np
import pytest

import asperity.app.runs.pipeline as module
from asperity.app.config import config_from
from asperity.app.runs import Progress, execute
from asperity.app.runs.defaults import map_times, modest_load
from asperity.errors import ConvergenceError
from asperity.prediction.predicting import hold_times
from tests.refusals import refuses

SMALL = config_from({"surface": {"shape": [12, 12]}, "aging": {"last": 0.1}}, {}, None)


def test_a_limit_that_is_not_found_is_a_remark_and_no_loss(monkeypatch):
    def fail(*_, **__):
        raise ConvergenceError("gave up")

    monkeypatch.setattr(module, "relax", fail)
    outcome = execute(SMALL, Progress())
    assert outcome.remarks[-1] == "no relaxed state: gave up"
    assert outcome.summary is not None
    assert outcome.summary.relaxed_ratio is None
    assert outcome.dataset.sizes["time"] == 10


def test_a_slide_that_cannot_be_is_refused_before_anything_is_pressed(monkeypatch, tmp_path):
    monkeypatch.setattr(module, "pressed", lambda *_, **__: pytest.fail("pressed"))
    path = tmp_path / "scan.txt"
    np.savetxt(path, np.random.default_rng(0).normal(size=(16, 16)))
    leg = {"kind": "slide", "distance": 3.0, "velocity": 1.0}
    scan = {"kind": "file", "path": str(path), "periodic": "reflect"}
    for surface, change in ((scan, {}), ({"shape": [64]}, {"direction": "y"}), ({}, {"substeps": 2})):
        solid = {"hardness": 10.0} if "substeps" in change else {}
        tables = {"surface": surface, "solid": solid, "protocol": [leg | change]}
        with refuses("direction" if "direction" in change else "slide"):
            execute(config_from(tables, {}, None), Progress())


def test_a_distance_without_a_unit_that_is_odd_in_si_gets_a_remark():
    surface = {"kind": "spectral", "shape": [16, 16], "spacing": [0.5], "unit": "um", "rms_height": 0.1}
    legs = [{"kind": "slide", "distance": far, "velocity": "1 um/s"} for far in (2.0, "2 um", 2e-6)]
    tables = {
        "surface": surface,
        "solid": {"kind": "half_space", "modulus": "4 GPa"},
        "contact": {"load": "1 uN"},
    }
    config = config_from(tables | {"protocol": [{"kind": "repeat", "count": 2, "legs": legs}]}, {}, None)
    (remark,) = module.completed(config, config.solid.build(), config.surface.build())[1]
    assert remark.startswith("distance 2 has no unit and was taken in m; here it would usually be from ")


def test_the_default_load_of_the_paper_is_800() -> None:
    assert modest_load(k0=1.0, k1=3.0, rms=1.0, sites=200 * 200) == 800.0
    assert modest_load(k0=1.0, k1=3.0, rms=1.23456, sites=100) == 2.47
    with refuses("load", "none"):
        modest_load(k0=1.0, k1=3.0, rms=0.0, sites=100)


def test_hold_times_are_even_in_the_decades_and_maps_are_at_round_ones_where_there_are_some() -> None:
    times = hold_times(first=1e-3, last=1e6, per_decade=4)  # the default of a run
    assert (times[0], times[-1]) == (1e-3, 1e6)
    np.testing.assert_allclose(times, 10 ** np.linspace(-3, 6, 37))
    assert hold_times(first=1.0, last=1.1, per_decade=1).tolist() == [1.0, 1.1]
    for recorded, maps in (
        ([0.0, *times], [1e-2, 1, 1e2, 1e4, 1e6]),
        (np.geomspace(1e-2, 1e4, 25), [1, 10, 100, 1e3, 1e4]),
        ([*hold_times(first=1e-3, last=1e4, per_decade=2), 4e4], [1e-3, 0.1, 10, 1e3, 4e4]),
        ([2.0, 4.0, 8.0, 16.0, 32.0, 64.0], [4.0, 8.0, 16.0, 32.0, 64.0]),
        ([3.0, 7.0], [3.0, 7.0]),
        ([0.0], []),
    ):
        np.testing.assert_allclose(map_times(list(recorded)), [0.0, *maps], rtol=1e-9)


NM = {"kind": "spectral", "shape": [64, 64], "pixel_size": 20.0, "unit": "nm", "seed": 1}
SOFT = {"kind": "half_space", "modulus": 3e9, "branches": [[0.3, 1.0]]}
BRIEF = {"aging": {"times": [1.0]}, "output": {"maps_at": [0.0, 1.0]}}
SPRINGS, CRUSHED, CLOSED, FEW, PIXELS = (
    "springs have no",
    "times E*",
    "of the surface touches",
    "too few",
    "fewer than 10",
)


@pytest.mark.parametrize(
    ("surface", "rest", "said"),
    [
        (NM, {"contact": {"load": 10.0}}, {SPRINGS}),
        (NM, {"solid": SOFT, "contact": {"load": 10.0}}, {CRUSHED, CLOSED, FEW}),
        (NM | {"rms_slope": 0.2}, {"solid": SOFT | {"hardness": 1e8}, "contact": {"pressure": 1e7}}, {FEW}),
        (
            NM | {"cutoff": 40.0, "rms_slope": 0.5},
            {"solid": SOFT, "contact": {"pressure": 1e7}},
            {FEW, PIXELS},
        ),
        ({**NM, "unit": None}, {"solid": SOFT, "contact": {"pressure": 1e10}}, set()),  # plain numbers
        ({"kind": "gaussian", "shape": [64, 64]}, {"contact": {"load": 100.0}}, set()),
    ],
)
def test_a_run_remarks_what_a_prediction_would(surface, rest, said):
    surface = {name: value for name, value in surface.items() if value is not None}
    remarks = execute(config_from({"surface": surface} | rest | BRIEF, {}, None), Progress()).remarks
    assert {
        one for one in (SPRINGS, CRUSHED, CLOSED, FEW, PIXELS) if any(one in text for text in remarks)
    } == said
