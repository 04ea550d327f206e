"""``asperity infer``: what it writes, what its flags change, and what takes its files."""

import io
import itertools
import shutil
import tomllib
import warnings
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import DEFAULT, Mock

import numpy as np
import pandas as pd
import pytest

import asperity as asp
from asperity.app.cli import main

SAMPLED = ("--sample", "--walkers", "100", "--workers", "1")
T = np.geomspace(1, 1e4, 25)
EXACT = asp.relaxation.PronySeries(1.0, ((0.3, 50.0),)).compliance_at(T)


pytestmark = pytest.mark.xdist_group("infer")  # in one process, which infers once


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """Areas in mm^2 against minutes, with errors, in area.csv; what follows from them in F, and is said."""
    folder = tmp_path_factory.mktemp("once")
    area = 2.0 * EXACT * (1 + 0.01 * np.random.default_rng(1).standard_normal(T.size))
    frame = pd.DataFrame({"time [min]": T / 60, "area": area, "stderr": 0.02 * EXACT})
    frame.to_csv(folder / "area.csv", index=False)
    with redirect_stdout(io.StringIO()) as text, redirect_stderr(io.StringIO()) as error:
        assert main(["infer", str(folder / "area.csv"), "--out", str(folder / "F")]) == 0
    return folder, text.getvalue(), error.getvalue()


@pytest.fixture
def table(once):
    """area.csv and F, here."""
    shutil.copytree(once[0], ".", dirs_exist_ok=True)


def verdicts(folder):
    return pd.read_csv(Path(folder) / "verdicts.csv").set_index("parameter")


@pytest.mark.usefixtures("table")
def test_a_table_becomes_verdicts_a_page_and_a_solid(once):
    _, text, error = once
    assert "Traceback" not in error
    assert "not identified  load, modulus, rms_slope, area_factor" in text
    assert "area.csv: time from 'time [min]' in min, value from 'area', stderr from 'stderr', 25 rows" in text
    assert "following the profile of each parameter" in error
    found = verdicts("F")
    assert list(found.columns[:3]) == ["verdict", "low", "high"]
    time = found.loc["time_1"]
    assert time["verdict"] == "determined"
    assert time["low"] < 50 < time["high"]
    assert (found.loc[["load", "modulus", "rms_slope"], "verdict"] == "not identified").all()
    page = Path("F/inference.html").read_text()
    for said in ("What area.csv determines of the model relaxation", "Beside this page: verdicts.csv"):
        assert said in page
    assert page.count("data:image/png") == 3
    solid = tomllib.loads(Path("F/solid.toml").read_text())["solid"]
    assert len(solid["draws"]) == 100
    assert ("modulus" in solid, solid["data_first"], solid["data_last"]) == (False, "1 s", "10000 s")


@pytest.mark.slow
def test_the_solid_predicts_with_the_spread_of_the_posterior_and_runs(asperity, table):
    rough = asp.surfaces.gaussian((64, 64), rms=1.0, seed=0)
    np.savetxt("scan.txt", rough)
    how = "scan.txt --file-unit um --pixel-size 1 --length-unit um --pressure 1kPa"
    scan = f"predict F/solid.toml --surface {how}"
    for lacking, said in (
        ("--last 1000s", "try young"),
        ("--young 3GPa --last 1e6s", 'try extrapolate = "model"'),
        ("--young 3GPa --last 1e6s --extrapolate plateau", "got plateau; try --extrapolate model"),
    ):
        status, _, error = asperity(*f"{scan} {lacking} --out Q".split())
        assert (status, error.count("\n"), said in error) == (2, 1, True)
    status, _, error = asperity(*f"{scan} --young 3GPa --last 1e6s --extrapolate model --out P".split())
    assert (status, error.count("Traceback")) == (0, 0)
    assert "100 draws" in Path("P/prediction.html").read_text()
    assert asperity(*f"run F/solid.toml --young 3GPa --file {how} --out R".split())[0] == 0


