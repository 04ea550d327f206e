"""The law of a rough layer, against closed forms, fresh presses, energies, a network of flow and CalculiX."""

import math
import re
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest
import scipy.sparse.linalg
from scipy.interpolate import CubicHermiteSpline
from scipy.stats import t as student

import asperity as asp
from asperity.analysis import flow
from asperity.errors import CheckpointError
from tests.refusals import each_refuses, refuses

PIXEL, SITES = 1e-6, 64
AREA = (SITES * PIXEL) ** 2
ELASTIC = asp.solids.half_space(modulus="3 GPa")
RELAXING = asp.solids.half_space(modulus="3 GPa", branches=[(0.3, 10.0), (0.2, 1e3)])
CARRIED = asp.Carried(poisson=0.3, resistivity=(1e-6, 3e-6), conductivity="0.2 W/m/K")
RANGE = ["0.5 MPa", "20 MPa"]


def surface(heights, edges="periodic"):
    return asp.surfaces.Surface(heights, "m", (PIXEL, PIXEL), "m", edges=edges)


def rough(seed=3, sites=SITES, **kinds):
    kinds = {"roll_off": 24.0, "cutoff": 4.0, "rms_slope": 0.1} | kinds
    return 1e-6 * asp.surfaces.spectral((sites, sites), seed=seed, **kinds)


ROUGH = rough()


@pytest.fixture(scope="module")
def law():
    """Of the elastic half-space."""
    return asp.law(ELASTIC, surface(ROUGH), pressures=RANGE, carried=CARRIED)


@pytest.fixture(scope="module")
def aged():
    return asp.law(RELAXING, surface(ROUGH), pressures=RANGE, times=["0 s", "1 h"], per_decade=4)


def table(law, direction="loading", time=0):
    return law.sel(direction=direction).isel(time=time)


def test_it_interpolates_fresh_presses_and_is_monotone(law):
    found = table(law)
    for name, sign in (("approach", 1), ("stiffness", 1), ("contact_fraction", 1), ("mean_gap", -1)):
        assert (sign * np.diff(found[name]) > 0).all()
    drawn = np.exp(np.random.default_rng(1).uniform(math.log(0.6e6), math.log(19e6), 20))
    pressed: Any = asp.press(surface(ROUGH), ELASTIC, pressure=drawn)
    for pressure, contact in zip(drawn, pressed, strict=True):
        approach = ROUGH.max() - contact.u.mean()
        assert np.interp(approach, found["approach"], found["pressure"]) == pytest.approx(pressure, rel=0.01)
        assert contact.contact_fraction == pytest.approx(
            np.interp(pressure, found["pressure"], found["contact_fraction"]), rel=0.01, abs=4 / SITES**2
        )


@pytest.mark.parametrize(
    "solid",
    [
        ELASTIC,
        asp.solids.half_space(modulus="3 GPa", apparatus="1 MN/m"),
        asp.solids.layer(young="3 GPa", poisson=0.3, thickness="15 um"),
        asp.solids.coated_half_space(
            young="3 GPa", poisson=0.3, thickness="5 um", base_modulus="30 GPa", base_poisson=0.3
        ),
    ],
    ids=str,
)
def test_work_is_the_elastic_energy_less_that_of_even_compression(solid):
    found = table(asp.law(solid, surface(ROUGH), pressures=RANGE))
    ends = found["pressure"].values[[0, -1]]
    energy = np.array([one.energy for one in asp.press(surface(ROUGH), solid, pressure=ends)]) / AREA
    if solid.parameters.get("apparatus"):
        energy -= (ends * AREA) ** 2 / (2 * 1e6) / AREA
    if solid.kind == "layer":  # confined: stiffness M / thickness for each area
        modulus = 3e9 * 0.7 / (1.3 * 0.4)
        energy -= ends**2 * 15e-6 / (2 * modulus)
    approach = found["approach"].values
    curve = CubicHermiteSpline(approach, found["pressure"].values, found["stiffness"].values)
    assert curve.integrate(approach[0], approach[-1]) == pytest.approx(energy[1] - energy[0], rel=1e-3)


