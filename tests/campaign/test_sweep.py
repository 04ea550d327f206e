"""Campaigns from one file to one Dataset, by the command and from Python."""

import os
import re
import signal
import subprocess
import sys

import dask
import numpy as np
import pytest
import xarray as xr

import asperity.app.campaign as campaign
from asperity import age, observe, press
from asperity.app.campaign.plan import plan_to_json
from asperity.app.campaign.store import Store
from asperity.app.cli import main
from asperity.ask.section import KINDS
from asperity.errors import AsperityError, InputError
from asperity.results import load as load_results
from asperity.results.parameters import PARAMETERS
from asperity.results.quantities import select
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian
from tests.campaign.conftest import (
    SMALL,
    do_here,
    done_here,
    finish,
    numbers,
    some_of,
    start,
    wait_for_a_run,
    written,
)
from tests.refusals import refuses

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals"),
    pytest.mark.xdist_group("sweep"),
]


def test_the_dataset_holds_what_single_runs_give_and_what_they_have_in_common(done, tmp_path):
    data = campaign.open(done / "out")
    assert data["area"].dims == ("load", "k1", "seed", "time")
    assert data.attrs["finished"] == data.attrs["runs"] == 12
    for k1, seed in ((1.0, 0), (3.0, 2)):
        contact = press(gaussian((16, 16), seed=seed), spring_lattice(k0=1.0, k1=k1), load=12.0)
        alone = age(contact, np.geomspace(0.1, 10.0, 5)).dataset
        there = data.sel(load=12.0, k1=k1, seed=seed)
        for name in ("area", "separation", "energy", "residual"):
            np.testing.assert_array_equal(there[name], alone[name])
        np.testing.assert_array_equal(there["load_history"], alone["load"])
        assert float(there["initial_area"]) == contact.area
    areas = data["area"].values
    np.testing.assert_allclose(data["area_mean"], areas.mean(axis=2))
    np.testing.assert_allclose(data["area_stderr"], areas.std(axis=2, ddof=1) / np.sqrt(3), atol=1e-15)
    assert (data["count"] == 3).all()
    assert data["relaxed_area_mean"].dims == ("load", "k1")
    same = {
        "kind": "gaussian",
        "shape": [16, 16],
        "rms": 1.0,
        "k0": 1.0,
        "R": 1.0,
        "last": 10.0,
        "rtol": 2e-3,
    }
    assert {name: data.attrs[name] for name in same} == same
    assert not {"load", "k1", "seed"} & set(data.attrs)
    assert data["load"].attrs["long_name"] == "normal load, the sum of the contact forces"
    # The file of the campaign, written from its results, plans the same runs.
    again = campaign.read_plan(written(tmp_path, data.attrs["config"]))
    assert again == campaign.load_plan(done / "out")


def test_every_coordinate_has_a_name_and_a_unit():
    sections = [section for kinds in KINDS.values() for section in kinds.values()]
    keys = {name for section in sections for name, one in section.keys.items() if one.quantity.swept}
    assert len(keys) > 50
    assert keys <= set(PARAMETERS)


def test_the_numbers_do_not_depend_on_the_number_of_workers_and_are_computed_once(done, tmp_path):
    plan = done_here(tmp_path)
    assert numbers(tmp_path / "out") == numbers(done / "out")
    before = {path: path.stat().st_mtime_ns for path in (done / "out" / "runs.zarr").rglob("*")}
    assert campaign.sweep(plan, done / "out").done == 12
    assert {path: path.stat().st_mtime_ns for path in (done / "out" / "runs.zarr").rglob("*")} == before


