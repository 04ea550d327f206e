"""``asperity law``: its files, its words, and the same numbers as in Python."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text

import asperity as asp
from asperity.contact_law.laws import OF_LAWS

HEIGHTS = asp.surfaces.spectral((40, 48), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
LENGTHS = ("--file-unit", "nm", "--pixel-size", "50", "--length-unit", "nm")
RANGE = ("--pressures", "1MPa", "20MPa", "--per-decade", "2")
FILES = {"asperity.json", "config.toml", "history.zarr", "law.csv", "law_data.csv", "law.png", "summary.txt"}


@pytest.fixture
def scan():
    np.savetxt("scan.txt", HEIGHTS)
    return "--surface", "scan.txt", *LENGTHS


def test_a_table_of_relaxation_gives_a_law_at_each_age(says, scan):
    time = np.geomspace(1.0, 1e4, 13)
    lines = (f"{t:.6g},{1000 + 1500 * np.exp(-t / 90):.8g}" for t in time)
    Path("relax.csv").write_text("\n".join(["time_s,E_MPa", *lines]))
    ages = ("--times", "0s", "1h", "--age", "1h", "--write", "calculix", "moose", "--millimeters")
    says("law", "relax.csv", *scan, *RANGE, *ages, "--conductivity", "0.2W/m/K", "-q")
    words = Path("law/summary.txt").read_text()
    for said in ("age 3600 s", "Barton-Bandis", "of the mean surface", "unloading", "do not interpolate"):
        assert said in words
    written = {path.name for path in Path("law").iterdir()}
    programs = {f"{kind}{name}" for name in ("calculix.inp", "moose.i") for kind in ("", "unloading_")}
    assert written == FILES | programs
    marker = json.loads(Path("law/asperity.json").read_text())
    assert marker["kind"] == "law"
    assert set(marker["files"]) | {"asperity.json"} == written
    dataset = asp.results.load("law")
    rows = list(csv.DictReader(Path("law/law.csv").read_text().splitlines()))
    assert len(rows) == dataset["approach"].size
    columns = {
        "time_s",
        "pressure_Pa",
        "approach_m",
        "approach_low_m",
        "stiffness_Pa_per_m",
        "contact_fraction",
    }
    assert columns | {"thermal_conductance_W_per_m2_per_K", "tangential_stiffness_Pa_per_m"} <= rows[0].keys()
    for name, column in (("approach", "approach_m"), ("stiffness_high", "stiffness_high_Pa_per_m")):
        found = [float(row[column] or "nan") for row in rows]
        assert found == pytest.approx(dataset[name].values.ravel().tolist(), rel=1e-14, nan_ok=True)
    text = asp.contact_law.law_for("moose", dataset, age="1 h", direction="unloading", millimeters=True)
    assert Path("law/unloading_moose.i").read_text() == text
    # One input may include loading and unloading, so no two interactions or functions share a name.
    texts = "".join(path.read_text() for path in Path("law").glob("*calculix.inp"))
    texts += "".join(path.read_text() for path in Path("law").glob("*moose.i"))
    names = re.findall(r"^\*SURFACE INTERACTION, NAME=(\w+)|^  \[(\w+)\]", texts, flags=re.MULTILINE)
    assert len(set(names)) == len(names) >= 8
    # The configuration that was written gives the same law.
    says("law", "law/config.toml", "--out", "again", "-q")
    again = asp.results.load("again")
    assert again["approach"].values == pytest.approx(dataset["approach"].values, rel=1e-6)


def test_a_solid_in_numbers_gives_what_python_gives(says, scan):
    flags = ("--young", "3GPa", "--poisson", "0.3", "--write", "calculix", "--figures", "")
    says("law", *scan, *RANGE, *flags, "-q")
    found = asp.results.load("law")
    pictures = {"law_data.csv", "law.png"}
    assert {path.name for path in Path("law").iterdir()} == FILES - pictures | {"calculix.inp"}
    solid = asp.solids.half_space(young="3 GPa", poisson=0.3)
    surface = asp.surfaces.read(
        "scan.txt", file_unit="nm", pixel_size=50.0, length_unit="nm", periodic="reflect"
    )
    law = asp.law(
        solid, surface, pressures=["1 MPa", "20 MPa"], per_decade=2, carried=asp.Carried(poisson=0.3)
    )
    for name in OF_LAWS.keys() & law.keys():
        assert found[name].values == pytest.approx(law[name].values, rel=1e-9), name
    assert found["stiffness"].attrs["units"] == "Pa/m"


def test_columns_and_summary_say_the_direction_of_shear(says, scan):
    flags = *RANGE, "--young", "3GPa", "--poisson", "0.3", "--figures", "", "-q"
    for direction, column in ((), "softest_direction_deg"), (("y",), "tangential_stiffness_y_Pa_per_m"):
        says("law", *scan, *flags, *(("--shear-direction", *direction) * len(direction)), "--out", column)
        (head, *_), summary = (
            Path(column, name).read_text().splitlines() for name in ("law.csv", "summary.txt")
        )
        assert column in head.split(",")
        assert ("tangential_stiffness_Pa_per_m" in head.split(",")) == (not direction)
        assert any("degrees from x towards y" in line for line in summary) == (not direction)


def test_the_figure_has_a_curve_for_each_age_and_direction():
    surface = asp.surfaces.Surface(1e-9 * HEIGHTS, "m", (50e-9, 50e-9), "m")
    solid = asp.solids.half_space(modulus="3 GPa", branches=[(0.4, 10.0)])
    law = asp.law(solid, surface, pressures=[1e6, 4e6, 16e6], times=[0.0, 60.0])
    figure = asp.figures.law_figure(law)
    axes = figure.axes
    assert figure.get_figwidth() == asp.figures.style.COLUMN
    assert {text.get_fontsize() for text in figure.findobj(Text)} <= {7.0, 8.0}
    assert [len(one.lines) for one in axes] == [4, 4, 4]
    drawn = axes[0].lines[1].get_ydata() / law["approach"].sel(direction="loading", time=60.0).values
    assert drawn == pytest.approx(drawn[0])


def test_what_a_law_does_not_use_is_remarked(asperity, scan):
    solid = '[solid]\nkind = "half_space"\nmodulus = 3e9\nbranches = [[0.3, 1.0]]\n'
    solid += "draws = [[[0.3, 1.0]], [[0.2, 1.0]]]\n"
    Path("run.toml").write_text(
        f'{solid}[contact]\npressure = 1e6\n[aging]\nhold = "load"\ntimes = [0.0]\n[friction]\n'
        'shear_strength = 1e7\n[output]\npixel = "0.1 um"\nfigures = []\n'
    )
    unused = "the law does not use [solid] draws, [contact] pressure, [aging] hold, "
    unused += "[friction] shear_strength, [output] pixel"
    assert asperity("law", "run.toml", *scan, *RANGE, "-q") == (0, "", "")
    assert f"  {unused}\n" in Path("law/summary.txt").read_text()
    # What was written has no key that a law ignores.
    assert asperity("law", "law/config.toml", "--out", "again", "-q") == (0, "", "")
    assert "not use" not in Path("again/summary.txt").read_text()
