"""Numbers in words, and units: the same numbers as plain ones in SI through every door, or one clear line."""

import math
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
import xarray as xr

import asperity as asp
import asperity.app.campaign as campaign
from asperity import Contact, age, press
from asperity.app.config import config_from
from asperity.app.runs import Progress, execute
from asperity.base.units import _PREFIXES, factor, quantity
from asperity.base.words import data_size, duration, thousands, uncertain, written_with_units
from asperity.errors import ConfigError, InputError
from asperity.protocols import Hold, Ramp, Repeat, Step
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import Surface, gaussian, spectral
from tests.campaign.conftest import do_here
from tests.refusals import each_refuses, refuses

pytestmark = pytest.mark.usefixtures("here")
SCAN = Surface(gaussian((16, 16)), unit="um", pixel_size=(2.0, 2.0), length_unit="um")
RIDGES = Surface(gaussian((32,)), unit="um", pixel_size=(2.0,), length_unit="um")
PINT: Any = pint.UnitRegistry().Quantity
BARE = gaussian((16, 16))
HALF_SPACE = half_space(modulus=3e9, branches=[(0.3, 1e-2), (0.2, 60.0)])
MACHINE = half_space(modulus=3e9, apparatus=1e6)


def same(one: Contact, other: Contact) -> None:
    np.testing.assert_array_equal(one.u, other.u)
    assert one.load == other.load


def test_numbers_in_words() -> None:
    for value, error, text in (
        (3.0612, 0.0229, "3.061 ± 0.023"),
        (55.2, 13.9, "55 ± 14"),
        (35.0, 212.0, "35 ± 200"),
        (0.5, math.inf, "0.5 (undetermined)"),
        (2.0, 0.0, "2"),
    ):
        assert uncertain(value, error) == text
    assert thousands(40000) == "40\u202f000"
    assert [data_size(n) for n in (999, 2.5e6, 2e10, 3e15)] == ["999 B", "2.5 MB", "20 GB", "3e+03 TB"]
    for seconds, text in (
        (0.26, "0.26 seconds"),
        (59.6, "60 seconds"),
        (200.0, "3.3 minutes"),
        (7260.0, "2 hours"),
        (1e6, "12 days"),
        (math.nan, "not determined"),
    ):
        assert duration(seconds) == text


def test_a_text_becomes_a_number() -> None:
    texts: list[tuple[object, str, float]] = [
        ("1 MPa", "Pa", 1e6),
        ("1MPa", "Pa", 1e6),
        ("2.5e-1 GPa", "Pa", 2.5e8),
        ("3 N/mm^2", "Pa", 3e6),
        ("3 N/mm2", "Pa", 3e6),
        ("-4 mN", "N", -4e-3),
        ("2 h", "s", 7200.0),
        ("1.5 µm", "m", 1.5e-6),
        ("25 degC", "K", 298.15),
        ("80 kJ/mol", "J/mol", 80e3),
        ("50 mJ/m²", "J/m^2", 0.05),
        (" .5 ", "Pa", 0.5),
        (4, "Pa", 4.0),
    ]
    for text, unit, value in texts:
        found = quantity(text, unit)
        assert type(found) is float
        assert found == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    "unit", ["Pa", "N", "m", "s", "m/s", "Hz", "J", "K", "J/mol", "J/m^2", "ohm m", "W/m/K"]
)
def test_prefixes_are_those_of_pint_to_the_last_bit(unit: str) -> None:
    random = np.random.default_rng(0)
    for prefix in _PREFIXES:
        for amount in (1.0, 0.3, *random.lognormal(0, 10, 20).tolist()):
            expected = PINT(amount, f"{prefix}{unit}").to(unit).magnitude
            assert quantity(f"{amount} {prefix}{unit}", unit) == expected, (prefix, amount)


def test_other_texts_are_refused() -> None:
    for text in (
        *("1 furlong", "1 mpa", "1 s", "MPa", "1 2 MPa", "1,5 MPa", "nan Pa", "inf", "", "1 Pa/0"),
        *("1e400 Pa", "1 ()", "1 [Pa]", "1 Pa**9**9**9", "1 Pa^99", "1 __import__", "1 °", "1 %"),
        "1 " + "Pa " * 50,
    ):
        with refuses("pressure"):
            quantity(text, "Pa", "pressure")
    each_refuses(
        *(("load", quantity, wrong, "N", "load") for wrong in (None, True, float("nan"), 1j)),
        got="None | True | nan | 1j",
    )
    with refuses("quantity", "'1 m'"):
        quantity("1 m", "V")
    assert factor("GPa^-1", "1/Pa") == pytest.approx(1e-9)
    assert factor("GPa", "1/Pa") is None


