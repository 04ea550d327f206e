"""95 % bands of ``asperity predict``: in every file, for histories of the load, against other ways."""

import csv
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.analysis.bands import banded, draws_of_solid
from asperity.app.explore.folders import open_entry
from asperity.base.readable import written
from asperity.relaxation import PronySeries
from tests.refusals import refuses

P: Any = asp.protocols
UNITS: dict[str, Any] = {"unit": "um", "pixel_size": (0.2, 0.2), "length_unit": "um"}
READ = ("--file-unit", "um", "--pixel-size", "0.2", "--length-unit", "um")
PMMA = ((0.102, 8.93), (0.106, 118.0))
LEGS = ("ramp 2.4s pressure=6MPa", "hold 1000s", "step pressure=1.5MPa", "hold 4000s")
WORDS = tuple(word for leg in LEGS for word in ("--leg", leg))
CARRIED = ("--resistivity", "1 uohm m", "--shear", "20 uN", "--friction-coefficient", "0.4")


def rough(sites=32, seed=3):
    how: dict[str, Any] = {"hurst": 0.8, "roll_off": 1.6, "cutoff": 0.8, "rms_height": 0.05, "spacing": 0.2}
    heights = asp.surfaces.spectral((sites, sites), **how, seed=seed)
    return asp.surfaces.Surface(heights, edges="reflecting", **UNITS)


def legs():
    drop = P.Step(pressure=1.5e6)
    return [P.Ramp("2.4 s", pressure="6 MPa"), P.Hold("1000 s"), drop, P.Hold("4000 s")]


@pytest.mark.parametrize("words", [WORDS, pytest.param(("--load", "1 mN"), marks=pytest.mark.slow)])
def test_a_band_of_few_tiles_is_said_to_be_unknown(asperity, words):
    x = np.arange(32) - 11.5
    np.savetxt("scan.txt", -0.01 * (x**2 + x[:, None] ** 2))  # one summit in one tile
    times = np.geomspace(0.1, 1e4, 20)
    rows = "".join(
        f"{t},{E}\n" for t, E in zip(times, PronySeries(1805.0, PMMA).modulus_at(times), strict=True)
    )
    Path("pmma.csv").write_text(f"time [s],modulus [MPa]\n{rows}")
    flags = (*READ, "--tilt", "none", "--poisson", "0.38", "--shear-strength", "50MPa")
    status, said, errors = asperity(
        "predict", "pmma.csv", "--surface", "scan.txt", *flags, *words, "--figures", "svg", "--out", "few"
    )
    assert status == 0, errors
    assert not [path for path in Path("few").glob("*.svg") if "95 % band" in path.read_text(encoding="utf-8")]
    page = re.sub("<[^>]*>", " ", Path("few/prediction.html").read_text(encoding="utf-8"))
    for text in (said, Path("few/summary.txt").read_text(encoding="utf-8"), page):
        assert "nan" not in re.findall("[a-z]+", text)
        assert "unknown: too few patches" in text


