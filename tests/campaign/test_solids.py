"""Campaigns of continua: what can be swept, its units, and fields of several branches."""

import tomllib

import numpy as np
import pytest

import asperity as asp
import asperity.app.campaign as campaign
from asperity.app.campaign.plan import read_plan, value_at
from asperity.app.cli import main
from asperity.errors import ConfigError
from tests.campaign.conftest import do_here, written

HALF_SPACES = """
[surface]
kind = "spectral"
shape = [32, 32]
rms_height = 0.1
spacing = 0.5
unit = "um"
[solid]
kind = "half_space"
modulus = 1e9
branches = [[0.3, "10 ms"], [0.4, 1.0]]
[contact]
pressure = "2 MPa"
[aging]
per_decade = 1
[output]
maps_at = [0.0, 1.0]
[sweep]
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished campaign of two seeds and two moduli, not to be changed."""
    folder = tmp_path_factory.mktemp("campaign")
    plan = read_plan(written(folder, f'{HALF_SPACES}\nmodulus = ["1 GPa", 4e9]\nseeds = 2\n'))
    do_here(plan, folder / "out")
    return folder / "out"


def test_moduli_and_seeds_give_what_single_runs_give_with_their_units(done):
    data = campaign.open(done)
    assert data.sizes == {"modulus": 2, "seed": 2, "time": 6, "field_time": 2, "quantile": 6}
    assert data["modulus"].values.tolist() == [1e9, 4e9]
    assert data["modulus"].attrs == {"long_name": "contact modulus", "units": "Pa"}
    units = {name: data[name].attrs["units"] for name in ("load", "contact_area", "separation", "energy")}
    assert units == {"load": "N", "contact_area": "m^2", "separation": "m", "energy": "J"}
    assert data["largest_pressure_mean"].attrs["units"] == "Pa"
    assert data["relaxed_load"].attrs["units"] == "N"
    assert data["time"].attrs["units"] == "s"
    assert (data.attrs["solid"], data.attrs["kind"], data.attrs["pressure"]) == (
        "half_space",
        "spectral",
        2e6,
    )
    heights = asp.surfaces.spectral((32, 32), rms_height=0.1, spacing=0.5, seed=1)
    surface = asp.surfaces.Surface(heights, "um", (0.5, 0.5), "um")
    solid = asp.solids.half_space(modulus=4e9, branches=[(0.3, 0.01), (0.4, 1.0)])
    alone = asp.age(asp.press(surface, solid, pressure=2e6), data["time"].values[1:]).dataset
    there = data.sel(modulus=4e9, seed=1)
    for name in ("area", "contact_area_corrected", "largest_pressure", "energy"):
        np.testing.assert_array_equal(there[name], alone[name])
    stiffer, softer = data["initial_area"].sel(modulus=4e9), data["initial_area"].sel(modulus=1e9)
    assert (softer > stiffer).all()
    assert tomllib.loads(data.attrs["config"])["sweep"]["modulus"] == [1e9, 4e9]


def test_the_table_names_units(done, capsys):
    assert main(["gather", str(done)]) == 0
    header = (done / "gathered.csv").read_text().splitlines()[0].split(",")
    assert header[:3] == ["modulus_Pa", "seed", "final_area_sites"]
    assert {"relaxed_load_N", "relaxed_energy_J", "relaxed_separation_m", "relaxed_residual"} <= set(header)
    assert "4 of 4 runs" in capsys.readouterr().out


def test_the_table_writes_counts_as_whole_numbers(tmp_path):
    text = (
        "surface.shape = [16, 16]\n[solid]\nhardness = 1.0\n[contact]\nload = 40.0\n"
        "[aging]\nfirst = 1.0\nlast = 10.0\nper_decade = 1\n"
        "[output]\nmaps_at = [0.0, 10.0]\n[sweep]\nseeds = 2\n"
    )
    plan = read_plan(written(tmp_path, text))
    do_here(plan, tmp_path / "out")
    table = campaign.table(campaign.open(tmp_path / "out"))
    counts = ["final_area", "final_yielding_area", "final_patches", "initial_largest_patch_size"]
    assert [str(table[name].dtype) for name in counts] == ["Int64"] * 4
    assert (table["final_yielding_area"] > 0).all()
    assert str(table["final_mean_patch_size"].dtype) == "float64"


def test_fields_of_several_branches_come_back(done):
    fields = campaign.fields(done, modulus=4e9, seed=0)
    assert fields["u0"].dims == ("field_time", "branch", "y", "x")
    np.testing.assert_allclose(fields["pressure"].mean(("y", "x")), 2e6, rtol=1e-8)


