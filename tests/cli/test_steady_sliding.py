"""``asperity sliding``: its files, its words, and the same numbers as in Python."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp

HEIGHTS = asp.surfaces.spectral((24, 32), spacing=50.0, hurst=0.8, rms_height=3.0, seed=3)
LENGTHS = ("--file-unit", "nm", "--pixel-size", "50", "--length-unit", "nm")
ASKED = ("--pressure", "1MPa", "--speeds", "1um/s", "1mm/s", "--per-decade", "1")
BRANCHES = [(0.4, 1e-4), (0.4, 1e-3)]


@pytest.fixture
def scan():
    np.savetxt("scan.txt", HEIGHTS)
    return "--surface", "scan.txt", *LENGTHS


@pytest.fixture
def table():
    frequency = np.geomspace(10.0, 1e6, 31)
    w = 1j * frequency
    modulus: Any = 30 * (0.2 + sum(g * w * t / (1 + w * t) for g, t in BRANCHES))
    rows = (f"{f:.8g},{m.real:.8g},{m.imag:.8g}" for f, m in zip(frequency, modulus, strict=True))
    Path("dma.csv").write_text("\n".join(["omega_rad/s,E_storage_MPa,E_loss_MPa", *rows]))
    return "dma.csv"


def test_a_table_of_moduli_gives_the_curve_of_its_branches(asperity, says, scan, table):
    more = ("--shear-strength", "2MPa", "--fields-at", "1um/s", "--beyond-table", "-q")
    says("sliding", table, *scan, *ASKED, *more)
    words = Path("sliding/summary.txt").read_text()
    for said in ("slowest", "largest friction", "with shear strength", "no flash temperature", "residual"):
        assert said in words
    found = asp.results.load("sliding")
    solid = asp.solids.half_space(young="30 MPa", branches=BRANCHES)
    surface = asp.surfaces.read("scan.txt", file_unit="nm", pixel_size=50.0, length_unit="nm")
    how: dict[str, Any] = {"speeds": ["1 um/s", "1 mm/s"], "per_decade": 1, "fields_at": ["1 um/s"]}
    right = asp.steady_sliding(solid, surface, pressure="1 MPa", shear_strength="2 MPa", **how)
    assert found.sizes == right.sizes == {"speed": 4, "field_speed": 1, "y": 24, "x": 32}
    friction = right["hysteresis_friction_coefficient"]
    assert float(friction.max() / friction.min()) > 2
    np.testing.assert_allclose(found["hysteresis_friction_coefficient"], friction, rtol=0.02)
    rows = list(csv.DictReader(Path("sliding/sliding.csv").read_text().splitlines()))
    for name in ("speed_m_per_s", "contact_area_m2", "largest_pressure_Pa", "friction_coefficient"):
        column = name.rsplit("_m_per_s")[0].removesuffix("_m2").removesuffix("_Pa")
        assert [float(row[name]) for row in rows] == pytest.approx(found[column].values.tolist(), rel=1e-14)
    written = {path.name for path in Path("sliding").iterdir()}
    assert written == {
        *("asperity.json", "config.toml", "history.zarr", "sliding.csv", "sliding.png"),
        *("sliding_data.csv", "summary.txt"),
    }
    assert json.loads(Path("sliding/asperity.json").read_text())["kind"] == "sliding"
    # The configuration that was written gives the same curve.
    status, *texts = asperity("sliding", "sliding/config.toml", "--out", "again", "--figures", "")
    assert status == 0
    assert "does not use" not in "".join(texts)
    again = asp.results.load("again")["hysteresis_friction_coefficient"]
    np.testing.assert_allclose(again, found["hysteresis_friction_coefficient"], rtol=1e-8)


def test_a_file_of_a_run_slides_a_lattice_of_springs(says):
    text = '[surface]\nkind = "gaussian"\nshape = [16, 16]\nrms = 1.0\nseed = 1\n[contact]\nload = 60.0\n'
    text += '[solid]\nkind = "spring_lattice"\nk0 = 1.0\nk1 = 3.0\n[friction]\nshear_strength = 0.5\n'
    Path("run.toml").write_text(f"{text}[sliding]\nspeeds = [0.1, 100.0]\nper_decade = 1\n")
    says("sliding", "run.toml", "--figures", "", "-q")
    found = asp.results.load("sliding")
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0)
    rough = asp.surfaces.gaussian((16, 16), rms=1.0, seed=1)
    how: dict[str, Any] = {"speeds": [0.1, 100.0], "per_decade": 1, "shear_strength": 0.5}
    right = asp.steady_sliding(solid, rough, load=60.0, **how)
    for name in right.data_vars:
        np.testing.assert_allclose(found[name], right[name], rtol=1e-8)
    added = right["friction_coefficient"] - right["hysteresis_friction_coefficient"]
    np.testing.assert_allclose(added, 0.5 * right["contact_area"] / 60)
    header = Path("sliding/sliding.csv").read_text().splitlines()[0]
    assert header.startswith("speed,hysteresis_friction_coefficient,friction_coefficient,contact_area,")
    words = Path("sliding/summary.txt").read_text()
    assert "Pa" not in words
    assert "finer scan" not in words


def test_a_thick_layer_of_a_table_slides_as_its_half_space(asperity, says):
    times, drift = np.geomspace(1e-3, 1e3, 37), 1 + 0.02 * (-1.0) ** np.arange(37)
    young = 1e6 * (1 + 2 * np.exp(-times / 0.1) + np.exp(-times / 10)) * drift
    np.savetxt("table.csv", np.c_[times, young], delimiter=",", header="time (s),E (Pa)", comments="")
    scan = 'kind = "spectral"\nshape = [32, 32]\nunit = "um"\npixel_size = 1.0\ncutoff = 4.0\n'
    rest = (
        'poisson = 0.45\nrelaxation = "table.csv"\nnoise = 0.05\n[contact]\npressure = "20 kPa"\n[sliding]\n'
    )
    found = []
    for kind in ("half_space", 'layer"\nthickness = "20 mm'):
        text = f'[surface]\n{scan}rms_slope = 0.2\nseed = 1\n[solid]\nkind = "{kind}"\n{rest}'
        Path("run.toml").write_text(f'{text}speeds = ["1 um/s", "0.1 mm/s"]\nper_decade = 1\n')
        says("sliding", "run.toml", "--figures", "", "--overwrite", "-q")
        found.append(asp.results.load("sliding"))
        Path("run.toml").write_text(f'{text}speeds = ["1 pm/s", "1 um/s"]\n')
        status, _, err = asperity("sliding", "run.toml", "--out", "beyond")
        assert status == 2
        assert "speeds whose frequencies the table has, 5.093 nm/s" in err
    half_space, layer = found
    for name in ("hysteresis_friction_coefficient", "contact_fraction_low", "contact_fraction_high"):
        np.testing.assert_allclose(layer[name], half_space[name], rtol=1e-4)


def test_the_figure_shows_friction_and_area():
    surface = asp.surfaces.Surface(1e-9 * HEIGHTS, "m", (50e-9, 50e-9), "m")
    solid = asp.solids.half_space(young="30 MPa", branches=BRANCHES)
    answer = asp.steady_sliding(solid, surface, speeds=[1e-6, 1e-5, 1e-4], pressure=1e6)
    figure = asp.figures.steady_sliding_figure(answer)
    figure.suptitle("").set_in_layout(False)  # as in PDF and SVG: no label may need its room
    figure.draw_without_rendering()
    assert figure.get_tightbbox().y1 < figure.get_figheight()
    above, below = figure.axes
    drawn: Any = above.lines[0].get_ydata(), below.lines[0].get_ydata()
    np.testing.assert_allclose(drawn[0], answer["hysteresis_friction_coefficient"])
    np.testing.assert_allclose(drawn[1], 100 * answer["contact_fraction"])
    assert above.get_xscale() == below.get_xscale() == "log"
    with pytest.raises(asp.errors.InputError, match="steady sliding"):
        asp.figures.steady_sliding_figure(answer.assign_attrs(title="another"))