@pytest.mark.parametrize(
    ("written", "unit", "meant"),
    [
        ("1mpa", "Pa", 1e6),
        ("3 GPA", "Pa", 3e9),
        ("2 UM", "m", 2e-6),
        ("5 Mn", "N", 5e-3),
        ("3 HZ", "Hz", 3.0),
    ],
)
def test_a_unit_in_another_case_is_refused_with_the_one_that_is_meant(written, unit, meant) -> None:
    with refuses("quantity", written) as raised:
        quantity(written, unit)
    error: Any = raised.value
    advised, reason = error.advice.split(", ")
    assert quantity(advised, unit) == pytest.approx(meant)
    assert reason == "as case matters"


def test_quantities_of_pint_are_texts_with_units() -> None:
    of = PINT
    same(press(SCAN, HALF_SPACE, load=of(10, "mN")), press(SCAN, HALF_SPACE, load=0.01))
    same(press(SCAN, HALF_SPACE, pressure=of(1, "kgf/mm^2")), press(SCAN, HALF_SPACE, pressure=9806650.0))
    same(press(SCAN, MACHINE, separation=of(1, "um")), press(SCAN, MACHINE, separation=1e-6))
    assert half_space(modulus=of(3, "GPa")) == half_space(modulus=3e9)
    assert quantity(of(5, "kg") * of(2e-3, "m/s^2"), "N") == pytest.approx(0.01)
    held = press(SCAN, half_space(modulus=3e9, branches=[(0.5, of(2, "ms"))]), load=0.01)
    aged = age(held, [of(1, "ms"), of(1, "min")], protocol=[Hold(of(1, "s")), Ramp(59, load=of(20, "mN"))])
    np.testing.assert_allclose(aged.time, [0, 1e-3, 1, 60])
    assert float(aged.load[-1]) == pytest.approx(0.02, rel=1e-12)
    same(press(held, load=of(20, "mN")), press(held, load=0.02))
    scan = Surface(BARE, unit="um", pixel_size=(of(2, "um"), of(2000, "nm")))
    assert (scan.pixel_size, scan.length_unit) == (SCAN.pixel_size, "um")
    assert quantity(of(0.5, "1/GPa"), "1/Pa") == pytest.approx(5e-10)
    assert quantity(of(25, "degC"), "K") == pytest.approx(298.15)
    both = press(SCAN, HALF_SPACE, load=of([5, 10], "mN"))
    np.testing.assert_allclose([one.load for one in both], [0.005, 0.01])
    np.testing.assert_allclose(age(both[0], of([1, 2], "ms")).time, [0, 1e-3, 2e-3])
    with refuses("load", "'10 MPa'"):
        press(SCAN, HALF_SPACE, load=of(10, "MPa"))
    with refuses("units", "'1 N'"):
        press(BARE, HALF_SPACE, load=of(1, "N"))


def test_units_are_refused_where_there_are_none_and_others_than_expected() -> None:
    plain, line = press(BARE, HALF_SPACE, load=1e6), press(RIDGES, HALF_SPACE, load=2000.0)
    legs: tuple[Any, Any] = [Repeat((Hold("1 min"),), 2)], [Step(load="1 N")]  # type: ignore[arg-type]
    others = ("10 MPa", "ten N", "5", "10 mN 5")
    each_refuses(
        *(("load", partial(press, load=wrong), SCAN, HALF_SPACE) for wrong in others),
        ("units", partial(press, load="1 N"), BARE, HALF_SPACE),
        ("units", partial(press, load="1 N"), SCAN, spring_lattice(k0=1.0, k1=3.0)),
        ("units", age, plain, ["1 s", "1 min"]),
        ("units", partial(age, protocol=legs[0]), plain, [1.0]),
        ("load", partial(press, load="1 N"), RIDGES, HALF_SPACE),
        ("protocol", partial(age, protocol=legs[1]), line, [1.0]),
        got="'10 MPa' | 'ten N' | '5' | '10 mN 5' | '1 N' | '1 N' | '1 s' | '1 min' | '1 N' | '1 N'",
    )


def test_times_and_legs_take_units() -> None:
    contact = press(SCAN, HALF_SPACE, load=0.01)
    written = age(contact, ["10 ms", "1 s", "2 min"], fields_at="1 s")
    plain = age(contact, [0.01, 1.0, 120.0], fields_at=[1.0])
    assert written.dataset.identical(plain.dataset)
    legs = [Hold("1 min"), Ramp("10 s", load="20 mN"), Step(load="5 mN"), Hold("1 s")]  # type: ignore[arg-type]
    plain_legs = [Hold(60.0), Ramp(10.0, load=0.02), Step(load=0.005), Hold(1.0)]
    assert legs == plain_legs
    written = age(contact, "30 s", protocol=legs)
    assert written.dataset.identical(age(contact, [30.0], protocol=plain_legs).dataset)
    each_refuses(
        ("times", "'10 m'", age, contact, ["10 m"]), ("times", "'soon'", age, contact, ["10 s", "soon"])
    )


