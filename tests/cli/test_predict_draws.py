"""Draws of a solid's branches: the spread that they give to a prediction, and nothing to a run."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli.flags import keys_for
from asperity.app.config import read_config
from asperity.app.config.keys import sections
from asperity.app.config.python import to_python
from asperity.app.runs import Progress, execute
from asperity.errors import ConfigError, Remark
from tests.cli.conftest import Asperity, Refused
from tests.refusals import refuses

BRANCHES = [(0.2, 3.0), (0.2, 40.0)]
HELD: dict[str, Any] = {"pressure": "2 MPa", "first": "0.3 s", "last": "400 s"}
TOML = """
    [surface]
    path = "scan.txt"
    periodic = "reflect"
    file_unit = "nm"
    pixel_size = 50.0
    length_unit = "nm"
    [solid]
    kind = "half_space"
    modulus = "3 GPa"
    branches = [[0.2, "3 s"], [0.2, 40.0]]
    draws = [[[0.3, "2 s"]], [[0.1, "50 s"], [0.2, 4]], [[0.3, "0.01 h"]]]
    [contact]
    pressure = "30 MPa"
    [aging]
    first = 0.3
    last = 400.0
    per_decade = 2
"""


@pytest.fixture(scope="module")
def scan() -> asp.surfaces.Surface:
    heights = asp.surfaces.spectral((256, 256), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    lengths: dict[str, Any] = {"unit": "nm", "length_unit": "nm"}
    return asp.surfaces.Surface(heights, pixel_size=(50.0, 50.0), edges="reflecting", **lengths)


@pytest.fixture
def toml() -> Path:
    """A configuration with draws, beside its scan."""
    heights = asp.surfaces.spectral((32, 32), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    np.savetxt("scan.txt", heights)
    Path("inferred.toml").write_text(TOML)
    return Path("inferred.toml")


def half_space(branches: list[tuple[float, float]]) -> asp.solids.Solid:
    return asp.solids.half_space(modulus="3 GPa", branches=branches)


@pytest.mark.parametrize("ramp", [None, pytest.param("0.2 s", marks=pytest.mark.slow)])
def test_the_band_is_that_of_a_prediction_for_each_draw(scan: asp.surfaces.Surface, ramp: str | None) -> None:
    random = np.random.default_rng(0)
    shares, factors = random.uniform(0.1, 0.3, (10, 2)), np.exp(random.normal(0, 0.3, (10, 2)))
    draws = np.stack([shares, factors * (3.0, 40.0)], axis=-1)
    alone = [asp.predict(half_space(one.tolist()), scan, ramp=ramp, **HELD).growth for one in draws]
    bare = asp.predict(half_space(BRANCHES), scan, ramp=ramp, **HELD)
    ours = asp.predict(half_space(BRANCHES), scan, ramp=ramp, draws=draws.tolist(), **HELD)
    assert (bare.draws, ours.draws, ours.assumed["draws"]) == (0, 10, 10)
    np.testing.assert_array_equal(ours.series("area"), bare.series("area"))
    slopes = np.quantile(np.repeat([one.per_decade for one in alone], 20), (0.025, 0.975))
    np.testing.assert_allclose(ours.growth.of_table, slopes, rtol=0.03)
    ratios = [one.ratio for one in alone]
    low, high = ours.growth.ratio_band
    assert low < min(ratios)
    assert high > max(ratios)
    assert high - low > 2 * np.ptp(bare.growth.ratio_band)
    assert ours.growth.of_scan == bare.growth.of_scan == bare.growth.band


def test_draws_that_are_the_branches_widen_nothing(scan: asp.surfaces.Surface) -> None:
    bare = asp.predict(half_space(BRANCHES), scan, **HELD).growth
    same = asp.predict(half_space(BRANCHES), scan, draws=[BRANCHES[::-1]] * 3, **HELD).growth
    np.testing.assert_allclose(same.band, bare.band, rtol=1e-12)
    np.testing.assert_allclose(same.ratio_band, bare.ratio_band, rtol=1e-12)


def test_what_python_refuses(scan: asp.surfaces.Surface) -> None:
    wrong_lists: tuple[Any, ...] = ([], [BRANCHES], 3, "x")
    for draws in wrong_lists:
        with refuses("draws"):
            asp.predict(half_space(BRANCHES), scan, draws=draws, **HELD)
    wrong_draws: tuple[tuple[Any, str], ...] = (
        ([(0.0, 1.0)], "draws[1]: share of branch 1"),
        ([(0.2, "1 m")], "draws[1]: relaxation time of branch 1"),
        ([(0.7, 1.0), (0.7, 2.0)], "draws[1]: branches"),
        ("abc", "draws[1]: branches"),
    )
    for wrong, name in wrong_draws:
        with refuses(name):
            asp.predict(half_space(BRANCHES), scan, draws=[BRANCHES, wrong], **HELD)
    with refuses("draws"):
        asp.predict(half_space([]), scan, draws=[BRANCHES] * 2, **HELD)
    table = asp.relaxation.Relaxation(np.geomspace(0.1, 1e3, 9), np.geomspace(2e9, 1e9, 9))
    with refuses("draws"):
        asp.predict(table, scan, pressure="2 MPa", draws=[BRANCHES] * 2)


@pytest.mark.parametrize("command", ["run", "predict"])
def test_mistakes_of_a_file_are_one_clear_line(command: str, toml: Path, refused: Refused) -> None:
    [draws] = [line for line in TOML.splitlines() if "draws" in line]
    [branches] = [line for line in TOML.splitlines() if "branches" in line]
    for old, new in (
        (draws, "draws = []"),
        (draws, "draws = [[[0.3, 2.0]]]"),
        (draws, "draws = [[[0.3, 2.0]], [[0.3, 2.0], [0.8, 1.0]]]"),
        (draws, "draws = [[[0.3, 2.0]], [[0.3, 0.0]]]"),
        (draws, "draws = [[[0.3, 2.0]], [[0.3, '1 m']]]"),
        (draws, "draws = [[[0.3, 2.0]], [7]]"),
        (draws, "draws = 'many'"),
        (branches, ""),
        (branches, "flow = [1e-20, 0]"),
        (branches, "creep = 'eyring'\ncreep_rate = 1e-12\ncreep_stress = 1e7"),
        ('kind = "half_space"', 'kind = "layer"\npoisson = 0.3\nthickness = "1 um"'),
    ):
        toml.write_text(TOML.replace(old, new))
        refused(command, toml, "--quiet")
    refused(command, "--draws", "1")
    Path("table.csv").write_text("time_s,E_MPa\n" + "".join(f"1e{n},{2000 - 90 * n}\n" for n in range(-1, 8)))
    toml.write_text(TOML.replace(branches, "relaxation = 'table.csv'"))
    refused(command, toml, "--quiet")


def test_a_prediction_of_a_file_says_what_its_band_holds(toml: Path, asperity: Asperity) -> None:
    status, said, _ = asperity("predict", toml)
    assert status == 0
    assert "3 draws of the branches, whose spread is in the band" in said
    stored = asp.results.load("prediction")
    assert json.loads(stored.attrs["prediction"])["draws"] == 3
    page = Path("prediction/prediction.html").read_text("utf-8")
    for words in (
        "solid whose numbers were given with 3 draws of its branches, a scan",
        "the spread of 3 draws of its branches is in the band, errors of the others are not.",
        "is found from the 3 draws of the branches that were given (",
        "of the other numbers of the solid or of",
    ):
        assert words in page
    assert "their errors are not in the band" not in page
    draws = [[(0.3, 2.0)], [(0.1, 50.0), (0.2, 4.0)], [(0.3, 36.0)]]
    lengths: dict[str, Any] = {"file_unit": "nm", "pixel_size": 50.0, "length_unit": "nm"}
    rough = asp.surfaces.read("scan.txt", periodic="reflect", **lengths)
    held: dict[str, Any] = {"pressure": "30 MPa", "first": 0.3, "last": 400.0, "per_decade": 2}
    ours = asp.predict(half_space(BRANCHES), rough, draws=draws, **held)
    low, high = ours.growth.ratio_band
    assert f"{ours.growth.ratio:.5g}, 95 % band {low:.4g} to {high:.4g}" in said
    # A flag replaces the branches of the file, and so their draws.
    assert asperity("predict", toml, "--branch", "0.2 3s", "--out", "other")[0] == 0
    page = Path("other/prediction.html").read_text("utf-8")
    assert "their errors are not in the band" in page
    assert " draws" not in page
    assert asperity("predict", toml, "--hardness", "1GPa", "--out", "hard")[0] == 0
    page = Path("hard/prediction.html").read_text("utf-8")
    assert "taking the area for a function of the compliance, and by drawing anew" in page


def test_a_run_does_not_use_draws_and_says_so_once(toml: Path, asperity: Asperity) -> None:
    status, said, _ = asperity("run", toml)
    assert status == 0
    assert said.count("[solid] draws") == 1
    assert "remark                a run does not use [solid] draws; asperity predict does" in said
    assert "draws =" not in Path("asperity-out/config.toml").read_text()
    config = read_config(toml, {})
    assert "draws" not in to_python(config, [1.0])
    ours = execute(config, Progress())
    bare = execute(
        config.model_copy(update={"solid": config.solid.model_copy(update={"draws": None})}), Progress()
    )
    np.testing.assert_array_equal(ours.dataset["contact_area"], bare.dataset["contact_area"])
    assert tomllib.loads(ours.dataset.attrs["config"]) == tomllib.loads(bare.dataset.attrs["config"])
    assert set(ours.remarks) - set(bare.remarks) == {
        "a run does not use [solid] draws; asperity predict does"
    }


@pytest.mark.slow
def test_a_campaign_does_not_use_draws_and_says_so_once(toml: Path) -> None:
    with toml.open("a") as stream:
        stream.write("[sweep]\npressure = ['20 MPa', '30 MPa']\n")
    plan = asp.campaign.read_plan(toml)
    toml.write_text(toml.read_text().replace("draws = ", "# "))
    assert [run.identity for run in plan.runs] == [run.identity for run in asp.campaign.read_plan(toml).runs]
    with pytest.warns(Remark, match="does not use .solid. draws") as remarks:
        asp.campaign.sweep(plan, "campaign", workers=1)
    assert sum("draws" in str(one.message) for one in remarks) == 1
    toml.write_text(TOML + "[sweep]\ndraws = [[[[0.1, 1.0]], [[0.2, 1.0]]], []]\n")
    with pytest.raises(ConfigError, match=r"\[sweep\] draws: cannot be swept; these can: "):
        asp.campaign.read_plan(toml)


def test_draws_are_a_key_of_files_and_no_flag() -> None:
    assert sections()["solid"]["half_space"]["draws"].what == "lists of pairs"
    assert "draws" not in {key.name for part in ("solid", "prediction") for _, key in keys_for(part)}