@pytest.mark.slow
def test_priors_come_back_as_they_were_written_and_change_what_is_found(asperity, table):
    assert asperity("infer", "area.csv", "--out", "G", "--priors", "F/priors.toml")[0] == 0
    pd.testing.assert_frame_equal(verdicts("F"), verdicts("G"))
    Path("known.toml").write_text('[time_1]\nkind = "normal"\nmean = "60 s"\ndeviation = "0.1 s"\n')
    assert asperity("infer", "area.csv", "--out", "H", "--priors", "known.toml")[0] == 0
    assert verdicts("H").loc["time_1", "low"] > 59.7


@pytest.mark.slow
def test_units_of_areas_make_them_absolute_and_those_of_times_count(asperity, table):
    units = ("--unit-area", "mm^2", "--units", "time [min]=s")
    assert asperity("infer", "area.csv", "--branches", "1", *units, "--out", "G")[0] == 0
    found = verdicts("G")
    assert "scale" not in found.index
    assert found.loc["time_1", "high"] < 2  # minutes were taken for seconds
    summary = Path("G/summary.txt").read_text()
    assert "load / modulus / rms_slope" in summary.replace("load * area_factor / modulus", "load / modulus")


@pytest.mark.slow
def test_the_area_of_a_ball_has_the_unit_of_its_column(asperity):
    area = 2.0 * EXACT ** (2 / 3) * (1 + 0.01 * np.random.default_rng(1).standard_normal(T.size))
    pd.DataFrame({"time_s": T, "contact area (um^2)": area}).to_csv("ball.csv", index=False)
    words = ("infer", "ball.csv", "--model", "ball", "--branches", "1")
    assert asperity(*words, "--out", "F")[0] == 0
    found = verdicts("F")
    assert found.loc["share_1", "low"] < 0.3 < found.loc["share_1", "high"]
    assert list(found.index[:3]) == ["load", "modulus", "radius"]  # areas in m^2 know a combination of them
    status, _, error = asperity(*words, "--quantity", "depth", "--out", "G")
    assert (status, "contact area" in error, "--unit-area" in error) == (2, True, False)


@pytest.mark.parametrize("command", ["infer", "fit"])
def test_a_flag_that_contradicts_the_unit_of_the_header_is_refused(asperity, command):
    rows = "".join(f"{t},{1 + np.log(1 + t)}\n" for t in (1, 3, 10, 30, 100))
    Path("area.csv").write_text(f"time_s,area_um2\n{rows}")
    status, _, error = asperity(command, "area.csv", "--unit-time", "min", "--out", "F.png")
    assert (status, "--unit-time: expected s, as the table says, got min" in error) == (2, True)


def test_static_friction_in_percent_is_a_part_of_one(asperity):
    hold = np.geomspace(0.5, 1e4, 16)
    friction = 0.6 + 0.03 * np.log1p(hold / 2) + 5e-4 * np.random.default_rng(1).standard_normal(16)
    for name, factor in (("static_friction_%", 100), ("static_friction", 1)):
        np.savetxt("mu.csv", np.c_[hold, factor * friction], delimiter=",", header=f"t_s,{name}", comments="")
        assert asperity("infer", "mu.csv", "--model", "healing", "--out", name, "--figures", "")[0] == 0
    percent, part = (verdicts(name) for name in ("static_friction_%", "static_friction"))
    pd.testing.assert_frame_equal(percent, part, rtol=1e-3)
    assert part.loc["B", "low"] < 0.03 < part.loc["B", "high"]
    found = asp.infer(hold, 100 * friction, model="healing")
    low, high = found.table.set_index("parameter").loc["B", ["low", "high"]]
    assert (low, high) == pytest.approx(tuple(100 * part.loc["B", ["low", "high"]]), rel=0.02)