def test_status_and_gather(done, tmp_path, capsys):
    def gathered(name, *flags):
        return main(["gather", str(done / "out"), "--to", str(tmp_path / name), *flags])

    data = campaign.open(done / "out")
    assert main(["status", str(done / "out")]) == 0
    assert "done     12" in capsys.readouterr().out
    assert gathered("all.zarr") == 0
    assert "one row a run, 12 rows" in capsys.readouterr().out
    xr.testing.assert_identical(load_results(tmp_path / "all.zarr"), data)
    assert gathered("all.nc") == 2
    assert "all.csv exists; try --overwrite" in capsys.readouterr().err
    (tmp_path / "all.csv").write_text("old")
    assert gathered("all.nc", "--overwrite") == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        *("all.zarr", "all.nc", "all.csv", "all.png", "all_data.csv")
    }
    assert (tmp_path / "all.png").stat().st_size > 20_000
    table = [line.split(",") for line in (tmp_path / "all.csv").read_text().splitlines()]
    assert len(table) == 13
    assert table[0][:3] == ["load", "k1", "seed"]
    row = dict(zip(table[0], table[-1], strict=True))  # the last load, k1 and seed
    series = data.isel(load=-1, k1=-1, seed=-1)
    for quantity in ("approach", "contact_fraction", "separation", "energy"):
        assert float(row[f"final_{quantity}"]) == float(series[quantity][-1])
        assert float(row[f"initial_{quantity}"]) == float(series[quantity][0])
    assert float(row["final_load"]) == float(series["load_history"][-1])
    counts = [table[0].index(name) for name in ("sites", "initial_area", "final_area", "relaxed_area")]
    assert all(row[column].isdecimal() for row in table[1:] for column in counts)
    again = xr.load_dataset(tmp_path / "all.nc")
    assert set(again.variables) == set(data.variables)
    for name, variable in again.variables.items():
        np.testing.assert_array_equal(variable, data[name])
        assert variable.attrs["long_name"]
        assert variable.attrs["units"]
    assert (again.attrs["kind"], again.attrs["k0"]) == ("gaussian", 1.0)
    assert again["fit_t0"].attrs["units"] == again["time"].attrs["units"]
    assert again["held"].attrs["units"] == again["load_history"].attrs["units"]
    assert gathered("all.h5") == 2


def test_what_is_not_finished_is_nan(tmp_path):
    plan = campaign.read_plan(written(tmp_path))
    out = tmp_path / "out"
    with pytest.raises(InputError):
        campaign.open(out)
    do_here(some_of(plan, 4), out)
    (out / "plan.json").write_text(plan_to_json(plan))
    counted = campaign.tally(plan, out)
    assert (counted.total, counted.done, counted.left) == (12, 4, 8)
    data = campaign.open(out)
    assert int(data["count"].sum()) == 4
    assert int(np.isfinite(data["initial_area"]).sum()) == 4
    assert float(data["count"].sel(load=4.0, k1=3.0)) == 1
    assert np.isnan(data["area_stderr"].sel(load=4.0, k1=3.0)).all()
    assert len(campaign.table(data)) == 4


def test_zipped_parameters_share_one_dimension_and_the_ends_may_be_all_that_is_asked_for(tmp_path):
    zipped = SMALL.replace("seeds = 3", "combine = 'zip'\nseeds = 2")
    ends = re.sub(r"first = (.|\n)*(?=\[sweep)", "times = [0.0]\n", zipped)
    done_here(tmp_path, ends)
    data = campaign.open(tmp_path / "out")
    assert data["area"].dims == ("point", "seed", "time")
    assert data["k1"].values.tolist() == [1.0, 3.0]
    assert data.sel(point=1)["held"].values.tolist() == [12.0, 12.0]
    assert data["time"].values.tolist() == [0.0]
    assert (data["relaxed_area"] >= data["initial_area"]).all()
    assert (data["final_area"] == data["initial_area"]).all()


def test_a_failed_run_does_not_stop_the_others_and_is_tried_again_when_asked(tmp_path, capsys):
    # At the larger separation nothing touches.
    swept = SMALL.replace("load = [4.0, 12.0]", "separation = [1.0, 50.0]").replace("seeds = 3", "seeds = 2")
    path = written(tmp_path, swept)
    out = tmp_path / "out"
    plan = campaign.read_plan(path)
    states = [state for _, state, _ in do_here(plan, out)]
    assert states == ["done"] * 4 + ["failed"] * 4
    failed = out / "state" / "failed"
    before = {path: path.stat().st_mtime_ns for path in failed.iterdir()}
    # Not tried again by itself ...
    assert main(["sweep", str(path), "--out", str(out)]) == 1
    said = capsys.readouterr()
    assert said.err.splitlines()[-1].startswith("asperity: 4 of 8 runs failed: asperity status")
    assert said.out.split()[:8] == ["runs", "8", "done", "4", "running", "0", "failed", "4"]
    told = said.out.splitlines()[5:]
    assert len(told) == 2  # both k1 fail alike
    assert re.match(r"separation = 50, seed = 0 \(2 runs, the first [0-9a-f]{24}\): separation: ", told[0])
    assert {path: path.stat().st_mtime_ns for path in before} == before
    # ... but when asked.
    end = campaign.sweep(plan, out, workers=1, retry_failed=True)
    assert (end.done, end.failed, end.left) == (4, 4, 0)
    assert all(path.stat().st_mtime_ns > then for path, then in before.items())