@pytest.mark.parametrize("edges", ["reflecting", "free"])
def test_stiffness_is_the_slope_and_carries_the_conductances(edges):
    scan = surface(ROUGH, edges)
    found = table(asp.law(ELASTIC, scan, pressures=[5e6, 6e6, 8e6], carried=CARRIED))
    gaps = [float(c.gap.mean()) for c in asp.press(scan, ELASTIC, pressure=[5.88e6, 6.12e6])]
    stiffness = found["stiffness"].values
    assert stiffness[1] == pytest.approx(0.24e6 / (gaps[0] - gaps[1]), rel=0.02)
    assert found["conductance"].values == pytest.approx(2 * stiffness / (3e9 * 4e-6))
    assert found["thermal_conductance"].values == pytest.approx(2 * stiffness / (3e9 * 10))
    mean, *ends = (found[f"tangential_stiffness{end}"].values for end in ("", "_soft", "_stiff"))
    assert mean == pytest.approx(2 * 0.7 / 1.7 * stiffness, rel=0.03)
    assert mean == pytest.approx(2 / (1 / ends[0] + 1 / ends[1]))
    along = asp.Carried(poisson=0.0, direction="y")
    even = table(asp.law(ELASTIC, scan, pressures=[5e6, 6e6], carried=along))
    assert even["tangential_stiffness_y"].values == pytest.approx(even["stiffness"].values)
    if edges != "free":
        contact = asp.press(scan, ELASTIC, pressure=6e6)
        assert stiffness[1] == pytest.approx(contact.normal_stiffness / AREA)


def test_a_relaxing_solid_has_the_elastic_law_at_a_larger_pressure(aged):
    creep = asp.relaxation.PronySeries(3e9, ((0.3, 10.0), (0.2, 1e3))).compliance_at([3600.0])[0] * 3e9
    assert creep > 1.5
    pressures = aged["pressure"].values
    elastic = table(asp.law(ELASTIC, surface(ROUGH), pressures=creep * pressures))
    for name in ("approach", "stiffness", "contact_fraction", "hydraulic_gap_x"):
        assert table(aged, time=1)[name].values == pytest.approx(elastic[name].values, rel=1e-6)


def test_unloading_is_apart_where_something_crept_or_yielded(law, aged):
    assert law["direction"].values.tolist() == ["loading"]
    hard = asp.law(ELASTIC.with_hardness("100 MPa"), surface(ROUGH), pressures=RANGE, per_decade=3)
    for found, time in ((aged, 1), (hard, 0)):
        up, down = (table(found, one, time)["approach"].values for one in ("loading", "unloading"))
        assert up[-1] == down[-1]
        assert (down[:-1] > up[:-1]).all()
    # At once, before anything crept, there is one curve.
    assert table(aged, "unloading")["approach"].values == pytest.approx(table(aged)["approach"].values)


def test_hydraulic_gaps_are_those_of_the_flow_along_each_axis():
    """Reynolds' equation on the pixels of a gap, by finite volumes, between two sides; others are walls."""

    def conductivity(gap, aspect=1.0):
        cubes, number = gap**3, np.arange(gap.size).reshape(gap.shape)
        rows: list[Any] = []
        columns: list[Any] = []
        values: list[Any] = []
        for here, there, sides in (
            (np.s_[:-1], np.s_[1:], 1 / aspect),
            (np.s_[:, :-1], np.s_[:, 1:], aspect),
        ):
            k = 2 * sides * cubes[here] * cubes[there] / (cubes[here] + cubes[there])
            i, j = number[here].ravel(), number[there].ravel()
            rows, columns = [*rows, i, j, i, j], [*columns, j, i, i, j]
            values += [-k.ravel(), -k.ravel(), k.ravel(), k.ravel()]
        ends = np.zeros(gap.shape), np.zeros(gap.shape)
        for side, column in ((ends[0], 0), (ends[1], -1)):
            side[:, column] = 2 * aspect * cubes[:, column]
        rows, columns = [*rows, number.ravel()], [*columns, number.ravel()]
        values.append((ends[0] + ends[1]).ravel())
        places = np.concatenate(rows), np.concatenate(columns)
        matrix = scipy.sparse.csr_array((np.concatenate(values), places))
        pressure = scipy.sparse.linalg.spsolve(matrix, ends[0].ravel())
        return float(pressure @ ends[1].ravel()) * gap.shape[1] / gap.shape[0] / aspect

    grooves = np.repeat(ROUGH[:, ::8], 8, axis=1)  # along x, of a length of 8 pixels
    for heights, pressure in ((ROUGH, 1e6), (ROUGH, 5e6), (grooves, 5e6)):
        contact = asp.press(surface(heights), ELASTIC, pressure=pressure)
        found = table(asp.law(ELASTIC, surface(heights), pressures=[pressure, 1.01 * pressure]))
        gap = np.maximum(contact.gap, 1e-12)  # of contacts, where nothing flows
        for axis, along in (("x", gap), ("y", gap.T)):
            assert found[f"hydraulic_gap_{axis}"][0] == pytest.approx(
                conductivity(along) ** (1 / 3), rel=1e-4
            )
            twice = np.repeat(along, 2, axis=0)  # halves of pixels: wide ones
            assert flow.hydraulic_gap(twice, 0.5) == pytest.approx(
                conductivity(twice, 0.5) ** (1 / 3), rel=1e-4
            )


