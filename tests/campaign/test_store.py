"""The folder of a campaign: what is damaged is named, what is there is never lost, and what it will take."""

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

import asperity.app.campaign as campaign
import asperity.app.campaign.store
from asperity.app.campaign.store import Store
from asperity.app.campaign.worker import run_task
from asperity.app.cli import main
from tests.campaign.conftest import SMALL, do_here, numbers, some_of, written
from tests.refusals import refuses


@pytest.fixture(scope="module", name="kept")
def two_runs(tmp_path_factory):
    """A campaign of which two runs are done, which differ by their seed; not to be changed."""
    folder = tmp_path_factory.mktemp("store")
    plan = some_of(campaign.read_plan(written(folder)), 2)
    do_here(plan, folder / "out")
    return plan, folder / "out"


@pytest.fixture
def two(kept, tmp_path):
    """A copy of it: the plan, the folder, and the folder of its first run."""
    plan, folder = kept
    out = shutil.copytree(folder, tmp_path / "out")
    return plan, out, out / "runs.zarr" / plan.runs[0].identity


def changed(file, change):
    facts = json.loads(file.read_text())
    file.write_text(json.dumps(change(facts) or facts))


DAMAGE = {
    "a chunk is gone": lambda run: (run / "over_time" / "c" / "0" / "0").unlink(),
    "no table": lambda run: (run / "zarr.json").write_text("3"),
    "a shape": lambda run: changed(
        run / "over_time" / "zarr.json", lambda facts: facts.update(shape=[[0], 8])
    ),
    "a number": lambda run: changed(
        run / "zarr.json", lambda facts: facts["attributes"]["attributes"].update(held="area")
    ),
    "no checksum": lambda run: changed(
        run / "zarr.json", lambda facts: facts["attributes"].pop("attributes_checksum") and None
    ),
}


def test_a_damaged_run_is_named_and_not_used(kept, tmp_path):
    plan, folder = kept
    for kind, damage in DAMAGE.items():
        out = shutil.copytree(folder, tmp_path / kind)
        damage(out / "runs.zarr" / plan.runs[0].identity)
        with refuses("campaign", plan.runs[0].identity, advice="removing that folder"):
            campaign.open(out)


def test_runs_in_the_place_of_another_are_named(two, tmp_path):
    plan, out, first = two
    second = first.with_name(plan.runs[1].identity)
    assert campaign.open(out).attrs["finished"] == 2
    first.rename(tmp_path / "aside")
    second.rename(first)
    (tmp_path / "aside").rename(second)
    for read in (campaign.open, lambda _: Store(out).fields(plan.runs[0])):
        with refuses("campaign", "another run", advice="removing that folder"):
            read(out)


def test_remains_of_a_run_are_named_and_done_again(two, capsys):
    plan, out, run = two
    whole = numbers(out)
    (run / "zarr.json").unlink()
    for command in ("status", "gather"):
        assert main([command, str(out)]) == 0
        assert f"{run.name} without zarr.json: damaged, and not used" in capsys.readouterr().err
    assert do_here(plan, out)[0] == (run.name, "done", "")
    assert numbers(out) == whole
    assert list((out / "state" / "staging").iterdir()) == []
    assert main(["status", str(out)]) == 0
    assert capsys.readouterr().err == ""


def test_a_damaged_store_or_plan_is_named(two):
    plan, out, run = two
    for text in ('{"zarr_format": "3"}', "[3]", ""):
        (run.parent / "zarr.json").write_text(text)
        with refuses("campaign", "zarr.json", advice="removing that file"):
            campaign.sweep(plan, out)
    whole = (out / "plan.json").read_text()
    for damage in (
        lambda facts: facts["runs"][0].__setitem__(1, [0, 99]),
        lambda facts: facts["runs"][0].__setitem__(2, 99),
        lambda facts: [facts],
    ):
        (out / "plan.json").write_text(whole)
        changed(out / "plan.json", damage)
        with refuses("campaign", out):
            campaign.open(out)


