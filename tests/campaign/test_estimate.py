"""How long campaigns will take, and how much they will write: judged against what they did."""

import math
import time
from functools import partial

import numpy as np
import pytest

import asperity.app.campaign as campaign
import asperity.app.campaign.forecast as forecast
from asperity.app.campaign.store import Store
from asperity.app.runs import Progress, execute
from tests.campaign.conftest import do_here, written

CASES = {
    "heavy": """
        [surface]
        shape = [128, 128]
        [aging]
        times = [0.0]
        [sweep]
        k1 = [0.01, 1.0, 100.0]
        load = [1e3, 1e5, 1e7]
        seeds = 4
    """,
    "self-affine": """
        [surface]
        kind = "self_affine"
        [solid]
        k1 = 10.0
        [aging]
        last = 1.0
        [sweep]
        size = [64, 128]
        load = [5.0, 80.0]
    """,
    "no neighbors": """
        [surface]
        shape = [40, 40]
        [solid]
        k0 = 0.0
        [aging]
        last = 10.0
        [sweep]
        load = [2.0, 200.0]
    """,
}
SLOW = {
    "light": """
        [surface]
        shape = [300, 300]
        [sweep]
        load = [90.0, 900.0, 9000.0]
        k1 = [1.0, 10.0, 100.0]
    """,
    "large self-affine": """
        [surface]
        kind = "self_affine"
        [sweep]
        hurst = [0.3, 0.8]
        size = [128, 256, 512]
    """,
    "held separation": """
        [surface]
        kind = "exponential"
        shape = [200, 200]
        [aging]
        hold = "separation"
        last = 1e3
        [contact]
        separation = 2.5
        [sweep]
        R_viscous = [0.0, 1.0]
        seeds = 3
    """,
    "line": """
        [surface]
        shape = [8192]
        [sweep]
        load = [10.0, 1000.0]
    """,
}


def computing(judged):
    return judged.seconds - forecast._BESIDE * judged.runs


@pytest.mark.parametrize(
    "text",
    [
        *(pytest.param(text, id=name) for name, text in CASES.items()),
        *(pytest.param(text, id=name, marks=pytest.mark.slow) for name, text in SLOW.items()),
    ],
)
def test_within_a_factor_of_two_of_the_campaign(tmp_path, text):
    # Processor time on both sides, so that other work on the machine does not count.
    plan = campaign.read_plan(written(tmp_path, text))
    judged = campaign.estimate(plan, tmp_path / "out")
    begin = time.process_time()
    for run in plan.runs:
        execute(run.config, Progress())
    truth = time.process_time() - begin
    assert truth / 2 < computing(judged) < 2 * truth


def law(config, sites):
    """A time that grows with sites, load and stiffness."""
    return (0.01 + 1e-5 * forecast._work(sites)) * math.sqrt(config.contact.load / sites * config.solid.k1)


LAWFUL = """
[surface]
shape = [1000, 1000]
[sweep]
load = [1e4, 1e6, 1e8]
k1 = [1.0, 100.0]
seeds = 5
"""


def timed(config, most, tried):
    """As the timing of trial runs, but by the law."""
    sites = math.prod(forecast._lattice(config, most))
    small = config.contact.load * sites / math.prod(config.surface.shape)
    contact = config.contact.model_copy(update={"load": small})
    tried.append(sites)
    return sites, law(config.model_copy(update={"contact": contact}), sites)


def test_trials_on_small_lattices_tell_of_large_ones(tmp_path, monkeypatch):
    tried: list[int] = []
    monkeypatch.setattr(forecast, "_seconds", partial(timed, tried=tried))
    plan = campaign.read_plan(written(tmp_path, LAWFUL))
    judged = campaign.estimate(plan, tmp_path / "out")
    assert max(tried) < 600**2
    assert judged.basis == "trial runs at 6 points"
    assert computing(judged) == pytest.approx(sum(law(run.config, 1e6) for run in plan.runs))
    # Of more points than are tried, the nearest count.
    many = LAWFUL.replace("1e4, 1e6, 1e8", ", ".join(f"{load:g}" for load in np.geomspace(1e4, 1e8, 41)))
    plan = campaign.read_plan(written(tmp_path, many))
    judged = campaign.estimate(plan, tmp_path / "out")
    assert judged.basis == "trial runs at 8 points"
    truth = sum(law(run.config, 1e6) for run in plan.runs)
    assert truth / 2 < computing(judged) < 2 * truth


def test_finished_runs_count_before_trials(tmp_path, monkeypatch):
    text = """
        [surface]
        shape = [16, 16]
        [aging]
        times = [0.0]
        [sweep]
        load = [1.0, 2.0]
        seeds = 3
    """
    plan = campaign.read_plan(written(tmp_path, text))
    do_here(campaign.Plan(plan.axes, plan.seeds, plan.zipped, (plan.runs[0], plan.runs[3])), tmp_path / "out")
    store = Store(tmp_path / "out")
    seconds = [store.read(plan.runs[number]).scalars["seconds"] for number in (0, 3)]
    monkeypatch.setattr(forecast, "_tried", lambda configs: iter(dict.fromkeys(configs, None)))
    judged = campaign.estimate(plan, tmp_path / "out")
    assert (judged.runs, judged.basis) == (4, "finished runs at 2 points")
    assert computing(judged) == pytest.approx(2 * sum(seconds))


@pytest.mark.parametrize("maps", ["[]", "[0.0, 1.0]"])
def test_disk(tmp_path, maps):
    text = f"""
        [surface]
        shape = [64, 64]
        [aging]
        last = 1.0
        [output]
        maps_at = {maps}
        [sweep]
        load = [20.0, 200.0]
    """
    plan = campaign.read_plan(written(tmp_path, text))
    judged = campaign.estimate(plan, tmp_path / "out")
    do_here(plan, tmp_path / "out")
    store = Store(tmp_path / "out").runs
    found = [path for run in plan.runs for path in (store / run.identity, *(store / run.identity).rglob("*"))]
    taken = sum(4096 * max(1, math.ceil(path.stat().st_size / 4096)) for path in found)
    assert judged.bytes / 1.5 < taken < 1.5 * judged.bytes


def test_a_part_of_a_measured_surface_is_tried(tmp_path):
    np.save(tmp_path / "rough.npy", np.random.default_rng(0).normal(size=(40, 60)))
    text = """
        [aging]
        times = [0.0]
        [sweep]
        path = ["rough.npy"]
        load = [10.0]
    """
    (run,) = campaign.read_plan(written(tmp_path, text)).runs
    assert forecast._shape(run.config) == [80, 120]  # mirrored
    small, sites = forecast._shrunk(run.config, 1024, tmp_path)
    assert forecast._shape(small) == [20, 30]
    assert sites == 600
    assert small.contact.load == pytest.approx(10.0 * 600 / 9600)


def test_workers_share_the_runs_that_there_are():
    judged = campaign.Estimate(runs=2, seconds=20.0, bytes=0, basis="")
    assert judged.wall(1) - judged.wall(2) == judged.wall(1) - judged.wall(8) == 10.0
    assert campaign.Estimate(runs=0, seconds=0.0, bytes=0, basis="").wall(2) == 0.0


def test_the_rest_of_the_seeds_of_points_that_are_known(tmp_path):
    plan = campaign.read_plan(written(tmp_path))
    do_here(campaign.Plan(plan.axes, plan.seeds, plan.zipped, plan.runs[::3]), tmp_path / "out")
    judged = campaign.estimate(plan, tmp_path / "out")
    assert judged.runs == 8
    assert judged.basis == "finished runs at 4 points"