@pytest.mark.parametrize("aspect", [1.0, 3.0])
def test_hydraulic_gaps_of_channels_and_steps(aspect):
    channels = np.tile([[1.0], [2.0], [3.0], [0.0]], 6)
    assert flow.hydraulic_gap(channels, aspect) == pytest.approx(9 ** (1 / 3))  # mean of 1, 8, 27, 0
    assert flow.hydraulic_gap(channels.T, aspect) == 0
    harmonic = 3 / (1 + 1 / 8 + 1 / 27)
    assert flow.hydraulic_gap(channels[:3].T, aspect) == pytest.approx(harmonic ** (1 / 3))
    diagonal = np.eye(5)  # corners do not conduct, and neither does a lake
    assert flow.hydraulic_gap(diagonal, aspect) == 0
    assert flow.hydraulic_gap(np.full((401, 150), 2.0), aspect) == pytest.approx(2)


def test_the_hydraulic_gap_of_a_large_scan_is_that_of_its_pixels(monkeypatch):
    scan = surface(rough(sites=256, roll_off=64.0, cutoff=8.0))
    for contact in asp.press(scan, ELASTIC, pressure=[10e6, 30e6]):
        coarse = flow.hydraulic_gap(contact.gap, 1.0)
        with monkeypatch.context() as patch:
            patch.setattr(flow, "_MOST", contact.gap.size)
            assert coarse == pytest.approx(flow.hydraulic_gap(contact.gap, 1.0), rel=0.05)


def test_bands_are_those_of_tiles_left_out_one_by_one():
    pressures = np.array([4e6, 5e6, 6e6])
    law = table(asp.law(ELASTIC, surface(ROUGH), pressures=pressures))
    contact: Any = asp.press(surface(ROUGH), ELASTIC, pressure=5e6)
    load = contact.force.reshape(4, 16, 4, 16).sum(axis=(1, 3)).ravel()
    tiles = load.sum() ** 2 / (load**2).sum()
    for name, field in (("contact_fraction", contact.in_contact), ("mean_gap", contact.gap)):
        slope = np.diff(np.log(law[name].values[[0, 2]])) / np.diff(np.log(pressures[[0, 2]]))
        squares = 0.0
        for row, column in np.ndindex(4, 4):
            others = np.ones((SITES, SITES), dtype=bool)
            others[16 * row : 16 * row + 16, 16 * column : 16 * column + 16] = False
            pressure = contact.pressure[others].mean() / contact.pressure.mean()
            without = np.log(field[others].mean() / field.mean()) - slope * np.log(pressure)
            squares += float(without[0]) ** 2
        error = student(tiles - 1).ppf(0.975) * math.sqrt(15 / 16 * squares)
        ends = [float(law[f"{name}_{end}"][1] / law[name][1]) for end in ("low", "high")]
        assert np.log(ends) == pytest.approx([-error, error], rel=0.02)
    # None of stiffness where much touches; only that of the approach where one tile bears the load.
    assert np.isnan(table(asp.law(ELASTIC, surface(ROUGH), pressures=[5e6, 3e8, 3.1e8]))["stiffness_low"][-1])
    light = table(asp.law(ELASTIC, surface(ROUGH), pressures=[1e2, 1e3, 1e4]))
    assert np.isnan([light[f"{name}_low"][0] for name in ("contact_fraction", "mean_gap", "stiffness")]).all()
    assert light["approach_low"][-1] < light["approach"][-1] < light["approach_high"][-1]


