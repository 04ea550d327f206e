"""``asperity infer``: what it writes, what its flags change, and what takes its files."""

from __future__ import annotations

import shutil
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot as plt

import asperity as asp
from asperity.app.cli import main
from tests.cli.conftest import Asperity, Refused

QUICK = ("--walkers", "300", "--workers", "1")
T = np.geomspace(1, 1e4, 25)
EXACT = asp.relaxation.PronySeries(1.0, ((0.3, 50.0),)).compliance_at(T)


pytestmark = pytest.mark.xdist_group("infer")  # in one process, which infers once


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Areas in mm^2 against minutes, with errors, in area.csv; what follows from them in F."""
    folder = tmp_path_factory.mktemp("once")
    area = 2.0 * EXACT * (1 + 0.01 * np.random.default_rng(1).standard_normal(T.size))
    frame = pd.DataFrame({"time [min]": T / 60, "area": area, "stderr": 0.02 * EXACT})
    frame.to_csv(folder / "area.csv", index=False)
    assert main(["infer", str(folder / "area.csv"), *QUICK, "--out", str(folder / "F")]) == 0
    return folder


@pytest.fixture
def table(once: Path) -> None:
    """area.csv and F, here."""
    shutil.copytree(once, ".", dirs_exist_ok=True)


def verdicts(folder: str) -> Any:
    return pd.read_csv(Path(folder) / "verdicts.csv").set_index("parameter")


@pytest.mark.usefixtures("no_display")
def test_a_table_becomes_verdicts_a_page_draws_and_a_solid(asperity: Asperity, table: None) -> None:
    status, text, error = asperity("infer", "area.csv", *QUICK, "--out", "F", "--overwrite")
    assert (status, error.count("Traceback")) == (0, 0)
    assert "not identified  load, modulus, rms_slope, area_factor" in text
    assert "data at" in error  # how far the sampling is
    found = verdicts("F")
    assert list(found.columns[:3]) == ["verdict", "low", "high"]
    assert found.loc["time_1", "verdict"] == "determined"
    assert found.loc["time_1", "low"] < 50 < found.loc["time_1", "high"]
    assert (found.loc[["load", "modulus", "rms_slope"], "verdict"] == "not identified").all()
    page = Path("F/inference.html").read_text()
    assert "What area.csv determines of the model relaxation" in page
    assert "What to measure next" in page
    assert "Beside this page: verdicts.csv" in page
    assert page.count("data:image/png") == 3
    assert not plt.get_fignums()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import arviz

        draws = arviz.from_netcdf("F/posterior.nc")
    low, high = np.quantile(draws.posterior["time_1"], (0.025, 0.975))
    assert (low, high) == pytest.approx(tuple(found.loc["time_1", ["low", "high"]]), rel=1e-6)
    draws.close()
    solid = tomllib.loads(Path("F/solid.toml").read_text())["solid"]
    assert len(solid["draws"]) == 100
    assert "Not identified" in Path("F/solid.toml").read_text()


def test_the_solid_predicts_with_the_spread_of_the_posterior_and_runs(
    asperity: Asperity, table: None
) -> None:
    rough = asp.surfaces.gaussian((64, 64), rms=1.0, seed=0)
    np.savetxt("scan.txt", rough)
    how = "scan.txt --file-unit um --pixel-size 1 --length-unit um --pressure 1kPa"
    status, _, error = asperity(*f"predict F/solid.toml --surface {how} --last 1000s --out P".split())
    assert (status, error.count("Traceback")) == (0, 0)
    assert "100 draws" in Path("P/prediction.html").read_text()
    assert asperity(*f"run F/solid.toml --file {how} --out R".split())[0] == 0


@pytest.mark.slow
def test_priors_come_back_as_they_were_written_and_change_what_is_found(
    asperity: Asperity, table: None
) -> None:
    assert asperity("infer", "area.csv", *QUICK, "--out", "G", "--priors", "F/priors.toml")[0] == 0
    pd.testing.assert_frame_equal(verdicts("F"), verdicts("G"))
    Path("known.toml").write_text('[time_1]\nkind = "normal"\nmean = "60 s"\ndeviation = "0.1 s"\n')
    assert asperity("infer", "area.csv", *QUICK, "--out", "H", "--priors", "known.toml")[0] == 0
    assert verdicts("H").loc["time_1", "low"] > 59.7


@pytest.mark.slow
def test_units_of_areas_make_them_absolute_and_those_of_times_count(asperity: Asperity, table: None) -> None:
    units = ("--unit-area", "mm^2", "--unit-time", "s")
    assert asperity("infer", "area.csv", *QUICK, "--branches", "1", *units, "--out", "G")[0] == 0
    found = verdicts("G")
    assert "scale" not in found.index
    assert found.loc["time_1", "high"] < 2  # minutes were taken for seconds
    summary = Path("G/summary.txt").read_text()
    assert "load / modulus / rms_slope" in summary.replace("load * area_factor / modulus", "load / modulus")


@pytest.mark.slow
def test_a_record_of_a_slide_hold_slide_test_gives_b(asperity: Asperity) -> None:
    law = asp.friction.RateAndState(a=0.005, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6)
    holds = list(np.geomspace(10, 1e5, 8))
    protocol = asp.friction.slide_hold_slide(holds=holds, velocity=1e-6, distance=100e-6)
    made = asp.friction.synthetic_record(protocol, law, noise=1e-4, seed=1)
    frame = pd.DataFrame(
        {"time_s": made.time, "displacement_m": made.displacement, "friction": made.friction}
    )
    frame.to_csv("lab.csv", index=False)
    words = ("infer", "lab.csv", "--model", "healing", *QUICK)
    status, _, error = asperity(*words, "--out", "F")
    assert (status, error.count("Traceback")) == (0, 0)
    assert asperity(*words, "--error", "10%", "--out", "G")[0] == 0
    assert asperity(*words, "--unit-time", "min", "--out", "H")[0] == 2
    usual, wide = (verdicts(folder).loc["B"] for folder in "FG")
    assert usual["verdict"] == "determined"
    assert usual["low"] < 0.015 < usual["high"] * 1.1  # a > 0: less by theory
    assert wide["high"] / wide["low"] > 2 * usual["high"] / usual["low"]
    assert not Path("F/solid.toml").exists()


def test_an_interrupted_inference_goes_on(
    asperity: Asperity, table: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = asp.inference.sampling._advanced
    calls: list[Any] = []

    def interrupted(task: Any) -> object:
        calls.append(task)
        if len(calls) == 10:
            raise KeyboardInterrupt
        return whole(task)

    words = ("infer", "area.csv", *QUICK, "--out", "G")
    monkeypatch.setattr("asperity.inference.sampling._advanced", interrupted)
    status, _, error = asperity(*words)
    assert status == 130
    assert "the same command goes on from" in error
    assert not Path("G").exists()
    assert asperity(*words)[0] == 0
    assert not list(Path().glob("*.checkpoint"))
    pd.testing.assert_frame_equal(verdicts("F"), verdicts("G"))


@pytest.mark.parametrize(
    "words",
    [
        ("infer", "nowhere.csv"),
        ("infer", "area.csv", "--unit-time", "furlong"),
        ("infer", "area.csv", "--unit-area", "kg"),
        ("infer", "area.csv", "--error", "0"),
        ("infer", "area.csv", "--error", "some"),
        ("infer", "area.csv", "--error", "1%", "--column-stderr", "stderr"),
        ("infer", "area.csv", "--priors", "nowhere.toml"),
        ("infer", "area.csv", "--priors", "area.csv"),
        ("infer", "area.csv", "--branches", "7"),
        ("infer", "area.csv", "--model", "power", "--branches", "2"),
        ("infer", "area.csv", "--ramp", "3 m"),
        ("infer", "area.csv", "--walkers", "3"),
        ("infer", "area.csv", "--workers", "0"),
        ("infer", "falls.csv"),
        ("infer", "two_errors.csv"),
        ("infer", "percent.csv"),
        ("infer", "furlongs.csv"),
        ("infer", "logarithms.csv"),
        ("infer", "area.csv", "--model", "lattice", "--unit-area", "mm^2"),
        ("infer", "area.csv", "--model", "healing", "--unit-area", "mm^2"),
    ],
)
def test_mistakes(refused: Refused, table: None, words: tuple[str, ...]) -> None:
    np.savetxt("falls.csv", np.column_stack([T, EXACT[::-1]]))
    for name, header in (
        ("two_errors", "time_s,area,area_err,load_err"),
        ("percent", "time_s,area,err_percent,load"),
        ("furlongs", "time (furlong),area,a,b"),
        ("logarithms", "log10 time,area,a,b"),
    ):
        columns = np.column_stack([T, EXACT, 0.01 * EXACT, 0.01 * EXACT])
        np.savetxt(f"{name}.csv", columns, delimiter=",", header=header, comments="")
    refused(*words)