ramp: Any = Ramp
ROUGH = spectral((16, 16), rms_height=0.05, spacing=0.5, unit="um")
PROFILE = Surface(-(np.linspace(-20.0, 20.0, 65)[:-1] ** 2) / 2e3, "um", (0.625,), "um")


def stated(value: object, unit: str) -> Any:
    return xr.DataArray(value, attrs={"units": unit})


def test_a_load_on_a_profile_is_one_for_each_metre_and_on_a_surface_it_is_none():
    assert press(PROFILE, HALF_SPACE, load="1 kN/m").load == pytest.approx(1e3)
    assert press(ROUGH, HALF_SPACE, load="1 mN").load == pytest.approx(1e-3)
    with refuses("load", "'10 N'"):
        press(PROFILE, HALF_SPACE, load="10 N")
    with refuses("load", "'1 kN/m'"):
        press(ROUGH, HALF_SPACE, load="1 kN/m")
    for surface, right, wrong in ((PROFILE, "2 kN/m", "2 kN"), (ROUGH, "2 N", "2 N/m")):
        contact = press(surface, HALF_SPACE, pressure="3 MPa")
        with refuses("protocol", repr(wrong)):
            age(contact, [0.0], protocol=ramp("1 s", load=wrong))
        end = age(contact, [0.0], protocol=ramp("1 s", load=right))["load"].values[-1]
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
    assert press(ROUGH, HALF_SPACE, load=stated(2.304, "mN")).load == pytest.approx(2.304e-3)
    contact = press(ROUGH, HALF_SPACE, pressure=stated(3.0, "MPa"))
    assert contact.load == pytest.approx(3e6 * 64e-12)
    assert half_space(modulus=stated(3.0, "GPa")).modulus == 3e9
    history = age(contact, stated([100.0, 1000.0], "ms"))
    np.testing.assert_allclose(history.time, [0, 0.1, 1])
    assert ramp(stated(2.0, "ms"), load=stated(1.0, "mN")) == ramp("2 ms", load="1 mN")
    assert contact.resistance(stated(17.0, "nohm m")) == contact.resistance("17 nohm m")
    law = asp.law(HALF_SPACE, ROUGH, pressures=stated([1.0, 4.0], "MPa"), times=0, per_decade=1)
    np.testing.assert_allclose(law["pressure"], [1e6, 4e6])
    slid = asp.steady_sliding(
        HALF_SPACE, ROUGH, speeds=stated([1.0, 9.0], "um/s"), pressure="3 MPa", per_decade=1
    )
    np.testing.assert_allclose(slid["speed"], [1e-6, 9e-6])
    # Records of a history state their units, of a lattice its own.
    np.testing.assert_array_equal(age(contact, history["time"]).time, history.time)
    springs = press(np.asarray(ROUGH.heights), spring_lattice(k0=1.0, k1=1.0), load=3.0)
    aged = age(springs, [1.0, 10.0])
    np.testing.assert_array_equal(age(springs, aged["time"]).time, aged.time)
    with refuses("units", "'3.0 mN'"):
        press(np.asarray(ROUGH.heights), spring_lattice(k0=1.0, k1=1.0), load=stated(3.0, "mN"))


def test_heights_that_state_a_unit_are_in_it():
    nanometers = stated(1e3 * np.asarray(ROUGH.heights), "nm")
    for unit in ("um", "1"):
        surface = Surface(nanometers, unit, (0.5, 0.5), "um")
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
    stiff = half_space(modulus=3e9, apparatus="1 MN/m^2")
    series = [1 / press(PROFILE, one, pressure="3 MPa").normal_stiffness for one in (stiff, HALF_SPACE)]
    assert 1 / (series[0] - series[1]) == pytest.approx(1e6)
    with refuses("apparatus", "'1 MN/m^2'"):
        press(ROUGH, stiff, pressure="3 MPa")
    with refuses("apparatus", "'1 MN/m'"):
        press(PROFILE, half_space(modulus=3e9, apparatus="1 MN/m"), pressure="3 MPa")
    plain: Any = Surface(PROFILE.heights, pixel_size=(0.625,))
    units = {name: one.attrs["units"] for name, one in press(plain, HALF_SPACE, pressure=3e6).dataset.items()}
    assert [units[name] for name in ("load", "contact_area", "energy")] == [
        "force unit / length unit",
        "length unit",
        "force unit",
    ]
    assert "N/m" in repr(press(PROFILE, HALF_SPACE, load="1 kN/m"))