def numbers(text):
    return np.array([float(word) for word in re.findall(r"-?\d[\d.]*(?:e[+-]\d+)?", text)])


def test_files_of_other_programs_read_back_equal_the_law(law, aged):
    found = table(law)
    rows = law_rows(asp.contact_law.law_for("calculix", law))
    expected = [np.append(0, found[name]) for name in ("pressure", "approach")]
    assert rows[0] == pytest.approx(np.transpose(expected), rel=1e-9)
    heat = np.append(0, found["thermal_conductance"])
    assert rows[2] == pytest.approx(np.transpose([heat, expected[0], 0 * heat]), rel=1e-9)
    functions = asp.contact_law.law_for("moose", law)
    stiffness = [expected[0], np.append(0, found["stiffness"])]
    for name, curve in (("pressure_of_approach", expected[::-1]), ("stiffness_of_pressure", stiffness)):
        x, y = curve_of(functions, name)
        assert (np.diff(x) > 0).all()
        assert [x, y] == [pytest.approx(values, rel=1e-9) for values in curve]
    scaled = law_rows(asp.contact_law.law_for("calculix", law, millimeters=True))
    assert scaled[0] == pytest.approx(rows[0] * [1e-6, 1e3], rel=1e-8)
    assert scaled[2] == pytest.approx(rows[2] * [1e-3, 1e-6, 1], rel=1e-8)
    assert max(len(word) for word in re.findall(r"[\d.e+-]+", asp.contact_law.law_for("calculix", law))) <= 20
    later = law_rows(asp.contact_law.law_for("calculix", aged, age="1 h", direction="unloading"))[0]
    assert later[1:, 1] == pytest.approx(table(aged, "unloading", 1)["approach"].values, rel=1e-9)
    assert 0 < later[0, 1] < later[1, 1]


def law_rows(text):
    """Rows of numbers below each keyword that has any."""
    parts = re.split(r"^\*.*\n", text, flags=re.MULTILINE)
    return [np.array([numbers(line) for line in part.splitlines()]) for part in parts if part.strip()]


def curve_of(text, name):
    """Abscissas and ordinates of a function for MOOSE."""
    found = re.search(rf"\[{name}\]\n.*PiecewiseLinear\n +x = '(.*)'\n +y = '(.*)'\n", text)
    return tuple(map(numbers, found.groups()))


def test_heat_of_a_current_comes_out_in_the_units_of_the_file(law):
    """0.2 V on 3 mm^2, in SI: Q = g V^2 A, in W; a file in mm has V, mm^2 and mW. K carry heat likewise."""
    current = law.assign(conductance=7e3 * law["stiffness"] / law["stiffness"].max())
    current["conductance"].attrs["units"] = "S/m^2"
    for name in ("conductance", "thermal_conductance"):
        watts = table(current)[name].values * 0.2 ** (2 if name == "conductance" else 1) * 3e-6
        for millimeters, area, power in ((False, 3e-6, 1.0), (True, 3.0, 1e3)):
            text = asp.contact_law.law_for("moose", current, millimeters=millimeters)
            _, written = curve_of(text, f"{name}_of_pressure")
            heat = written[1:] * 0.2 ** (2 if name == "conductance" else 1) * area
            assert heat == pytest.approx(watts * power, rel=1e-9)
    for name in ("stiffness", "tangential_stiffness"):  # pressure over length, whatever the units
        if name in law:
            factor = asp.contact_law.law_for("moose", law, millimeters=True)
            assert curve_of(factor, f"{name}_of_pressure")[1][1:] == pytest.approx(table(law)[name] * 1e-9)