@pytest.mark.slow
def test_the_bands_of_a_ramp_a_hold_a_drop_and_a_hold_from_one_command(asperity):
    time, random = np.geomspace(0.01, 120.0, 30), np.random.default_rng(1)  # minutes
    modulus = PronySeries(1805.0, PMMA).modulus_at(60 * time) * (1 + 0.005 * random.standard_normal(30))
    lines = (f"{t:.5g};{E:.5g}".replace(".", ",") for t, E in zip(time, modulus, strict=True))
    Path("pmma.csv").write_text("\n".join(["Zeit (min);Relaxationsmodul E(t) / MPa", *lines]) + "\n")
    np.savetxt("scan.txt", rough(48).heights)
    call = (
        "predict",
        "pmma.csv",
        "--surface",
        "scan.txt",
        *READ,
        "--tilt",
        "none",
        "--poisson",
        "0.38",
        *WORDS,
    )
    call = (*call, *CARRIED, "--shear-strength", "50MPa", "--per-decade", "2", "-q")
    assert asperity(*call)[:2] == (0, "")  # it remarks that the bodies slide as long as the load is small
    with Path("prediction/history.csv").open() as file:
        table = {name: np.array(column, dtype=float) for name, *column in zip(*csv.reader(file), strict=True)}
    stored = asp.results.load("prediction")
    names = ("contact_area", "resistance", "normal_stiffness", "stick_fraction", "friction")
    for name in names:
        unit = stored[name].attrs["units"]
        value, low, high = (table[f"{name}{end} [{unit}]"] for end in ("", "_low", "_high"))
        known = np.isfinite(low)
        assert known[table["time [s]"] > 2.3].all()
        assert ((low < value) & (value < high))[known & (value > 0)].all()
        np.testing.assert_array_equal(stored[f"{name}_low"][1:], low)
    nominal = 48**2 * (0.2e-6) ** 2
    assert table["load [N]"].max() == pytest.approx(6e6 * nominal, rel=1e-6)
    assert table["load [N]"][-1] == pytest.approx(1.5e6 * nominal, rel=1e-6)
    assert table["time [s]"][-1] == pytest.approx(5002.4)
    assert "effective_load [N]" not in table  # no elastic contact is this one
    # The page has the bands, too.
    recording = open_entry(Path(), "prediction").recording
    assert recording is not None
    assert recording.scene is not None
    assert {"resistance_low", "contact_area_high"} <= set(recording.scene["columns"])
    # In Python and from a file it is the same.
    material = asp.relaxation.material("pmma.csv", poisson=0.38)
    scan = asp.surfaces.read("scan.txt", file_unit="um", pixel_size=0.2, length_unit="um", tilt="none")
    same = asp.predict(material, scan, protocol=legs(), per_decade=2)
    np.testing.assert_allclose(same.series("contact_area_low"), table["contact_area_low [m^2]"], rtol=1e-12)
    assert repr(same).startswith("<Prediction: A(5002 s) = ")


def test_a_file_may_have_legs_and_a_leg_overrides_them(asperity, undrawn):
    np.savetxt("scan.txt", rough().heights)
    solid = '[solid]\nkind = "half_space"\nmodulus = "2.1 GPa"\nbranches = [[0.3, "8 s"]]\n'
    kinds = '[[protocol]]\nkind = "ramp"\nduration = "2 s"\npressure = "6 MPa"\n'
    kinds += '[[protocol]]\nkind = "hold"\nduration = 60\n'
    drop = '[[protocol]]\nkind = "step"\npressure = "3 MPa"\n[[protocol]]\nkind = "hold"\nduration = 10\n'
    Path("run.toml").write_text(f'{solid}[aging]\nfirst = "1 s"\n{kinds}{drop}')
    scan = ("--surface", "scan.txt", *READ, "--tilt", "none", "-q")
    for more in ((), ("--leg", "ramp 2s pressure=6MPa", "--leg", "hold 60s", "--leg", "hold 10s")):
        assert asperity("predict", "run.toml", *scan, *more) == (0, "", "")
    assert asperity("predict", "run.toml", *scan, "--pressure", "2 MPa") == (0, "", "")
    dropped, held, begun = undrawn
    assert dropped.legs.startswith("from 0 N, ramp to pressure 6 MPa in 2 s")
    assert begun.legs.startswith(f"from {written(2e6 * begun.nominal_area, 'N')}, ramp to")
    assert "step to pressure 3 MPa, hold for 10 s" in dropped.legs
    load = dropped.series("load")
    assert load[-1] == pytest.approx(load.max() / 2, rel=1e-6)
    assert held.effective_load is not None  # the load never falls
    np.testing.assert_allclose(held.series("contact_area")[:5], dropped.series("contact_area")[:5])


