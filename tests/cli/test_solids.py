"""Continua on the command line: a scan with units in, results in SI out, and what is refused."""

import csv
import json
import shlex

import numpy as np
import pytest

import asperity as asp
from asperity.analysis import contact_maps
from asperity.analysis.scan import written
from asperity.app.cli import main
from tests.cli.conftest import Asperity, told

BRANCHES = [(0.3, 0.01), (0.3, 1.0), (0.2, 100.0)]
SOLID = ("--solid", "half_space", "--modulus", "3.8 GPa")
CREEPING = (*SOLID, "--branch", "0.3 10 ms", "--branch", "0.3 1", "--branch", "0.2 100 s")
UNITS = ("--file-unit", "um", "--pixel-size", "0.4", "0.8", "--length-unit", "um")
BRIEF = ("--per-decade", "1", "--maps-at", "0", "1")


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    """A text file of heights in micrometers, of oblong pixels."""
    path = tmp_path_factory.mktemp("scan") / "scan.txt"
    heights = asp.surfaces.spectral((64, 64), rms_height=0.2, spacing=(0.4, 0.8), cutoff=6.0, seed=1)
    np.savetxt(path, heights, fmt="%.6e")
    return path


@pytest.fixture(scope="module")
def done(scan):
    """A finished run, not to be changed."""
    from asperity.app.cli import main

    out = scan.parent / "out"
    words = ["run", "--file", str(scan), *UNITS, *CREEPING, "--periodic", "reflect", *BRIEF]
    assert main([*words, "--pressure", "2 MPa", "--quiet", "--out", str(out)]) == 0
    return out


def surface_of(scan):
    return asp.surfaces.read(
        scan, periodic="reflect", file_unit="um", pixel_size=(0.4, 0.8), length_unit="um"
    )


def test_a_run_is_what_python_gives_in_si(scan, done):
    data = asp.results.load(done / "history.zarr")
    contact = asp.press(
        surface_of(scan), asp.solids.half_space(modulus=3.8e9, branches=BRANCHES), pressure=2e6
    )
    assert data["time"].values[[0, 1, -1]] == pytest.approx([0, 1e-3, 1e3])
    alone = asp.age(contact, data["time"].values[1:], fields_at=[0.0, 1.0]).dataset
    for name in alone.variables:
        np.testing.assert_array_equal(data[name], alone[name], err_msg=str(name))
        assert data[name].attrs == alone[name].attrs
    assert data.attrs["held_load"] == pytest.approx(2e6 * 64 * 64 * 0.4e-6 * 0.8e-6)
    assert float(data["contact_area"][0]) == contact.contact_area
    assert contact.contact_area == pytest.approx(contact.area * 0.4e-6 * 0.8e-6)
    assert float(data["contact_area_corrected"][0]) == contact.contact_area_corrected < contact.contact_area
    assert float(data["largest_pressure"][0]) == contact.largest_pressure


def test_a_run_of_balls_is_what_python_gives(tmp_path):
    out = tmp_path / "balls"
    words = shlex.split(
        "run --surface array --shape 32x40 --place '10um 12um' --place '2e-5 3e-5' --radii 1mm 2mm "
        "--heights=0 --heights=-10nm --pixel-size 1um --load 2mN --times 1 --quiet"
    )
    assert main([*words, *SOLID, "--branch", "0.3 1", "--out", str(out)]) == 0
    data = asp.results.load(out / "history.zarr")
    balls = asp.surfaces.array(
        (32, 40),
        places=[("10 um", "12 um"), ("20 um", "30 um")],
        radii=["1 mm", "2 mm"],
        heights=[0, "-10 nm"],
        pixel_size="1 um",
    )
    contact = asp.press(balls, asp.solids.half_space(modulus="3.8 GPa", branches=[(0.3, 1.0)]), load="2 mN")
    assert (data.attrs["edges"], data.attrs["surface_kind"]) == ("free", "array")
    assert data["separation"].values[0] == pytest.approx(contact.separation, rel=1e-9)
    assert data.attrs["surface_x"] == pytest.approx([12e-6, 30e-6])
    told("\n".join((out / "summary.txt").read_text().splitlines()[:1]))


