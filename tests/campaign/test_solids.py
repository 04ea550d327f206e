"""Campaigns of continua and of histories: what they hold is what single runs give, with its units."""

import json
import tomllib

import numpy as np
import pytest

import asperity as asp
import asperity.app.campaign as campaign
from asperity.app.campaign.plan import read_plan
from asperity.app.cli import main
from asperity.errors import ConfigError
from asperity.protocols import Hold, Step
from tests.campaign.conftest import HALF_SPACES, HISTORY, done_here, written


def campaign_of(folder, text):
    """The results of a campaign, all of whose variables have names and units."""
    plan = done_here(folder, text)
    data = campaign.open(folder / "out")
    unnamed = {name for name, one in data.variables.items() if not {"long_name", "units"} <= set(one.attrs)}
    assert not unnamed
    # The file of the campaign, written from its results, plans the same runs.
    assert read_plan(written(folder, data.attrs["config"])) == plan == campaign.load_plan(folder / "out")
    return data


def test_moduli_and_seeds_give_what_single_runs_give_with_their_units(tmp_path, capsys):
    data = campaign_of(tmp_path, f'{HALF_SPACES}[sweep]\nmodulus = ["1 GPa", 4e9]\nseeds = 2\n')
    assert data.sizes == {"modulus": 2, "seed": 2, "time": 6, "field_time": 2, "quantile": 6}
    assert data["modulus"].values.tolist() == [1e9, 4e9]
    assert data["modulus"].attrs == {"long_name": "contact modulus", "units": "Pa"}
    expected = {"load": "N", "contact_area": "m^2", "separation": "m", "energy": "J", "time": "s"}
    expected |= {"largest_pressure_mean": "Pa", "relaxed_load": "N"}
    assert {name: data[name].attrs["units"] for name in expected} == expected
    given = {"solid": "half_space", "kind": "spectral", "pressure": 2e6}
    assert given.items() <= data.attrs.items()
    heights = asp.surfaces.spectral((32, 32), rms_height=0.1, spacing=0.5, seed=1)
    surface = asp.surfaces.Surface(heights, "um", (0.5, 0.5), "um")
    solid = asp.solids.half_space(modulus=4e9, branches=[(0.3, 0.01), (0.4, 1.0)])
    alone = asp.age(asp.press(surface, solid, pressure=2e6), data["time"].values[1:]).dataset
    there = data.sel(modulus=4e9, seed=1)
    for name in ("area", "contact_area_corrected", "largest_pressure", "energy"):
        np.testing.assert_array_equal(there[name], alone[name])
    assert (data["initial_area"].sel(modulus=1e9) > data["initial_area"].sel(modulus=4e9)).all()
    assert tomllib.loads(data.attrs["config"])["sweep"]["modulus"] == [1e9, 4e9]
    fields = campaign.fields(tmp_path / "out", modulus=4e9, seed=0)
    assert fields["u0"].dims == ("field_time", "branch", "y", "x")
    np.testing.assert_allclose(fields["pressure"].mean(("y", "x")), 2e6, rtol=1e-8)
    assert main(["gather", str(tmp_path / "out")]) == 0
    header = (tmp_path / "out" / "gathered.csv").read_text().splitlines()[0].split(",")
    assert header[:3] == ["modulus_Pa", "seed", "final_area_sites"]
    assert {"relaxed_load_N", "relaxed_energy_J", "relaxed_separation_m", "relaxed_residual"} <= set(header)
    assert "4 of 4 runs" in capsys.readouterr().out


def test_the_table_writes_counts_as_whole_numbers(tmp_path):
    text = (
        "surface.shape = [16, 16]\n[solid]\nhardness = 1.0\n[contact]\nload = 40.0\n"
        "[aging]\nfirst = 1.0\nlast = 10.0\nper_decade = 1\n"
        "[output]\nmaps_at = [0.0, 10.0]\n[sweep]\nseeds = 2\n"
    )
    table = campaign.table(campaign_of(tmp_path, text))
    counts = ["final_area", "final_yielding_area", "final_patches", "initial_largest_patch_size"]
    assert [str(table[name].dtype) for name in counts] == ["Int64"] * 4
    assert (table["final_yielding_area"] > 0).all()
    assert str(table["final_mean_patch_size"].dtype) == "float64"


def test_one_number_of_a_branch_can_be_swept(tmp_path):
    base = HALF_SPACES.replace("per_decade", "first = 0.1\nlast = 1.0\nper_decade")
    data = campaign_of(tmp_path, f'{base}[sweep]\nsolid.branches.1.time = ["2 s", 20.0]\n')
    name = "relaxation time of each branch, branches.1.time"
    assert data["branches.1.time"].attrs == {"long_name": name, "units": "s"}
    assert "branch_times" not in data.attrs


