"""Campaigns of histories: sweeps over what a protocol holds."""

import json

import numpy as np
import pytest

import asperity.app.campaign as campaign
from asperity import age, press
from asperity.errors import ConfigError
from asperity.protocols import Hold, Step
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian
from tests.campaign.conftest import do_here, written

TEXT = """
[surface]
shape = [16, 16]
[contact]
load = 12.0
[aging]
first = 0.1
per_decade = 1
[[protocol]]
kind = "hold"
duration = 1.0
[[protocol]]
kind = "step"
load = 4.0
[[protocol]]
kind = "hold"
duration = 2.0
[sweep]
protocol.1.load = [3.0, 6.0]
k1 = [1.0, 3.0]
seeds = 2
"""


def test_a_campaign_of_histories_holds_what_single_runs_give(tmp_path):
    plan = campaign.read_plan(written(tmp_path, TEXT))
    assert len(plan.runs) == 8
    do_here(plan, tmp_path / "out")
    data = campaign.open(tmp_path / "out")
    assert data["area"].dims == ("protocol.1.load", "k1", "seed", "time")
    times = np.unique(data["time"])[1:]
    for load, seed in ((3.0, 1), (6.0, 0)):
        contact = press(gaussian((16, 16), seed=seed), spring_lattice(k0=1.0, k1=3.0), load=12.0)
        alone = age(contact, times, protocol=[Hold(1.0), Step(load=load), Hold(2.0)]).dataset
        there = data.sel({"protocol.1.load": load, "k1": 3.0, "seed": seed})
        for name in ("time", "leg", "area", "load", "energy"):
            np.testing.assert_array_equal(there[name], alone[name])
    assert json.loads(data.attrs["protocol"])[0] == {"kind": "hold", "duration": 1.0, "mobility": 1.0}
    for variable in data.variables.values():
        assert {"long_name", "units"} <= set(variable.attrs)
    # The file of the campaign, written from its results, plans the same runs.
    assert (
        campaign.read_plan(written(tmp_path, data.attrs["config"]))
        == plan
        == campaign.load_plan(tmp_path / "out")
    )


def test_durations_can_be_swept_and_each_run_keeps_its_times(tmp_path):
    text = TEXT.replace("protocol.1.load = [3.0, 6.0]", "protocol.0.duration = [1.0, 20.0]")
    plan = campaign.read_plan(written(tmp_path, text))
    do_here(plan, tmp_path / "out")
    data = campaign.open(tmp_path / "out")
    assert data["area"].dims == ("protocol.0.duration", "k1", "seed", "entry")
    assert data["time"].dims == ("protocol.0.duration", "k1", "entry")
    for duration in (1.0, 20.0):
        there = data.sel({"protocol.0.duration": duration, "k1": 3.0, "seed": 1}).dropna(
            "entry", subset=["time"]
        )
        contact = press(gaussian((16, 16), seed=1), spring_lattice(k0=1.0, k1=3.0), load=12.0)
        legs = [Hold(duration), Step(load=4.0), Hold(2.0)]
        times = np.unique(there["time"])[1:]
        assert times[-1] == duration + 2.0
        alone = age(contact, times, protocol=legs).dataset
        for name in ("time", "leg", "area", "load"):
            np.testing.assert_array_equal(there[name], alone[name])
    spans = data["time"].max("entry").values
    assert (spans == np.array([[3.0, 3.0], [22.0, 22.0]])).all()
    table = campaign.table(data)
    assert len(table) == 8
    assert (table["final_area"] == table["final_contact_fraction"] * 256).all()
    assert data.attrs["protocol_in_words"] == "hold swept, step load=4, hold 2"
    for variable in data.variables.values():
        assert variable.attrs["long_name"]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("protocol.7.load = [3.0]", "[sweep] protocol.7.load: no such leg; legs count from 0"),
        (
            "protocol.0.kind = ['hold']",
            "[sweep] protocol.0.kind: cannot be swept; load, separation, approach,",
        ),
        ("protocol.1.load = [-3.0]", "protocol[1] load: expected a number above 0.0, got -3.0"),
    ],
)
def test_sweeps_that_cannot_be(tmp_path, line, message):
    with pytest.raises(ConfigError) as caught:
        campaign.read_plan(written(tmp_path, TEXT.replace("protocol.1.load = [3.0, 6.0]", line)))
    assert message in str(caught.value)