def test_equal_failures_are_merged(tmp_path, capsys):
    plan = campaign.read_plan(written(tmp_path))
    out = tmp_path / "st ü x"
    do_here(some_of(plan, 1), out)
    for run in plan.runs[1:]:
        Store(out).fail(run.identity, "no memory" if run.seed else "no luck")
    (out / "plan.json").write_text(plan_to_json(plan))
    assert main(["status", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[5:] == [
        f"several (8 runs, the first {plan.runs[1].identity}): no memory",
        f"seed = 0 (3 runs, the first {plan.runs[3].identity}): no luck",
    ]
    assert main(["sweep", str(tmp_path / "campaign.toml"), "--out", str(out), "--scheduler", "bogus"]) == 1
    said = capsys.readouterr()
    assert "scheduler bogus was not used: no run was to do" in re.sub(" +", " ", said.out)
    assert f"asperity status '{out}' says why" in said.err


@pytest.mark.slow
def test_a_script_without_a_guard_ends_in_one_line(tmp_path):
    script = tmp_path / "script.py"
    plan, out = str(written(tmp_path)), str(tmp_path / "out")
    script.write_text(
        f"import asperity as asp\nasp.campaign.sweep(asp.campaign.read_plan({plan!r}), {out!r})\n"
    )
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, timeout=300)
    assert ended.returncode == 1
    assert ended.stderr.count("Traceback") == 1
    assert ended.stderr.splitlines()[-1].endswith(
        "call sweep under if __name__ == '__main__':, as they import it"
    )


@pytest.mark.slow
def test_two_campaigns_on_one_folder_at_once(tmp_path, done):
    path = written(tmp_path)
    both = [start("sweep", path, "--out", tmp_path / "out", "--workers", "1") for _ in range(2)]
    for running in both:
        out, error = running.communicate(timeout=240)
        assert running.returncode == 0, error
        assert "done     12" in out
    assert numbers(tmp_path / "out") == numbers(done / "out")
    assert list((tmp_path / "out" / "state" / "staging").iterdir()) == []


@pytest.mark.slow
def test_a_disk_that_fills_up(tmp_path):
    # The limit stops the series of a run, not the plan.
    limit = (
        "import resource; sys.dont_write_bytecode = True; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))"
    )
    long = SMALL.replace("per_decade = 2", "per_decade = 400").replace("seeds = 3", "seeds = 1")
    path = written(tmp_path, long)
    status, _, error = finish("sweep", path, "--out", tmp_path / "out", "--workers", "1", before=limit)
    assert status == 1
    (line,) = error.splitlines()[-1:]
    assert "nothing there is damaged; free some space and give the same command again" in line
    assert "Traceback" not in error
    assert numbers(tmp_path / "out") == {}
    do_here(campaign.read_plan(path), tmp_path / "out")
    assert len(numbers(tmp_path / "out")) == 4


@pytest.mark.slow
def test_interrupting_is_harmless(tmp_path):
    listen = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    text = SMALL.replace("seeds = 3", "seeds = 200")
    running = start("sweep", written(tmp_path, text), "--out", tmp_path / "out", "--quiet", before=listen)
    wait_for_a_run(running, tmp_path / "out")
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to the workers too
    _, error = running.communicate(timeout=60)
    assert running.returncode == 130
    (line,) = error.splitlines()
    assert "runs are done, and the same command does the rest" in line


def test_a_configuration_of_dask_that_stops_workers_is_told(tmp_path):
    plan = campaign.read_plan(written(tmp_path, SMALL))
    wrong = dask.config.set({"distributed.comm.require-encryption": True})
    with wrong, pytest.raises(AsperityError, match=r"did not start \(.*TLS.*; Dask is configured in"):
        campaign.sweep(plan, tmp_path / "out", workers=1)


SURFACES = {
    "measured": ("one.npy", "contact.load = 3.0\n[sweep]\npath = ['one.npy', 'two.npy']", ("path", "time")),
    "spectrum": (
        "psd.csv",
        "[surface]\nkind = 'spectrum'\npath = 'psd.csv'\nshape = [8, 8]\n[sweep]\nseeds = 2",
        ("seed", "time"),
    ),
}


@pytest.mark.parametrize(("file", "text", "dims"), SURFACES.values(), ids=SURFACES)
def test_surfaces_of_files_are_as_they_were_planned(tmp_path, monkeypatch, file, text, dims):
    for seed, name in enumerate(("one.npy", "two.npy")):
        np.save(tmp_path / name, np.random.default_rng(seed).normal(size=(6, 6)))
    (tmp_path / "psd.csv").write_text("q,C\n0.5,1\n5,0.1\n")
    plan = campaign.read_plan(written(tmp_path, f"aging.times = [0.1, 1.0]\n{text}\n"))
    monkeypatch.chdir("/")  # a worker may be anywhere
    assert {state for _, state, _ in do_here(plan, tmp_path / "out")} == {"done"}
    data = campaign.open(tmp_path / "out")
    assert data["area"].dims == dims
    assert data["time"].values.tolist() == [0.0, 0.1, 1.0]
    assert campaign.load_plan(tmp_path / "out") == plan
    # A surface that changes after it was planned fails its run.
    (tmp_path / file).write_bytes((tmp_path / file).read_bytes() + b"\n9,0.1\n")
    (_, state, reason) = do_here(plan, tmp_path / "again")[0]
    assert state == "failed"
    assert "expected the file as it was planned, got one that has changed since" in reason


def test_kept_fields_are_those_of_single_runs(tmp_path):
    few = SMALL.replace("k1 = [1.0, 3.0]\nseeds = 3", "k1 = [3.0]\nseeds = 2")
    plan = done_here(tmp_path, f"{few}[output]\nmaps_at = [0.0, 1.0]\npixel = 2.0\n")
    data = campaign.open(tmp_path / "out")
    where = {str(name): data[name].values[-1] for name in data["initial_area"].dims}
    fields = campaign.fields(tmp_path / "out", **where)
    run = data.sel(where)
    assert fields["field_time"].values.tolist() == [0.0, 1.0]
    assert fields["in_contact_relaxed"].sum() == run["relaxed_area"]
    seen = [observe(fields.isel(field_time=number), pixel=2.0).area for number in (0, 1)]
    assert fields["area_observed"].values.tolist() == seen
    wanted = {"spacing": "[1.0, 1.0]", "edges": "periodic", "si": 0}
    assert fields.attrs == fields.attrs | wanted
    solid = spring_lattice(k0=1.0, k1=where["k1"])
    contact = press(gaussian((16, 16), seed=int(where["seed"])), solid, load=where["load"])
    alone = age(contact, np.geomspace(0.1, 10.0, 5), fields_at=[0.0, 1.0]).dataset
    for name in ("heights", "u", "u0", "in_contact"):
        np.testing.assert_array_equal(fields[name], alone[name])
    for name in set(select("map")) & set(alone):
        np.testing.assert_array_equal(run[name], alone[name])
        assert run[name].attrs["units"] == alone[name].attrs["units"]
        xr.testing.assert_equal(fields[name], alone[name].drop_vars("field_leg", errors="ignore"))
        assert fields[name].dtype == alone[name].dtype
    assert data["patches"].dims == (*data["initial_area"].dims, "field_time")
    assert data["patches_mean"].dims == ("load", "k1", "field_time")
    table = campaign.table(data)
    assert len(table) == 4
    assert table["final_patches"].tolist() == data["patches"].isel(field_time=-1).values.ravel().tolist()
    for wrong in ({}, where | {"k9": 1.0}, where | {"seed": 99}):
        with refuses("campaign"):
            campaign.fields(tmp_path / "out", **wrong)
    (chunk,) = (tmp_path / "out" / "runs.zarr").glob(f"{plan.runs[-1].identity}/u/c/0/0/0")
    whole = chunk.read_bytes()
    for damage in (lambda: chunk.write_bytes(whole[: len(whole) // 2]), chunk.unlink):
        damage()
        with refuses("campaign", plan.runs[-1].identity, advice="removing that folder"):
            campaign.fields(tmp_path / "out", **where)


def test_what_is_no_plan_or_dataset_is_refused(done, tmp_path):
    for call in (campaign.sweep, campaign.estimate):
        with refuses("plan", "str"):
            call("campaign.toml", tmp_path)  # type: ignore[arg-type]
    with refuses("dataset", "int"):
        campaign.table(3)  # type: ignore[arg-type]
    with refuses("campaign", "without", advice="maps_at"):
        campaign.fields(done / "out", load=4.0, k1=1.0, seed=0)