@pytest.mark.parametrize("millimeters", [False, True])
def test_tables_of_other_programs_rise(law, millimeters):
    def beside(share):  # the second pressure, and its approach, a share above the first
        near = law.isel(pressure=[0, 1]).copy(deep=True)
        for name in ("pressure", "approach"):
            values = near[name].values.copy()
            values[..., 1] = values[..., 0] * (1 + share)
            near[name] = (near[name].dims, values, near[name].attrs)
        return near

    moose = asp.contact_law.law_for("moose", beside(1e-10), millimeters=millimeters)
    calculix = law_rows(asp.contact_law.law_for("calculix", beside(1e-10), millimeters=millimeters))[0]
    for x in (*curve_of(moose, "pressure_of_approach"), *calculix.T):
        assert x[2] / x[1] - 1 == pytest.approx(1e-10, rel=1e-2)
    for share in (1e-15, 0.0):
        for program in ("moose", "calculix"):
            with refuses("pressures", "closer ones"):
                asp.contact_law.law_for(program, beside(share), millimeters=millimeters)
    folded = law.assign(approach=-law["approach"])
    with refuses("pressures", "closer ones"):
        asp.contact_law.law_for("moose", folded, millimeters=millimeters)


def test_formulas_of_joints_are_found_in_laws_that_are_such(law):
    p = law["pressure"].values
    for formula, first, second, approach in (
        ("Barton-Bandis", 2e12, 3e-6, p / (2e12 + p / 3e-6)),
        ("power", 4e-7, 0.3, 4e-7 * (p / 1e6) ** 0.3),
    ):
        fits = asp.contact_law.closure_fits(law.assign(approach=law["approach"] * 0 + approach))
        assert fits.loc[formula].values == pytest.approx([first, second, 0, 0], rel=1e-5, abs=1e-5)
    assert 0.005 < asp.contact_law.closure_fits(law)["rms"].min() < 0.1


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_calculix_computes_the_law_between_two_blocks(law, tmp_path):
    """Two cubes of 1 mm, all but rigid, the upper one moved down, then heated."""
    found = table(law)
    (tmp_path / "law.inp").write_text(asp.contact_law.law_for("calculix", law, millimeters=True))
    for approach in np.interp([0.3, 0.62, 0.97], [0, 1], found["approach"].values[[0, -1]]):
        pressure = np.interp(approach, found["approach"], found["pressure"])
        force, _ = blocks(tmp_path, "ROUGH", "NODE TO SURFACE", approach * 1e3)
        assert force == pytest.approx(pressure * 1e-6, rel=1e-4)
    chord = found["approach"].values[-1] * 1e3
    force, flow = blocks(tmp_path, "ROUGH_HEAT", "SURFACE TO SURFACE", 0.6 * chord, hot=1.0)
    assert force == pytest.approx(0.6 * found["pressure"].values[-1] * 1e-6, rel=1e-4)
    expected = np.interp(force * 1e6, found["pressure"], found["thermal_conductance"]) * 1e-3
    assert flow == pytest.approx(expected, rel=1e-4)


def blocks(folder, interaction, kind, approach, hot=0.0):
    """Force on the lower block, N, and flow of heat into it; the upper one is moved by an approach, mm."""
    corners = [(x, y, z) for z in (0, 1, 1, 2) for y in (0, 1) for x in (0, 1)]
    first, second = (", ".join(str(start + n) for n in (1, 2, 4, 3, 5, 6, 8, 7)) for start in (0, 8))
    nodes = "\n".join(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in enumerate(corners, 1))
    heat = "BOTTOM, 11, 11, 0\nTOP, 11, 11, 1\n*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY\nRFL" if hot else "**"
    (folder / "blocks.inp").write_text(f"""*NODE, NSET=ALL
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=BOTH
1, {first}
2, {second}
*NSET, NSET=BOTTOM
1, 2, 3, 4
*NSET, NSET=TOP
13, 14, 15, 16
*MATERIAL, NAME=STIFF
*ELASTIC
1e12, 0
*CONDUCTIVITY
1e9
*SOLID SECTION, ELSET=BOTH, MATERIAL=STIFF
*SURFACE, NAME=LOWER
1, S2
*SURFACE, NAME=UPPER
2, S1
*INCLUDE, INPUT=law.inp
*CONTACT PAIR, INTERACTION={interaction}, TYPE={kind}
UPPER, LOWER
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0
*BOUNDARY
BOTTOM, 3, 3
ALL, 1, 2
*STEP, NLGEOM, INC=1000
{"*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE" if hot else "*STATIC"}
0.1, 1, 1e-5, 0.2
*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY
RF
*BOUNDARY
TOP, 3, 3, {-approach:.10g}
{heat}
*END STEP
""")
    subprocess.run(["ccx", "-i", "blocks"], cwd=folder, check=True, capture_output=True, timeout=60)
    said = (folder / "blocks.dat").read_text()
    force = numbers(re.findall(r"total force.*\n\s*\n(.*)", said)[-1].replace("E", "e"))[2]
    flow = re.findall(r"heat generation.*\n\s*\n(.*)", said)
    return force, abs(numbers(flow[-1].replace("E", "e"))[0]) if hot else 0.0