def test_a_folder_that_another_process_prepares_is_not_waited_for_for_ever(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(asperity.app.campaign.store, "_PATIENCE", 0.1)
    store = Store(Path("out"))
    store.work.mkdir(parents=True)
    with FileLock(store.work / "prepare.lock"), refuses("campaign", "0.1"):
        store.prepare()
    store.prepare()


def test_a_run_that_another_process_is_at_counts_as_running(two):
    plan, out, _ = two
    store, identity = Store(out), plan.runs[1].identity
    shutil.rmtree(store.runs / identity)
    with store.claim(identity) as mine:
        assert mine
        counted = campaign.tally(plan, out)
        assert (counted.done, counted.running, counted.failed, counted.left) == (1, 1, 0, 0)
        assert run_task(str(out), identity, "{}") == (identity, "busy", "")
    assert campaign.tally(plan, out).running == 0


def test_a_bad_checkpoint_costs_time_and_nothing_else(two):
    plan, out, run = two
    whole, store = numbers(out), Store(out)
    shutil.rmtree(run)
    store.checkpoint(run.name).write_text("junk")
    assert do_here(plan, out)[0] == (run.name, "done", "")
    assert numbers(out) == whole
    assert not store.checkpoint(run.name).exists()


def test_another_version_is_refused(tmp_path):
    report = run_task(str(tmp_path), "name", "{}", "", "0.0.0")
    assert report[1] == "version"
    assert "the campaign 0.0.0" in report[2]


@pytest.mark.parametrize(
    "text",
    [
        "[output]\nmaps_at = []\n[solid]\nk1 = 3.0\n",
        "[output]\nmaps_at = [0.0, 1.0]\n[solid]\nkind = 'half_space'\nmodulus = 1.0\n"
        "branches = [[0.3, 0.1], [0.3, 1.0]]\n",
    ],
    ids=["series", "maps of branches"],
)
def test_the_need_of_disk_and_memory_is_known_before(tmp_path, text):
    base = "[surface]\nshape = [64, 64]\n[aging]\nlast = 1.0\n"
    plan = campaign.read_plan(written(tmp_path, f"{base}{text}[sweep]\nload = [20.0, 40.0]\n"))
    judged = campaign.estimate(plan, tmp_path / "out")
    do_here(plan, tmp_path / "out")
    runs = [Store(tmp_path / "out").runs / run.identity for run in plan.runs]
    found = [path for run in runs for path in (run, *run.rglob("*"))]
    taken = sum(4096 * max(1, math.ceil(path.stat().st_size / 4096)) for path in found)
    assert judged.bytes / 1.5 < taken < 1.5 * judged.bytes
    assert 64**2 * 8 * 10 < judged.memory < 64**2 * 8 * 1000  # tens of arrays over the sites


def test_what_is_done_counts_no_more_and_memory_is_that_of_the_largest_run(tmp_path, capsys):
    path = written(tmp_path, SMALL.replace("k1 = [1.0, 3.0]", "shape = [[16, 16], [32, 32]]"))
    out = tmp_path / "out"
    plan = campaign.read_plan(path)
    whole = campaign.estimate(plan, out)
    assert main(["sweep", str(path), "--out", str(out), "--dry-run"]) == 0
    assert not out.exists()
    large = [run for run in plan.runs if run.config.surface.lattice == (32, 32)]
    do_here(campaign.Plan(plan.axes, plan.seeds, plan.zipped, tuple(large)), out)
    left = campaign.estimate(plan, out)
    assert (whole.runs, left.runs) == (12, 6)
    assert left.memory == pytest.approx(whole.memory / 4)
    capsys.readouterr()
    assert main(["sweep", str(path), "--out", str(out), "--dry-run"]) == 0
    said = capsys.readouterr().out.split()
    assert said[:7] == ["runs", "12,", "of", "which", "6", "are", "to"]
    assert "time" not in said


def test_the_lattice_of_a_measured_surface_is_read_of_its_file(tmp_path):
    np.save(tmp_path / "rough.npy", np.random.default_rng(0).normal(size=(40, 60)))
    text = (
        '[aging]\ntimes = [0.0]\n[surface]\npath = "rough.npy"\nperiodic = "wrap"\n[sweep]\nload = [10.0]\n'
    )
    plans = [campaign.read_plan(written(tmp_path, text.replace("wrap", how))) for how in ("wrap", "mirror")]
    once, mirrored = (campaign.estimate(plan, tmp_path / "out").memory for plan in plans)
    assert mirrored == 4 * once
