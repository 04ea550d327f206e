"""``asperity run``: what it writes, on springs and in SI, and that it can be run again."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity import age, observe, press, relax, results
from asperity.analysis import contact_maps
from asperity.app.cli import main
from asperity.base.readable import written
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import array, gaussian, read, spectral
from tests.cli.conftest import SMALL, remarks, rows_of, told

BRIEF = ("--times", "1", "--maps-at", "", "--quiet")
"""One time, no map, no word."""


def test_all_files_are_there_and_the_history_is_that_of_the_verbs(finished):
    names = (
        "aging.csv aging.png aging_data.csv asperity.json config.toml contacts.csv contacts.png history.zarr"
    )
    names += " patches.csv patches.png patches_data.csv summary.txt"
    assert sorted(p.name for p in finished.iterdir()) == names.split()
    assert list(finished.parent.iterdir()) == [finished]
    dataset = results.load(finished / "history.zarr")
    assert dataset.identical(results.load(finished))
    contact = press(gaussian((32, 32), seed=7), spring_lattice(k0=1.0, k1=3.0), load=20.5)
    times = np.geomspace(1e-3, 10.0, 9)
    history = age(contact, times, rtol=2e-3, fields_at=dataset["field_time"].values.tolist())
    np.testing.assert_array_equal(dataset["area"], history.dataset["area"])
    np.testing.assert_array_equal(dataset["in_contact"], history.dataset["in_contact"])
    limit = relax(contact)
    assert dataset.attrs["relaxed_area"] == limit.area
    np.testing.assert_array_equal(dataset["in_contact_relaxed"], limit.in_contact)
    assert json.loads(dataset.attrs["surface"])["seed"] == 7
    assert dataset.attrs["config"] == (finished / "config.toml").read_text()
    assert dataset["field_time"].values[0] == 0
    assert dataset["field_time"].size == 6


def test_the_tables_hold_the_history_and_a_row_a_map(finished):
    dataset = results.load(finished)

    def column(rows, name):
        return [float(row[name]) for row in rows]

    rows = rows_of(finished / "aging.csv")
    names = "time area area_ratio load separation energy approach contact_fraction residual rms_gap"
    assert list(rows[0]) == names.split()
    for name in set(names.split()) - {"area_ratio"}:
        np.testing.assert_array_equal(column(rows, name), dataset[name])
    np.testing.assert_array_equal(column(rows, "area_ratio"), dataset["area"] / dataset["area"][0])
    maps = rows_of(finished / "patches.csv")
    np.testing.assert_array_equal(column(maps, "time"), dataset["field_time"])
    for name in ("patches", "perimeter", "births", "gained_by_expansion", "mean_contact_age"):
        np.testing.assert_array_equal(column(maps, name), dataset[name])
    for name in ("contact_age", "contact_pressure"):
        for share in (0.05, 0.5, 1.0):
            there = column(maps, f"{name}_{100 * share:g}_percent")
            np.testing.assert_array_equal(there, dataset[name].sel(quantile=share))


def test_a_run_repeated_from_its_own_configuration_is_identical(finished, tmp_path, asperity):
    out = tmp_path / "again"
    assert asperity("run", finished / "config.toml", "--quiet", "--out", out) == (0, "", "")
    first, again = (results.load(folder / "history.zarr") for folder in (finished, out))
    assert first.identical(again)
    assert (out / "config.toml").read_text() == (finished / "config.toml").read_text()
    assert (out / "aging.csv").read_bytes() == (finished / "aging.csv").read_bytes()


def test_the_summary_says_what_was_found(tmp_path, asperity):
    out = tmp_path / "new" / "out"
    status, text, progress = asperity("run", *SMALL, "--out", out)
    dataset = results.load(out / "history.zarr")
    initial, last = int(dataset["area"][0]), int(dataset["area"][-1])
    assert status == 0
    relaxed = dataset.attrs["relaxed_area"]
    for said in (
        *(f"{initial} of 1024 sites = {100 * initial / 1024:.4g} %", f"{last} of 1024 sites", str(out)),
        *(f"{relaxed} of 1024 sites", f"{int(dataset['steps'].sum())} time steps"),
    ):
        assert said in text
    assert re.search(rf"^  a +{relaxed / initial:.5g}, A\(relaxed\)/A\(0\), exact$", text, re.MULTILINE)
    assert text.startswith((out / "summary.txt").read_text())
    # Not a terminal: plain lines, one a decade, and the start.
    reached = [line.split()[2] for line in progress.splitlines() if line.startswith("  t = ")]
    assert reached == ["0", "0.001", "0.01", "0.1", "1", "10"]
    assert "\x1b" not in progress + text


def test_held_separation_and_chosen_maps_and_formats(tmp_path, says):
    out = tmp_path / "out"
    words = "--shape 16,16 --separation 1.5 --maps-at 0 0.5 --figures svg --times 0.1 1"
    text = says("run", *words.split(), "--out", out)
    assert "separation 1.5" in text
    assert "no fit: " in text
    dataset = results.load(out / "history.zarr")
    np.testing.assert_allclose(dataset["separation"], 1.5)
    loads = dataset["load"].values
    assert f"load at t = 1     {loads[-1]:.8g}, load/load(0) = {loads[-1] / loads[0]:.4g}\n" in text
    assert f"load relaxed      {dataset.attrs['relaxed_load']:.8g}, load/load(0)" in text
    assert dataset["field_time"].values.tolist() == [0.0, 0.5]
    assert dataset["time"].values.tolist() == [0.0, 0.1, 1.0]
    assert [path.name for path in out.glob("aging.*g")] == ["aging.svg"]


def test_an_instrument_looks_at_the_maps(finished, tmp_path, says):
    instrument = "--seed 7 --pixel 4 --blur 2.5 --threshold 0.05"
    text = says("run", *SMALL, *instrument.split(), "--out", tmp_path / "out")
    dataset, usual = results.load(tmp_path / "out"), results.load(finished)
    maps = (usual.isel(field_time=number) for number in range(6))
    seen = [observe(one, pixel=4.0, blur=2.5, threshold=0.05).area for one in maps]
    assert dataset["area_observed"].values.tolist() == seen
    assert dataset["area_observed"].attrs["units"] == "sites"
    assert max(seen) > 0
    assert re.search(rf"observed at t = 10 +{seen[-1]:g}\n", text)
    assert dataset["u"].identical(usual["u"])


def test_a_measured_surface(tmp_path, asperity):
    np.save("rough.npy", gaussian((24, 20), seed=4))
    Path("run.toml").write_text("[surface]\npath = 'rough.npy'\nperiodic = 'wrap'\ntilt = 'none'")
    assert asperity("run", "run.toml", *BRIEF, "--out", "out")[0] == 0
    dataset = results.load("out/history.zarr")
    surface = read("rough.npy", periodic="wrap", tilt="none")
    np.testing.assert_array_equal(dataset["heights"], surface.heights)
    assert json.loads(dataset.attrs["surface"])["sha256"] == surface.provenance["sha256"]
    # The written configuration finds the file from anywhere.
    assert f'path = "{tmp_path / "rough.npy"}"' in Path("out/config.toml").read_text()
    words = ("--crop", "0", "6", "1", "9", "--crop-unit", "um", "--pixel-size", "0.5", "--length-unit", "um")
    assert asperity("run", "--file", "rough.npy", *words, *BRIEF, "--out", "part")[0] == 0
    prepared = "12 x 16 sites (undefined = fill, tilt = plane, lines = none, periodic = reflect, crop = 0 6"
    assert prepared in Path("part/summary.txt").read_text()
    assert json.loads(results.load("part").attrs["surface"])["crop"] == [0, 12, 2, 18]


def test_results_are_replaced_only_where_overwriting_is_asked_for(asperity):
    words = ("run", "--shape", "8,8", *BRIEF, "--figures", "", "--out", "out")
    Path("out").mkdir()
    assert asperity(*words) == (0, "", "")  # an empty folder is as good as none
    names = "aging.csv asperity.json config.toml history.zarr summary.txt"
    assert sorted(path.name for path in Path("out").iterdir()) == names.split()
    for more, status, k1 in (((), 2, 3.0), (("--overwrite",), 0, 4.0)):
        assert asperity(*words, "--k1", "4", *more)[0] == status
        assert f"k1 = {k1}" in Path("out/config.toml").read_text()
    assert list(Path().iterdir()) == [Path("out")]


MANY = " ".join(f"{n / 100:g}" for n in range(100))
RAMP = "--shape 8,8 --leg 'ramp 2 load=30' --leg 'hold 4'"
REMARKS = {
    "--load 3 --times 1 --shape 32": 1,
    "--load 3 --times 1 --shape 8 8": 0,
    "--separation 1 --times 1 --shape 16,16 --k0 0": 1,
    "--load 3 --times 1 --file ramp.npy --periodic wrap --tilt none": 1,
    "--load 3 --times 1 --file ramp.npy": 1,
    f"{RAMP} --load 0 --times 1 5": 1,
    f"{RAMP} --load 1 --times 1 5": 0,
    f"{RAMP} --load 0": 0,
    f"--load 3 --times 1 --shape 8,8 --maps-at {MANY} --figures png": 1,
}


def test_what_the_user_should_know_is_remarked(says):
    np.save("ramp.npy", np.arange(16.0) ** 2 / 100)
    for words, expected in REMARKS.items():
        quiet = () if "--maps-at" in words else ("--maps-at", "", "--figures", "")
        text = says("run", *shlex.split(words), *quiet, "--out", "out", "--overwrite")
        assert remarks(text) == expected, words


BRANCHES = [(0.3, 0.01), (0.3, 1.0), (0.2, 100.0)]
SOLID = ("--solid", "half_space", "--modulus", "3.8 GPa")
CREEPING = (*SOLID, "--branch", "0.3 10 ms", "--branch", "0.3 1", "--branch", "0.2 100 s")
UNITS = ("--file-unit", "um", "--pixel-size", "0.4", "0.8", "--length-unit", "um")
DECADES = ("--per-decade", "1", "--maps-at", "0", "1")


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    """A text file of heights in micrometers, of oblong pixels."""
    path = tmp_path_factory.mktemp("scan") / "scan.txt"
    heights = spectral((64, 64), rms_height=0.2, spacing=(0.4, 0.8), cutoff=6.0, seed=1)
    np.savetxt(path, heights, fmt="%.6e")
    return path


@pytest.fixture(scope="module")
def done(scan):
    """A finished run, not to be changed."""
    out = scan.parent / "out"
    words = ["run", "--file", str(scan), *UNITS, *CREEPING, "--periodic", "reflect", *DECADES]
    assert main([*words, "--pressure", "2 MPa", "--quiet", "--out", str(out)]) == 0
    return out


def test_a_run_is_what_python_gives_in_si(scan, done):
    data = results.load(done / "history.zarr")
    lengths: dict[str, Any] = {"file_unit": "um", "pixel_size": (0.4, 0.8), "length_unit": "um"}
    rough = read(scan, periodic="reflect", **lengths)
    contact = press(rough, half_space(modulus=3.8e9, branches=BRANCHES), pressure=2e6)
    assert data["time"].values[[0, 1, -1]] == pytest.approx([0, 1e-3, 1e3])
    alone = age(contact, data["time"].values[1:], fields_at=[0.0, 1.0]).dataset
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
    data = results.load(out / "history.zarr")
    places: dict[str, Any] = {"places": [("10 um", "12 um"), ("20 um", "30 um")], "heights": [0, "-10 nm"]}
    balls = array((32, 40), radii=["1 mm", "2 mm"], pixel_size="1 um", **places)
    contact = press(balls, half_space(modulus="3.8 GPa", branches=[(0.3, 1.0)]), load="2 mN")
    assert (data.attrs["edges"], data.attrs["surface_kind"]) == ("free", "array")
    assert data["separation"].values[0] == pytest.approx(contact.separation, rel=1e-9)
    assert data.attrs["surface_x"] == pytest.approx([12e-6, 30e-6])
    told("\n".join((out / "summary.txt").read_text().splitlines()[:1]))


def test_every_variable_names_its_unit(done):
    data = results.load(done / "history.zarr")
    expected = {
        "N": "load residual_scale",
        "m^2": "contact_area contact_area_corrected",
        "Pa": "mean_contact_pressure largest_pressure pressure contact_pressure",
        "m": "separation approach mean_gap rms_gap u u0 heights u_relaxed x y perimeter",
        "s": "time field_time contact_age mean_contact_age",
        "J": "energy",
        "sites": "area mean_patch_size median_patch_size largest_patch_size gained_by_births "
        "gained_by_coalescence gained_by_expansion lost_by_deaths lost_by_shrinkage",
    }
    found = {str(name): data[name].attrs["units"] for name in data.variables}
    units = {name: unit for unit, names in expected.items() for name in names.split()}
    assert {name: unit for name, unit in found.items() if unit != "1"} == units
    np.testing.assert_allclose(data["y"], 0.4e-6 * np.arange(64), rtol=1e-12)
    np.testing.assert_allclose(data["x"], 0.8e-6 * np.arange(64), rtol=1e-12)
    assert data["u0"].dims == ("field_time", "branch", "y", "x")
    np.testing.assert_allclose(data["pressure"].mean(("y", "x")), 2e6, rtol=1e-8)
    assert (data.attrs["solid"], data.attrs["si"], data.attrs["edges"]) == ("half_space", 1, "reflecting")
    assert json.loads(data.attrs["branches"]) == [list(branch) for branch in BRANCHES]
    np.testing.assert_allclose(json.loads(data.attrs["spacing"]), [0.4e-6, 0.8e-6])


def test_table_summary_and_maps_are_in_si(done):
    first, *_ = rows_of(done / "aging.csv")
    data = results.load(done / "history.zarr")
    area = float(data["contact_area"][0])
    assert list(first)[:6] == ["time_s", "area_sites", "area_ratio", "load_N", "separation_m", "energy_J"]
    assert float(first["contact_area_m2"]) == area
    summary = (done / "summary.txt").read_text()
    assert f"{written(area, 'm^2')}: {int(data['area'][0])} of 4096 sites" in summary
    assert "modulus = 3.8 GPa, relaxing: 0.3 in 10 ms, 0.3 in 1 s, 0.2 in 100 s" in summary
    maps = contact_maps(data)
    assert (maps.unit, maps.aspect, maps.time_unit) == ("nm", 0.5, "s")
    np.testing.assert_allclose(maps.heights, 1e9 * data["heights"])
    bar = maps.scale_bar(64)
    assert bar is not None
    assert bar[:2] == pytest.approx((25.0, 20.0))
    assert bar[2] == "um"


def test_the_summary_says_what_yielded(scan, tmp_path):
    words = ["--hardness", "0.2 GPa", "--pressure", "8 MPa", "--first", "1", "--last", "10", *DECADES]
    out = tmp_path / "out"
    assert main(["run", "--file", str(scan), *UNITS, *SOLID, *words, "--quiet", "--out", str(out)]) == 0
    data = results.load(out)
    lower, yielding = data["permanent_indentation"].values[-1], data["yielding_area"].values
    assert yielding[0] > 1
    sites = f"{yielding[0]} sites at t = 0, {yielding[-1]} at the end"
    said = f"{sites}; lowered for good: {(lower > 0).sum()} sites"
    assert f"{said}, by up to {written(lower.max(), 'm')}" in (out / "summary.txt").read_text()


NO_UNIT = {
    "--thickness 3 --pressure 1MPa": 1,
    "--thickness 3um --pressure 1MPa --hardness 1e11": 1,
    "--thickness 3um --pressure 1MPa --shear-strength 60": 1,
    "--thickness 3um --pressure 1MPa --shear-strength 60MPa": 0,
    "--thickness 3um --pressure 1e6": 0,
}


def test_a_number_without_a_unit_that_is_odd_in_si_gets_a_remark(asperity):
    layer = "--solid layer --modulus 3GPa --poisson 0.3 --branch '0.3 1' --times 1 --figures ''"
    rough = "--surface spectral --shape 16 16 --spacing 0.5 --unit um --rms-height 0.1 --out out --overwrite"
    for line, expected in NO_UNIT.items():
        status, _, error = asperity("run", *shlex.split(f"{rough} {layer} {line}"))
        assert status == 0
        assert remarks(error, "remark: ") == expected


def test_a_file_may_stand_for_the_kind_of_surface(scan, tmp_path):
    for name, flag in (("file", "--file"), ("kind", "--surface")):
        words = [*UNITS, *SOLID, "--pressure", "1 MPa", *BRIEF, "--figures", ""]
        assert main(["run", flag, str(scan), *words, "--out", str(tmp_path / name)]) == 0
    assert (tmp_path / "kind/config.toml").read_text() == (tmp_path / "file/config.toml").read_text()