def test_a_checkpoint_keeps_the_pressures_that_are_done(tmp_path, law, monkeypatch):
    module: Any = asp.contact_law.laws
    pressed, done = module.pressed, []

    def interrupted(*given, **held):
        done.append(held["pressure"])
        if len(done) == 3:
            raise KeyboardInterrupt
        return pressed(*given, **held)

    heights = rough(sites=24)
    asked: dict[str, Any] = {"pressures": [1e6, 2e6, 4e6, 8e6], "times": [0.0, 60.0]}
    how = asked | {"checkpoint": tmp_path / "place"}
    monkeypatch.setattr(module, "pressed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        asp.law(RELAXING, surface(heights), **how)
    resumed = asp.law(RELAXING, surface(heights), **how)
    assert done == [8e6, 4e6, 2e6, 2e6, 1e6]
    assert resumed.identical(asp.law(RELAXING, surface(heights), **asked))
    # Another surface; and a size of the pixels that looks the same when it is written.
    wider = asp.surfaces.Surface(heights, "m", (PIXEL, PIXEL * (1 + 1e-9)), "m")
    for scan in (surface(rough(4, sites=24)), wider):
        with refuses("checkpoint", "of another computation", kind=CheckpointError):
            asp.law(RELAXING, scan, **how)


@pytest.mark.parametrize(
    ("changed", "name", "got"),
    [
        ({"pressures": ["2 MPa", "1 MPa"]}, "pressures", "2 MPa"),
        ({"pressures": [1e6, 1e6, 2e6]}, "pressures", "1000000"),
        ({"pressures": [1e6]}, "pressures", "1000000"),
        ({"pressures": [0.0, 1e6]}, "pressures", "0.0"),
        ({"pressures": ["1 MPa", "100 GPa"]}, "pressures", "100 GPa: all of it touches"),
        ({"solid": asp.solids.spring_lattice(k0=1.0, k1=3.0)}, "solid", "defined on sites"),
        ({"solid": RELAXING}, "times", "none"),
        ({"times": [1.0, 0.5]}, "times", "0.5"),
        ({"times": []}, "times", "(0,)"),
        ({"solid": ELASTIC.with_hardness("5 MPa")}, "pressures", "20 MPa"),
        ({"carried": asp.Carried(shear=1e-3, friction_coefficient=0.3)}, "shear", "0.001"),
        ({"carried": asp.Carried(work_of_adhesion=0.05)}, "work_of_adhesion", "0.05"),
        ({"surface": asp.surfaces.Surface(ROUGH[0], "m", (PIXEL,), "m")}, "surface", "a profile"),
        ({"per_decade": 0}, "per_decade", "0"),
    ],
)
def test_what_is_wrong_is_refused(changed, name, got):
    asked = {"solid": ELASTIC, "surface": surface(ROUGH), "pressures": RANGE} | changed
    with refuses(name, got):
        asp.law(asked.pop("solid"), asked.pop("surface"), **asked)


def test_files_need_an_age_of_the_law(aged, law):
    law_for, many = asp.contact_law.law_for, law.interp(pressure=np.geomspace(1e6, 1e7, 200))
    each_refuses(
        ("age", "none", law_for, "calculix", aged),
        ("age", "2 h", lambda: law_for("calculix", aged, age="2 h")),
        ("direction", "unloading", lambda: law_for("moose", law, direction="unloading")),
        ("pressures", "200", law_for, "calculix", many),
    )
