"""What a campaign has still to do, before it starts."""

import math

import numpy as np
import pytest

import asperity.app.campaign as campaign
from asperity.app.campaign.store import Store
from asperity.app.cli import main
from tests.campaign.conftest import SMALL, do_here, written


@pytest.mark.parametrize(
    "text",
    [
        "[output]\nmaps_at = []\n[solid]\nk1 = 3.0\n",
        "[output]\nmaps_at = [0.0, 1.0]\n[solid]\nhardness = 3.0\n",
        "[output]\nmaps_at = [0.0, 1.0]\n[solid]\nkind = 'half_space'\nmodulus = 1.0\n"
        "branches = [[0.3, 0.1], [0.3, 1.0]]\n",
    ],
    ids=["series", "maps", "branches"],
)
def test_disk_and_memory(tmp_path, text):
    plan = campaign.read_plan(
        written(
            tmp_path,
            f"[surface]\nshape = [64, 64]\n[aging]\nlast = 1.0\n{text}[sweep]\nload = [20.0, 40.0]\n",
        )
    )
    judged = campaign.estimate(plan, tmp_path / "out")
    do_here(plan, tmp_path / "out")
    store = Store(tmp_path / "out").runs
    found = [path for run in plan.runs for path in (store / run.identity, *(store / run.identity).rglob("*"))]
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
    once = campaign.estimate(campaign.read_plan(written(tmp_path, text)), tmp_path / "out")
    mirrored = text.replace("wrap", "mirror")
    assert (
        campaign.estimate(campaign.read_plan(written(tmp_path, mirrored)), tmp_path / "out").memory
        == 4 * once.memory
    )