@pytest.mark.slow
def test_a_record_of_a_slide_hold_slide_test_gives_b(asperity):
    law = asp.friction.RateAndState(a=0.005, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6)
    holds = list(np.geomspace(10, 1e5, 8))
    protocol = asp.friction.slide_hold_slide(holds=holds, velocity=1e-6, distance=100e-6)
    made = asp.friction.synthetic_record(protocol, law, noise=1e-4, seed=1)
    columns = {"time_s": made.time, "displacement_m": made.displacement, "friction": made.friction}
    pd.DataFrame(columns).to_csv("lab.csv", index=False)
    words = ("infer", "lab.csv", "--model", "healing")
    assert asperity(*words, "--out", "F")[0] == asperity(*words, "--error", "10%", "--out", "G")[0] == 0
    assert asperity(*words, "--unit-time", "min", "--out", "H")[0] == 2
    usual, wide = (verdicts(folder).loc["B"] for folder in "FG")
    assert usual["verdict"] == "determined"
    assert usual["low"] < 0.015 < usual["high"] * 1.1  # a > 0: less by theory
    assert wide["high"] / wide["low"] > 2 * usual["high"] / usual["low"]
    assert not Path("F/solid.toml").exists()


@pytest.mark.slow
def test_an_interrupted_inference_goes_on_and_its_samples_are_for_arviz(asperity, table, monkeypatch):
    words, whole = ("infer", "area.csv", *SAMPLED, "--out"), asp.inference.sampling._advanced
    status, _, error = asperity(*words, "S")
    assert (status, "% of the way" in error) == (0, True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import arviz

        draws = arviz.from_netcdf("S/posterior.nc")
    time = verdicts("S").loc["time_1"]
    ends = np.quantile(draws.posterior["time_1"], (0.025, 0.975))
    np.testing.assert_allclose(ends, time[["low", "high"]].astype(float), rtol=1e-6)
    draws.close()
    fitted = verdicts("F").loc["time_1"]
    assert fitted["verdict"] == time["verdict"]
    np.testing.assert_allclose(ends, fitted[["low", "high"]].astype(float), rtol=0.03)
    nine_times = itertools.chain(itertools.repeat(DEFAULT, 9), [KeyboardInterrupt], itertools.repeat(DEFAULT))
    interrupted = Mock(wraps=whole, side_effect=nine_times)
    monkeypatch.setattr("asperity.inference.sampling._advanced", interrupted)
    status, _, error = asperity(*words, "G")
    assert status == 130
    assert "the same command resumes from" in error
    assert not Path("G").exists()
    assert asperity(*words, "G")[0] == 0
    assert not list(Path().glob("*.checkpoint"))
    pd.testing.assert_frame_equal(verdicts("S"), verdicts("G"))


def indenter(path, sign=1):
    time = np.linspace(0, 4, 81)
    depth = np.interp(time, (0, 0.8, 1.6, 3, 3.8, 4), (-1e-6, 0, 1e-6, 1e-6, -0.5e-6, -0.75e-6))
    force = asp.theory.ting(time, depth, asp.relaxation.PronySeries(1e3, ((0.4, 0.2),)), 1e-5)
    force += 1e-2 * force.max() * np.random.default_rng(0).standard_normal(time.size)
    columns = {"time_s": time, "depth_um": sign * 1e6 * depth, "force_nN": 1e9 * force}
    pd.DataFrame(columns).to_csv(path, index=False)


def test_the_record_of_an_indenter_gives_a_solid_that_predicts(asperity):
    indenter("record.csv", sign=-1)
    flags = ("--model", "ball", "--radius", "10um", "--poisson", "0.5", "--branches", "1")
    status, text, _ = asperity("infer", "record.csv", *flags, "--out", "gel")
    assert status == 0
    assert "falls into the body, forces above 0 press" in text
    assert "retraction off its prediction by" in text
    curve = pd.read_csv("gel/curve.csv", comment="#")
    assert len(curve) > 50
    assert Path("gel", "modulus.png").is_file()
    solid = tomllib.loads(Path("gel", "solid.toml").read_text())["solid"]
    assert float(solid["young"].split()[0]) == pytest.approx(750, rel=0.05)
    np.savetxt("scan.txt", asp.surfaces.gaussian((32, 32), rms=1.0, seed=0))
    how = ["--file-unit", "um", "--pixel-size", "1", "--length-unit", "um", "--pressure", "10Pa"]
    status, text, _ = asperity("predict", "gel/solid.toml", "--surface", "scan.txt", *how, "--out", "P")
    assert (status, "the band has no error of the solid" in text) == (0, True)
