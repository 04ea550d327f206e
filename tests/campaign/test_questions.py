"""Campaigns of other questions than a run: the same answers as from Python, in one table and one figure."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import asperity as asp
import asperity.app.campaign as campaign
from asperity.app.campaign.plan import read_plan
from asperity.app.cli import main
from asperity.app.explore.folders import open_entry
from asperity.errors import ConfigError
from asperity.figures import campaign_figure
from asperity.results import load
from tests.campaign.conftest import do_here, done_here, written

BODIES = """
[surface]
kind = "spectral"
shape = [32, 32]
rms_height = 0.05
spacing = 0.5
unit = "um"
[solid]
kind = "half_space"
modulus = 1e9
branches = [[0.3, "10 ms"], [0.4, 1.0]]
"""
PRESSED = f'{BODIES}[contact]\npressure = "20 MPa"\n'
SLIDING = f"{PRESSED}[sliding]\nspeeds = ['1 um/s', '1 mm/s']\nper_decade = 1\n[sweep]\n"
PREDICTION = f"{PRESSED}[aging]\nfirst = 3.0\nlast = 100.0\n[prediction]\n[sweep]\n"
LAW = (
    f"{BODIES}[aging]\ntimes = [0.0, 1.0]\n[law]\npressures = ['2 MPa', '15 MPa']\nper_decade = 3\n[sweep]\n"
)


def bodies(seed: int) -> tuple[asp.solids.Solid, asp.surfaces.Surface]:
    heights = asp.surfaces.spectral((32, 32), rms_height=0.05, spacing=0.5, seed=seed)
    solid = asp.solids.half_space(modulus=1e9, branches=[(0.3, 0.01), (0.4, 1.0)])
    return solid, asp.surfaces.Surface(heights, "um", (0.5, 0.5), "um")


def slid(seed: int, **at: Any) -> Any:
    how = {"speeds": [1e-6, 1e-3], "per_decade": 1, "pressure": at["pressure"], "direction": at["direction"]}
    return asp.steady_sliding(*bodies(seed), **how)


def predicted(seed: int, **at: Any) -> Any:
    how = {"pressure": 2e7, "first": 3.0, "last": 100.0, "ramp": at["ramp"]}
    return asp.predict(*bodies(seed), **how).dataset


def tabulated(seed: int, **at: Any) -> Any:
    _, surface = bodies(seed)
    solid = asp.solids.half_space(modulus=at["modulus"], branches=[(0.3, 0.01), (0.4, 1.0)])
    return asp.law(solid, surface, pressures=[2e6, 1.5e7], per_decade=3, times=[0.0, 1.0])


@pytest.mark.parametrize(
    ("text", "axes", "alone", "name", "over"),
    [
        (
            f"{SLIDING}pressure = ['20 MPa', '40 MPa']\ndirection = ['x', 'y']\nseeds = 2",
            {"pressure": [2e7, 4e7], "direction": ["x", "y"]},
            *(slid, "hysteresis_friction_coefficient", "speed"),
        ),
        (
            f"{PREDICTION}ramp = ['1 s', 2.0]\nseeds = 2",
            {"ramp": [1.0, 2.0]},
            predicted,
            "contact_area",
            "time",
        ),
        (f"{LAW}modulus = [1e9, 2e9]", {"modulus": [1e9, 2e9]}, tabulated, "approach", "pressure"),
    ],
    ids=["sliding", "prediction", "law"],
)
def test_a_campaign_gathers_the_answers_of_its_question(tmp_path, capsys, text, axes, alone, name, over):
    plan = done_here(tmp_path, text)
    data = campaign.open(tmp_path / "out")
    assert {axis: data[axis].values.tolist() for axis in axes} == axes
    assert data.attrs["finished"] == len(plan.runs)
    units = {fact.split()[1] for fact in data.attrs["parameter_units"].split(", ")}
    assert "s" in units
    assert not units & {"time", "pressure", "velocity", "length"}  # dimensions
    where = {axis: values[-1] for axis, values in axes.items()}
    seed = int(data["seed"][-1])
    right = alone(seed, **where)
    there = data.sel(where | {"seed": seed})
    for of in (name, f"{name}_low", "contact_fraction"):
        np.testing.assert_array_equal(there[of].transpose(*right[of].dims), right[of])
        assert there[of].attrs["units"] == right[of].attrs["units"]
    spread = data[name].std("seed", ddof=1) / np.sqrt(data.sizes["seed"])
    if data.sizes["seed"] > 1:
        np.testing.assert_allclose(data[f"{name}_stderr"], spread)
    # The file of the campaign, written from its results, plans the same runs; they are not done again.
    again = read_plan(written(tmp_path, data.attrs["config"]))
    assert again == campaign.load_plan(tmp_path / "out")
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out" / "runs.zarr").rglob("*")}
    assert {state for _, state, _ in do_here(again, tmp_path / "out")} == {"done"}
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert main(["gather", str(tmp_path / "out")]) == 0
    assert "figure written" in capsys.readouterr().out
    rows = pd.read_csv(tmp_path / "out" / "gathered.csv")
    assert len(rows) == len(plan.runs) * right[name].size
    columns = [one for one in map(str, rows) if one == name or one.startswith((f"{name}_m", f"{over}_"))]
    assert len(columns) == 2
    assert load(tmp_path / "out" / "gathered.zarr").identical(data)
    estimate = campaign.estimate(plan, tmp_path / "elsewhere")
    assert estimate.runs == len(plan.runs)
    assert main(["status", str(tmp_path / "out")]) == 0


def test_the_figure_shows_the_bands_of_the_answers(tmp_path):
    done_here(tmp_path, f"{SLIDING}direction = ['x', 'y']\nseeds = 2")
    data = campaign.open(tmp_path / "out")
    name = "hysteresis_friction_coefficient"
    figure: Any = campaign_figure(data)
    (axes,) = figure.axes
    assert len(axes.series["errors"]) + len(axes.series["points"]) == 2
    assert "shaded: 95 % band of an answer" in figure.get_suptitle().replace("\n", " ")
    for direction, (label, _, ends) in zip(("x", "y"), axes.series["band"], strict=True):
        one = data.sel(direction=direction)
        assert direction in label
        for end in ("low", "high"):
            right = one[f"{name}_mean"] * (one[f"{name}_{end}"] / one[name]).mean("seed")
            np.testing.assert_allclose(ends[f" {end}"], right.dropna("speed"))
    alone = data.isel(seed=0).drop_vars([one for one in data if str(one).startswith(f"{name}_mean")])
    bands: Any = campaign_figure(alone.isel(direction=[0])).axes[0]
    ((_, _, ends),) = bands.series["band"]
    np.testing.assert_allclose(ends[" low"], alone[f"{name}_low"].isel(direction=0).dropna("speed"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{SLIDING}rtol = [1e-3]", "rtol: cannot be swept"),
        (f"{SLIDING}separation = [1e-6]", "separation: cannot be swept"),
        (f"{SLIDING}speeds = [[1e-6, 1e-3]]", "speeds: cannot be swept"),
        (f"{SLIDING}ramp = ['1 s']", "ramp: no such key"),
        (f"{LAW}pressure = [1e6]", "pressure: cannot be swept"),
        (f"{PREDICTION}hold = ['load']", "hold: cannot be swept"),
        (f"{PREDICTION}ramp = ['-1 s']", "ramp: expected"),
        (f"[law]\npressures = [1e6, 2e6]\n{SLIDING}pressure = [1e6]", "makes this the file of a question of"),
    ],
)
def test_axes_that_a_question_has_not_are_refused_at_the_door(tmp_path, text, said):
    with pytest.raises(ConfigError) as refused:
        read_plan(written(tmp_path, text))
    assert any(said in line for line in refused.value.problems)


def test_a_table_of_the_solid_counts_by_its_content_and_its_spread_is_kept(tmp_path):
    time = np.geomspace(1e-3, 1e3, 25)
    modulus = 1e9 * (0.3 + 0.3 * np.exp(-time / 0.01) + 0.4 * np.exp(-time))
    lines = [f"{t:.6g},{e:.8g}" for t, e in zip(time, modulus, strict=True)]
    table = tmp_path / "relaxation.csv"
    table.write_text("\n".join(["time_s,E_Pa", *lines]))
    text = PREDICTION.replace(
        'modulus = 1e9\nbranches = [[0.3, "10 ms"], [0.4, 1.0]]', "relaxation = 'relaxation.csv'"
    )
    plan = read_plan(written(tmp_path, f"{text}pressure = [2e7]"))
    (run,) = plan.runs
    assert Path(run.config.solid.relaxation).is_absolute()
    assert {state for _, state, _ in do_here(plan, tmp_path / "out")} == {"done"}
    data = campaign.open(tmp_path / "out")
    surface = bodies(0)[1]
    right = asp.predict(table, surface, pressure=2e7, first=3.0, last=100.0).dataset
    found = data.isel(pressure=0, seed=0)
    np.testing.assert_array_equal(found["contact_area_low"], right["contact_area_low"])
    table.write_text(table.read_text().replace(lines[3], "0.00562341,9.5e8"))
    (state, reason) = do_here(plan, tmp_path / "again")[0][1:]
    assert (state, "changed since" in reason) == ("failed", True)
    assert read_plan(written(tmp_path, f"{text}pressure = [2e7]")).runs[0].identity != run.identity
    assert json.loads((tmp_path / "out" / "plan.json").read_text())["runs"][0][0] == run.identity


def test_keys_of_a_table_are_swept_and_a_campaign_of_predictions_is_opened(tmp_path):
    time = np.geomspace(0.1, 1e4, 21)
    table = pd.DataFrame({"time_s": time, "E_Pa": 1e9 * (0.4 + 0.6 / (1 + time) ** 0.3)})
    solid = "relaxation = 't.csv'\npoisson = 0.3\nreference = '20degC'\nactivation_energy = '100kJ/mol'\n"
    solid += "extrapolate = 'plateau'\n"
    given = BODIES.replace('modulus = 1e9\nbranches = [[0.3, "10 ms"], [0.4, 1.0]]\n', solid)
    assert "t.csv" in given
    given += "[contact]\npressure = '20 MPa'\n[aging]\nfirst = 3.0\nlast = 100.0\n"
    for question in ("", "[prediction]\n"):
        folder = tmp_path / (question.strip("[]\n") or "run")
        folder.mkdir()
        table.to_csv(folder / "t.csv", index=False)
        done_here(folder, f"{given}{question}[sweep]\ntemperature = ['20degC', '40degC']\n")
        swept = campaign.open(folder / "out")["temperature"]
        np.testing.assert_allclose(swept, [293.15, 313.15])
        assert main(["gather", str(folder / "out")]) == 0
        opened = open_entry(folder, "out")
        assert opened.recording is not None
        assert opened.recording.rows