def test_every_variable_names_its_unit(done):
    data = asp.results.load(done / "history.zarr")
    units = {str(name): data[name].attrs["units"] for name in data.variables}
    expected = {
        **dict.fromkeys(("load", "residual_scale"), "N"),
        **dict.fromkeys(("contact_area", "contact_area_corrected"), "m^2"),
        **dict.fromkeys(("mean_contact_pressure", "largest_pressure", "pressure"), "Pa"),
        **dict.fromkeys(
            ("separation", "approach", "mean_gap", "rms_gap", "u", "u0", "heights", "u_relaxed"), "m"
        ),
        **dict.fromkeys(("x", "y"), "m"),
        **dict.fromkeys(("time", "field_time"), "s"),
        **dict.fromkeys(("contact_age", "mean_contact_age"), "s"),
        **{"energy": "J", "contact_pressure": "Pa", "perimeter": "m"},
        **dict.fromkeys(("area", "mean_patch_size", "median_patch_size", "largest_patch_size"), "sites"),
        **dict.fromkeys((f"gained_by_{how}" for how in ("births", "coalescence", "expansion")), "sites"),
        **dict.fromkeys(("lost_by_deaths", "lost_by_shrinkage"), "sites"),
    }
    assert {name: unit for name, unit in units.items() if unit != "1"} == expected
    np.testing.assert_allclose(data["y"], 0.4e-6 * np.arange(64), rtol=1e-12)
    np.testing.assert_allclose(data["x"], 0.8e-6 * np.arange(64), rtol=1e-12)
    assert data["u0"].dims == ("field_time", "branch", "y", "x")
    mean = data["pressure"].mean(("y", "x"))
    np.testing.assert_allclose(mean, 2e6, rtol=1e-8)
    assert (data.attrs["solid"], data.attrs["si"], data.attrs["edges"]) == ("half_space", 1, "reflecting")
    assert json.loads(data.attrs["branches"]) == [list(branch) for branch in BRANCHES]
    np.testing.assert_allclose(json.loads(data.attrs["spacing"]), [0.4e-6, 0.8e-6])


def test_table_summary_and_maps_are_in_si(done):
    with (done / "aging.csv").open() as stream:
        header, first, *_ = csv.reader(stream)
    data = asp.results.load(done / "history.zarr")
    assert header[:6] == ["time_s", "area_sites", "area_ratio", "load_N", "separation_m", "energy_J"]
    assert float(first[header.index("contact_area_m2")]) == float(data["contact_area"][0])
    summary = (done / "summary.txt").read_text()
    assert (
        f"{written(float(data['contact_area'][0]), 'm^2')}: {int(data['area'][0])} of 4096 sites" in summary
    )
    assert "modulus = 3.8 GPa, relaxing: 0.3 in 10 ms, 0.3 in 1 s, 0.2 in 100 s" in summary
    maps = contact_maps(data)
    assert (maps.unit, maps.aspect, maps.time_unit) == ("nm", 0.5, "s")
    np.testing.assert_allclose(maps.heights, 1e9 * data["heights"])
    bar = maps.scale_bar(64)
    assert bar is not None
    assert bar[:2] == pytest.approx((25.0, 20.0))
    assert bar[2] == "um"


def test_the_summary_says_what_yielded(scan, tmp_path):
    words = ["run", "--file", str(scan), *UNITS, *SOLID, "--hardness", "0.2 GPa", "--pressure", "4 MPa"]
    assert (
        main([*words, "--first", "1", "--last", "10", *BRIEF, "--quiet", "--out", str(tmp_path / "out")]) == 0
    )
    data = asp.results.load(tmp_path / "out" / "history.zarr")
    lower, yielding = data["permanent_indentation"].values[-1], data["yielding_area"].values
    assert yielding[0] > 1
    sites = f"{yielding[0]} sites at t = 0, {yielding[-1]} at the end"
    said = f"{sites}; lowered for good: {(lower > 0).sum()} sites"
    assert f"{said}, by up to {written(lower.max(), 'm')}" in (tmp_path / "out" / "summary.txt").read_text()


def test_a_layer_without_units_has_numbers_of_the_users_own(asperity: Asperity, tmp_path):
    words = ["--solid", "layer", "--modulus", "2", "--poisson", "0.3", "--thickness", "4"]
    words += ["--branch", "0.5 1"]
    out = tmp_path / "out"
    status, _, _ = asperity(
        "run", "--surface", "spectral", "--shape", "32", "32", *words, *BRIEF, "--out", out
    )
    assert status == 0
    data = asp.results.load(out / "history.zarr")
    assert data["largest_pressure"].attrs["units"] == "force unit / length unit^2"
    assert data["u0"].dims == ("field_time", "y", "x")
    assert 0.002 < float(data["contact_fraction"][0]) < 0.03
    header = (out / "aging.csv").read_text().splitlines()[0]
    assert header.startswith("time,area,area_ratio,load,separation,energy,")


ODD = """
    --thickness 3 --pressure 1MPa
    --thickness 3um --pressure 1
    --thickness 3um --load 1
    --thickness 3um --pressure 1MPa --hardness 1e11
    --thickness 3um --pressure 1MPa --shear-strength 60
"""
USUAL = """
    --thickness 3um --pressure 1MPa --shear-strength 60MPa
    --thickness 3um --pressure 1e6
    --thickness 3e-6 --pressure '1 MPa'
"""


def test_a_number_without_a_unit_that_is_odd_in_si_gets_a_remark(asperity: Asperity) -> None:
    layer = "--solid layer --modulus 3GPa --poisson 0.3 --branch '0.3 1'"
    rough = "--surface spectral --shape 16 16 --spacing 0.5 --unit um --rms-height 0.1"
    for line in (ODD + USUAL).split("\n"):
        if line.strip():
            call = f"{rough} {layer} {line} --times 1 --figures '' --out out --overwrite"
            status, _, error = asperity("run", *shlex.split(call))
            assert status == 0
            remarks = [said for said in error.splitlines() if "has no unit" in said]
            assert len(remarks) == (line in ODD.split("\n"))
            for remark in remarks:
                told(remark)