def test_bands_after_a_drop_are_those_of_every_draw_pressed_and_aged_anew():
    random, scan = np.random.default_rng(0), rough(64)
    shares, factors = random.uniform(0.1, 0.3, (6, 2)), np.exp(random.normal(0, 0.3, (6, 2)))
    draws = [tuple(zip(*one, strict=True)) for one in zip(shares, factors * (3.0, 40.0), strict=True)]
    series = [PronySeries(2.1e9, one) for one in (((0.2, 3.0), (0.2, 40.0)), *draws)]
    history = [P.Step(pressure="8 MPa"), P.Hold(100.0), P.Step(pressure="2 MPa"), P.Hold(400.0)]
    times, computed = [1.0, 10.0, 100.5, 110.0, 200.0], []

    def followed(solid, stage=""):
        computed.append(stage)
        contact = asp.press(scan, solid, load=0.0)
        return asp.age(contact, times, protocol=history, carried=asp.Carried(resistivity=1e-6)).dataset

    solids = [asp.solids.half_space(modulus=2.1e9, branches=one.branches) for one in series]
    exact = [followed(solid) for solid in solids]
    computed.clear()
    found = draws_of_solid(exact[0], series, solids[0], followed)
    assert len(computed) < len(draws)
    for name in ("contact_area_corrected", "resistance"):
        assert name in banded(exact[0])
        direct = np.log([one[name].values / exact[0][name].values for one in exact[1:]])[:, 2:]
        missed = np.log(found[name][:, 2:]) - direct
        assert np.std(direct) > 0.05
        assert np.sqrt(np.mean(missed**2)) < 0.2 * np.std(direct)


@pytest.mark.slow
def test_a_band_of_a_scan_is_the_spread_between_scans():
    """Areas of 24 surfaces scatter as each band has it, within what 24 of them tell."""
    solid = asp.solids.half_space(modulus="2.1 GPa")
    at_once: dict[str, Any] = {"pressure": "6 MPa", "first": 1.0, "last": 10.0, "per_decade": 4}
    found = [
        asp.predict(solid, rough(48, seed), **at_once, carried=asp.Carried(resistivity=1e-6))
        for seed in range(24)
    ]
    for name in ("contact_area_corrected", "resistance"):
        low, value, high = np.log(
            [[one.band(name)[0][0], one.series(name)[0], one.band(name)[1][0]] for one in found]
        ).T
        assert np.sqrt(np.mean((high - low) ** 2)) / (2 * 2.2) == pytest.approx(
            np.std(value, ddof=1), rel=0.45
        )
        assert ((low < np.mean(value)) & (np.mean(value) < high)).sum() >= 20


def test_a_contact_in_one_tile_has_no_band():
    one = asp.predict(asp.solids.half_space(modulus="2 GPa"), rough(), pressure="1 kPa", first=1.0, last=10.0)
    assert np.isnan(one.band("contact_area")).all()
    with refuses("name", "'energy'"):
        one.band("energy")


@pytest.mark.parametrize(
    ("leg", "got"),
    [
        (P.Slide("1 um", velocity="1 um/s"), "slide 1e-06 at 1e-06"),
        (P.Hold(10.0, "separation"), "hold separation for 10"),
        (P.Hold(10.0, "area"), "hold area for 10"),
        (P.Ramp(10.0, approach="10 nm"), "ramp to approach"),
    ],
)
def test_legs_that_no_band_covers(leg, got):
    solid = asp.solids.half_space(modulus="2 GPa", branches=[(0.3, 8.0)])
    with refuses("protocol", got):
        asp.predict(solid, rough(), pressure="1 MPa", protocol=[P.Hold(1.0), leg])


def test_what_python_refuses_beside_legs():
    solid = asp.solids.half_space(modulus="2 GPa", branches=[(0.3, 8.0)])
    how: dict[str, Any]
    for name, got, how in (
        ("ramp", "'1 s'", {"ramp": "1 s", "load": 0.01}),
        ("last", "10", {"last": 10, "load": 0.01}),
        ("load and pressure", "none", {}),
    ):
        with refuses(name, got):
            asp.predict(solid, rough(), protocol=[P.Hold(1.0), P.Hold(1.0)], **how)
    table = asp.relaxation.Relaxation(np.geomspace(0.1, 100, 16), np.geomspace(2e9, 1e9, 16))
    with refuses("protocol", "1000 s"):
        asp.predict(table, rough(), load=0.01, protocol=P.Hold(1000.0))