def test_the_distance_of_two_balls_and_their_radius_can_be_swept(tmp_path):
    text = """
    [surface]
    kind = "array"
    shape = [24, 48]
    places = [["12 um", "10 um"], ["12 um", "22 um"]]
    radii = "1 mm"
    pixel_size = "1 um"
    [solid]
    kind = "half_space"
    modulus = "1 GPa"
    branches = [[0.5, 1.0]]
    [contact]
    load = "1 mN"
    [aging]
    times = [1.0]
    [carried]
    resistivity = 1e-8
    [sweep]
    """
    data = campaign_of(tmp_path, f'{text}\n"places.1.1" = ["20 um", "30 um"]\nradii = ["1 mm", "2 mm"]\n')
    assert data["places.1.1"].values.tolist() == pytest.approx([20e-6, 30e-6])
    assert data["places.1.1"].attrs["units"] == "m"
    solid = asp.solids.half_space(modulus=1e9, branches=[(0.5, 1.0)])
    for number, x in enumerate([20e-6, 30e-6]):
        balls = asp.surfaces.array((24, 48), places=[(12e-6, 10e-6), (12e-6, x)], radii=1e-3, pixel_size=1e-6)
        contact = asp.press(balls, solid, load=1e-3)
        assert float(data["separation"][number, 0, 0]) == pytest.approx(contact.separation, rel=1e-9)
        assert float(data["resistance"][number, 0, 0]) == pytest.approx(contact.resistance(1e-8), rel=1e-6)
    assert float(data["contact_area"][0, 1, 0]) > 1.2 * float(data["contact_area"][0, 0, 0])
    with pytest.raises(ConfigError, match="a surface of kind 'array' has no seed"):
        read_plan(written(tmp_path, f"{text}\nseeds = 3\n"))


def as_alone(there, *legs):
    """Expect what a single run of these legs gives."""
    contact = asp.press(
        asp.surfaces.gaussian((16, 16), seed=1), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=12.0
    )
    alone = asp.age(contact, np.unique(there["time"])[1:], protocol=legs).dataset
    for name in ("time", "leg", "area", "load", "energy"):
        np.testing.assert_array_equal(there[name], alone[name])


def test_what_a_history_holds_can_be_swept(tmp_path):
    data = campaign_of(tmp_path, f"{HISTORY}[sweep]\nprotocol.1.load = [3.0, 6.0]\nk1 = [3.0]\nseeds = 2")
    assert data["area"].dims == ("protocol.1.load", "k1", "seed", "time")
    for load in (3.0, 6.0):
        there = data.sel({"protocol.1.load": load, "k1": 3.0, "seed": 1})
        as_alone(there, Hold(1.0), Step(load=load), Hold(2.0))
    assert json.loads(data.attrs["protocol"])[0] == {"kind": "hold", "duration": 1.0}


def test_durations_can_be_swept_and_each_run_keeps_its_times(tmp_path):
    data = campaign_of(
        tmp_path, f"{HISTORY}[sweep]\nprotocol.0.duration = [1.0, 20.0]\nk1 = [3.0]\nseeds = 2"
    )
    assert data["area"].dims == ("protocol.0.duration", "k1", "seed", "entry")
    assert data["time"].dims == ("protocol.0.duration", "k1", "entry")
    for duration in (1.0, 20.0):
        there = data.sel({"protocol.0.duration": duration, "k1": 3.0, "seed": 1})
        there = there.dropna("entry", subset=["time"])
        assert there["time"][-1] == duration + 2.0
        as_alone(there, Hold(duration), Step(load=4.0), Hold(2.0))
    table = campaign.table(data)
    assert len(table) == 4
    assert (table["final_area"] == table["final_contact_fraction"] * 256).all()
    assert data.attrs["protocol_in_words"] == "hold swept, step load=4, hold 2"


def test_a_strength_that_ages_is_swept(tmp_path):
    text = """
    [surface]
    shape = [24, 24]
    [contact]
    load = 30.0
    [aging]
    times = [10.0]
    [friction]
    shear_strength = 0.5
    after = 0.1
    renewal = 2.0
    [sweep]
    growth = [0.0, 0.02]
    """
    data = campaign_of(tmp_path, text)
    area, friction = (data[name].values[:, 0, -1] for name in ("friction_by_area", "friction"))
    assert area[0] == area[1] == friction[0]
    assert data["strength_mean"].values[1, 0, -1] == pytest.approx(0.5 * friction[1] / area[1], rel=1e-12)
    assert friction[1] > 1.05 * friction[0]
