"""Units mean the same in every door: of loads on profiles, of arrays, and on axes of campaigns."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import asperity as asp
import asperity.app.campaign as campaign
from asperity import protocols
from asperity.app.config import config_from
from asperity.app.runs import Progress, execute
from asperity.base.words import written_with_units
from asperity.errors import ConfigError, InputError
from tests.campaign.conftest import do_here
from tests.refusals import refuses

pytestmark = pytest.mark.usefixtures("here")
RAMP: Any = protocols.Ramp
HALF_SPACE = asp.solids.half_space(modulus=3e9, branches=[(0.3, 1.0)])
ROUGH = asp.surfaces.spectral((16, 16), rms_height=0.05, spacing=0.5, unit="um")
PROFILE = asp.surfaces.Surface(-(np.linspace(-20.0, 20.0, 65)[:-1] ** 2) / 2e3, "um", (0.625,), "um")


def of(value: object, unit: str) -> Any:
    return xr.DataArray(value, attrs={"units": unit})


def test_a_load_on_a_profile_is_one_for_each_metre_and_on_a_surface_it_is_none():
    assert asp.press(PROFILE, HALF_SPACE, load="1 kN/m").load == pytest.approx(1e3)
    assert asp.press(ROUGH, HALF_SPACE, load="1 mN").load == pytest.approx(1e-3)
    with refuses("load", "'10 N'"):
        asp.press(PROFILE, HALF_SPACE, load="10 N")
    with refuses("load", "'1 kN/m'"):
        asp.press(ROUGH, HALF_SPACE, load="1 kN/m")
    for surface, right, wrong in ((PROFILE, "2 kN/m", "2 kN"), (ROUGH, "2 N", "2 N/m")):
        contact = asp.press(surface, HALF_SPACE, pressure="3 MPa")
        with refuses("protocol", repr(wrong)):
            asp.age(contact, [0.0], protocol=RAMP("1 s", load=wrong))
        end = asp.age(contact, [0.0], protocol=RAMP("1 s", load=right))["load"].values[-1]
        assert end == pytest.approx(float(right[0]) * (1e3 if "k" in right else 1))


@pytest.mark.parametrize(("unit", "right"), [("kN/m", True), ("N", False)])
def test_a_file_and_a_campaign_take_loads_on_profiles_alike(unit, right):
    columns = np.column_stack([np.linspace(-20, 20, 65)[:-1], PROFILE.heights])
    np.savetxt("cyl.txt", columns, header="x [um] z [um]")
    text = "[surface]\nkind = 'file'\npath = 'cyl.txt'\ntilt = 'none'\n[solid]\nkind = 'half_space'\n"
    text += f"modulus = '3 GPa'\n[aging]\ntimes = [1.0]\n[contact]\nload = '1 {unit}'\n"
    config = config_from(tomllib.loads(text), {}, None)
    if right:
        assert execute(config, Progress()).dataset["load"].values[-1] == pytest.approx(1e3)
    else:
        with refuses("load", "'1 N'"):
            execute(config, Progress())
    Path("camp.toml").write_text(f"{text}[sweep]\nload = ['1 {unit}', '2 {unit}']\n", encoding="utf-8")
    reports = do_here(campaign.read_plan("camp.toml"), Path("camp"))
    assert {state for _, state, _ in reports} == {"done" if right else "failed"}
    plan = campaign.load_plan("camp")
    units = [one.unit for run in plan.runs for one in written_with_units(run.config.contact.table)]
    assert units == 2 * ["N/m" if right else "N"]


def test_arrays_that_state_a_unit_are_in_it():
    assert asp.press(ROUGH, HALF_SPACE, load=of(2.304, "mN")).load == pytest.approx(2.304e-3)
    contact = asp.press(ROUGH, HALF_SPACE, pressure=of(3.0, "MPa"))
    assert contact.load == pytest.approx(3e6 * 64e-12)
    assert asp.solids.half_space(modulus=of(3.0, "GPa")).modulus == 3e9
    history = asp.age(contact, of([100.0, 1000.0], "ms"))
    np.testing.assert_allclose(history.time, [0, 0.1, 1])
    assert RAMP(of(2.0, "ms"), load=of(1.0, "mN")) == RAMP("2 ms", load="1 mN")
    assert contact.resistance(of(17.0, "nohm m")) == contact.resistance("17 nohm m")
    law = asp.law(HALF_SPACE, ROUGH, pressures=of([1.0, 4.0], "MPa"), times=0, per_decade=1)
    np.testing.assert_allclose(law["pressure"], [1e6, 4e6])
    slid = asp.steady_sliding(
        HALF_SPACE, ROUGH, speeds=of([1.0, 9.0], "um/s"), pressure="3 MPa", per_decade=1
    )
    np.testing.assert_allclose(slid["speed"], [1e-6, 9e-6])
    # Records of a history state their units, of a lattice its own.
    np.testing.assert_array_equal(asp.age(contact, history["time"]).time, history.time)
    springs = asp.press(np.asarray(ROUGH.heights), asp.solids.spring_lattice(k0=1.0, k1=1.0), load=3.0)
    aged = asp.age(springs, [1.0, 10.0])
    np.testing.assert_array_equal(asp.age(springs, aged["time"]).time, aged.time)
    with refuses("units", "'3.0 mN'"):
        asp.press(np.asarray(ROUGH.heights), asp.solids.spring_lattice(k0=1.0, k1=1.0), load=of(3.0, "mN"))


def test_heights_that_state_a_unit_are_in_it():
    nanometers = of(1e3 * np.asarray(ROUGH.heights), "nm")
    for unit in ("um", "1"):
        surface = asp.surfaces.Surface(nanometers, unit, (0.5, 0.5), "um")
        heights, _ = surface.in_meters()
        np.testing.assert_allclose(heights, ROUGH.in_meters()[0], rtol=1e-12)


def test_the_rule_of_edges_is_recorded_as_it_is_used():
    np.save("s.npy", np.asarray(ROUGH.heights))
    table = {"kind": "file", "path": "s.npy", "pixel_size": 0.5, "length_unit": "um", "file_unit": "um"}
    for edges, rule in (("free", "free"), ("periodic", "wrap"), ("reflecting", "reflect")):
        config = config_from({"surface": table | {"edges": edges}}, {}, None)
        assert config.surface.table["periodic"] == rule
        assert config_from({"surface": config.surface.table}, {}, None).surface.rule == rule
    with pytest.raises(ConfigError, match="periodic: expected 'free' beside edges 'free', got 'mirror'"):
        config_from({"surface": table | {"edges": "free", "periodic": "mirror"}}, {}, None)
    mirrored = config_from({"surface": table | {"edges": "periodic", "periodic": "mirror"}}, {}, None)
    assert (mirrored.surface.rule, mirrored.surface.scan.rule) == ("mirror", "reflect")


def test_axes_of_a_campaign_are_numbers_in_the_unit_of_the_surface():
    text = "[surface]\nkind = 'spectral'\nshape = [16, 16]\nspacing = 0.5\nunit = 'um'\nrms_height = 0.05\n"
    text += "[solid]\nkind = 'half_space'\nmodulus = 3e9\n[contact]\npressure = 3e6\n[aging]\ntimes = [1.0]\n"
    text += "[sweep]\n"
    Path("camp.toml").write_text(text + "rms_height = [0.05, '50 nm']\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="rms_height: expected different values"):
        campaign.read_plan("camp.toml")
    Path("camp.toml").write_text(text + "rms_height = [0.05, '100 nm']\n", encoding="utf-8")
    do_here(campaign.read_plan("camp.toml"), Path("camp"))
    swept = campaign.open("camp")["rms_height"]
    np.testing.assert_allclose(swept.values, [0.05, 0.1])
    assert swept.attrs["units"] == "um"


def test_the_axes_of_an_array_have_names():
    h5py = pytest.importorskip("h5py")
    heights = np.random.default_rng(0).normal(size=(12, 16))
    for names, stored in ((("y", "x"), heights), (("x", "y"), heights.T)):
        with h5py.File("a.h5", "w") as file:
            file["z"] = stored
            for axis, name, size in zip(file["z"].dims, names, stored.shape, strict=True):
                file[name] = np.arange(size)
                file[name].make_scale(name)
                axis.attach_scale(file[name])
        read = asp.surfaces.read("a.h5", file_unit="um", pixel_size="1um", tilt="none", channel="z")
        np.testing.assert_array_equal(read.heights, heights)


def test_an_ampere_is_no_length():
    Path("current.txt").write_text("# Channel: Current\n# Value units: A\n1 2 3\n4 5 7\n7 8 8\n")
    with refuses("current.txt", kind=InputError):
        asp.surfaces.read("current.txt", pixel_size="1um")


def test_numbers_of_profiles_are_for_each_length_of_it():
    stiff = asp.solids.half_space(modulus=3e9, apparatus="1 MN/m^2")
    series = [1 / asp.press(PROFILE, one, pressure="3 MPa").normal_stiffness for one in (stiff, HALF_SPACE)]
    assert 1 / (series[0] - series[1]) == pytest.approx(1e6)
    with refuses("apparatus", "'1 MN/m^2'"):
        asp.press(ROUGH, stiff, pressure="3 MPa")
    with refuses("apparatus", "'1 MN/m'"):
        asp.press(PROFILE, asp.solids.half_space(modulus=3e9, apparatus="1 MN/m"), pressure="3 MPa")
    plain: Any = asp.surfaces.Surface(PROFILE.heights, pixel_size=(0.625,))
    units = {
        name: one.attrs["units"] for name, one in asp.press(plain, HALF_SPACE, pressure=3e6).dataset.items()
    }
    assert [units[name] for name in ("load", "contact_area", "energy")] == [
        "force unit / length unit",
        "length unit",
        "force unit",
    ]
    assert "N/m" in repr(asp.press(PROFILE, HALF_SPACE, load="1 kN/m"))