def test_branches_pressures_and_thicknesses_can_be_swept(tmp_path):
    spectra = (
        'branches = [[[0.5, 1.0]], [[0.2, "10 ms"], [0.3, 1.0]]]\npressure = ["1 MPa", 2e6]\nseeds = 1\n'
    )
    with pytest.raises(ConfigError, match="expected the same times for all runs; try first and last"):
        read_plan(written(tmp_path, HALF_SPACES + spectra))
    fixed = HALF_SPACES.replace("per_decade", "first = 0.1\nlast = 1.0\nper_decade")
    plan = read_plan(written(tmp_path, fixed + spectra))
    named = {axis.name: axis.values for axis in plan.axes}
    assert named == {"branches": ("0.5 1", "0.2 0.01 0.3 1"), "pressure": (1e6, 2e6)}
    assert value_at(plan.runs[-1].config, "solid", "branches") == [(0.2, 0.01), (0.3, 1.0)]
    layers = HALF_SPACES.replace('"half_space"', '"layer"\npoisson = 0.3\nthickness = "1 um"')
    plan = read_plan(written(tmp_path, f'{layers}\nthickness = ["0.5 um", 2e-6]\nseeds = 1\n'))
    assert [value_at(run.config, "solid", "thickness") for run in plan.runs] == [0.5e-6, 2e-6]
    assert len({run.identity for run in plan.runs}) == 2


def test_one_number_of_a_branch_can_be_swept(tmp_path):
    base = HALF_SPACES.replace("per_decade", "first = 0.1\nlast = 1.0\nper_decade")
    plan = read_plan(
        written(tmp_path, base + 'solid.branches.1.time = ["2 s", 20.0]\nbranches.0.share = [0.1, 0.2]\n')
    )
    assert [(axis.section, axis.name, axis.values) for axis in plan.axes] == [
        ("solid", "branches.1.time", (2.0, 20.0)),
        ("solid", "branches.0.share", (0.1, 0.2)),
    ]
    spectra = [value_at(run.config, "solid", "branches") for run in plan.runs]
    assert spectra[0] == [(0.1, 0.01), (0.4, 2.0)]
    assert spectra[-1] == [(0.2, 0.01), (0.4, 20.0)]
    do_here(plan, tmp_path / "out")
    data = campaign.open(tmp_path / "out")
    assert data["branches.1.time"].attrs == {
        "long_name": "relaxation time of each branch, branches.1.time",
        "units": "s",
    }
    assert "branch_times" not in data.attrs
    assert read_plan(written(tmp_path, data.attrs["config"])) == plan


@pytest.mark.parametrize("name", ["branches.2.time", "branches.0.modulus", "modulus.0"])
def test_there_is_no_such_number(tmp_path, name):
    with pytest.raises(ConfigError, match=rf"\[sweep\] {name}: no such entry; entries count from 0"):
        read_plan(written(tmp_path, f"{HALF_SPACES}\n{name} = [1.0]\n"))


@pytest.mark.parametrize(
    ("sweep", "line"),
    [
        ('modulus = ["1 GPa", 1e9]', "[sweep] modulus: expected different values"),
        ('modulus = ["1 N"]', "[solid] modulus: expected a pressure, such as 1 MPa, got '1 N'"),
        ("k1 = [1.0]", "[solid] k1: not a key of a solid of kind 'half_space', but of 'spring_lattice'"),
        ("load = [1.0]", "[contact] expected load or pressure, got both"),
    ],
)
def test_mistakes_are_named_before_anything_starts(tmp_path, sweep, line):
    with pytest.raises(ConfigError) as caught:
        read_plan(written(tmp_path, HALF_SPACES + sweep))
    (problem,) = caught.value.problems
    assert line in problem


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
    [sweep]
    """
    do_here(read_plan(written(tmp_path, f'{text}\n"places.1.1" = ["20 um", "30 um"]\n')), tmp_path / "far")
    data = campaign.open(tmp_path / "far")
    assert data["places.1.1"].values.tolist() == pytest.approx([20e-6, 30e-6])
    assert data["places.1.1"].attrs["units"] == "m"
    for number, x in enumerate([20e-6, 30e-6]):
        balls = asp.surfaces.array((24, 48), places=[(12e-6, 10e-6), (12e-6, x)], radii=1e-3, pixel_size=1e-6)
        solid = asp.solids.half_space(modulus=1e9, branches=[(0.5, 1.0)])
        contact = asp.press(balls, solid, load=1e-3)
        assert float(data["separation"][number, 0]) == pytest.approx(contact.separation, rel=1e-9)
    do_here(read_plan(written(tmp_path, f'{text}\nradii = ["1 mm", "2 mm"]\n')), tmp_path / "large")
    data = campaign.open(tmp_path / "large")
    assert data.attrs["places_x"] == pytest.approx([10e-6, 22e-6])
    assert float(data["contact_area"][1, 0]) > 1.2 * float(data["contact_area"][0, 0])
    with pytest.raises(ConfigError, match="a surface of kind 'array' has no seed"):
        read_plan(written(tmp_path, f"{text}\nseeds = 3\n"))
