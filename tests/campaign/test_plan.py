"""The plan of a campaign: how lists spread out, what identifies a run, how mistakes are named."""

from pathlib import Path

import numpy as np
import pytest

from asperity.app.campaign import load_plan, read_plan
from asperity.app.campaign.plan import name_of, plan_to_json, value_at
from asperity.errors import ConfigError
from tests.campaign.conftest import HALF_SPACES, HISTORY, written
from tests.cli.conftest import told

BASE = """
[surface]
shape = [8, 8]
seed = 3
[aging]
last = 1.0
"""
TIMED = HALF_SPACES.replace("per_decade", "first = 0.1\nlast = 1.0\nper_decade")
"""Half-spaces of which all runs have the same times."""


def plan_of(folder, sweep, base=BASE):
    return read_plan(written(folder, f"{base}\n[sweep]\n{sweep}"))


def test_a_grid_spreads_out_with_the_seeds_fastest_and_comes_back_from_its_file(tmp_path):
    plan = plan_of(tmp_path, "load = [1, 2.0]\nk1 = [1.0, 3.0, 9.0]\nseeds = 2")
    assert [(axis.section, axis.name, axis.values) for axis in plan.axes] == [
        ("contact", "load", (1, 2.0)),
        ("solid", "k1", (1.0, 3.0, 9.0)),
    ]
    assert plan.seeds == (3, 4)
    assert len({run.identity for run in plan.runs}) == 12
    described = [(run.config.contact.load, run.config.solid.k1, run.config.surface.seed) for run in plan.runs]
    assert described[:3] == [(1.0, 1.0, 3), (1.0, 1.0, 4), (1.0, 3.0, 3)]
    (tmp_path / "plan.json").write_text(plan_to_json(plan), encoding="utf-8")
    assert load_plan(tmp_path) == plan


def test_zipped_lists_go_pairwise_and_still_cross_the_seeds(tmp_path):
    plan = plan_of(tmp_path, "combine = 'zip'\nload = [1.0, 2.0]\nk1 = [1.0, 3.0]\nseeds = [5, 9]")
    described = [(run.config.contact.load, run.config.solid.k1, run.seed) for run in plan.runs]
    assert described == [(1.0, 1.0, 5), (1.0, 1.0, 9), (2.0, 3.0, 5), (2.0, 3.0, 9)]


def test_values_may_be_lists_or_single_numbers_of_lists_and_have_units(tmp_path):
    def swept(sweep, base, section, key):
        plan = plan_of(tmp_path, sweep, base)
        assert len({run.identity for run in plan.runs}) == len(plan.runs)
        axes = [(axis.section, axis.name, axis.values) for axis in plan.axes]
        return axes, [value_at(run.config, section, key) for run in plan.runs]

    shapes = swept("surface.shape = [[4, 4], [8, 6]]", BASE, "surface", "shape")
    assert shapes == ([("surface", "shape", ("4x4", "8x6"))], [[4, 4], [8, 6]])
    spectra = 'branches = [[[0.5, 1.0]], [[0.2, "10 ms"], [0.3, 1.0]]]\npressure = ["1 MPa", 2e6]'
    axes, values = swept(spectra, TIMED, "solid", "branches")
    assert axes[0] == ("solid", "branches", ("0.5 1", "0.2 0.01 0.3 1"))
    assert axes[1] == ("contact", "pressure", (1e6, 2e6))
    assert values[-1] == [(0.2, 0.01), (0.3, 1.0)]
    single = 'solid.branches.1.time = ["2 s", 20.0]\nbranches.0.share = [0.1, 0.2]'
    axes, values = swept(single, TIMED, "solid", "branches")
    assert axes == [("solid", "branches.1.time", (2.0, 20.0)), ("solid", "branches.0.share", (0.1, 0.2))]
    assert (values[0], values[-1]) == ([(0.1, 0.01), (0.4, 2.0)], [(0.2, 0.01), (0.4, 20.0)])
    layers = HALF_SPACES.replace('"half_space"', '"layer"\npoisson = 0.3\nthickness = "1 um"')
    _, values = swept('thickness = ["0.5 um", 2e-6]', layers, "solid", "thickness")
    assert values == [0.5e-6, 2e-6]


def test_a_run_is_known_by_all_that_it_depends_on_and_by_nothing_else(tmp_path):
    few = plan_of(tmp_path, "load = [1.0, 2.0]\nseeds = 2")
    many = plan_of(tmp_path, "load = [0.5, 1.0, 2.0]\nk1 = [3.0]\nseeds = 5")
    assert {run.identity for run in few.runs} < {run.identity for run in many.runs}
    before = plan_of(tmp_path, "k1 = [1.0]").runs[0].identity
    for change, same in (
        ("[solid]\nR = 2.0", False),
        ("[contact]\nload = 3.0", False),
        ("[output]\nmaps_at = [1.0]", False),
        ("[output]\nfigures = ['pdf']", True),
    ):
        assert (plan_of(tmp_path, "k1 = [1.0]", f"{BASE}\n{change}").runs[0].identity == before) == same
    # A measured surface counts by its content.
    heights = np.random.default_rng(0).normal(size=(6, 6))
    identities = []
    for place, found in ((tmp_path, heights), (tmp_path / "elsewhere", heights), (tmp_path, 2 * heights)):
        place.mkdir(exist_ok=True)
        np.save(place / "rough.npy", found)
        (run,) = plan_of(place, "load = [1.0]", "[surface]\npath = 'rough.npy'").runs
        assert run.seed is None
        identities.append(run.identity)
    assert identities[0] == identities[1] != identities[2]


EVERY = """
[surface]
shap = [4, 4]
[sweep]
laod = [1.0]
k1 = 3.0
seed = [1]
times = [[1.0]]
R = [1.0, 1.0]
seeds = -2
combine = "product"
"""
MISTAKES = {
    "": (
        EVERY,
        "[sweep]\nload = [1.0, -1.0]\nk1 = [1.0, 'two']\nseeds = 3",  # each is named once
        "sweep = 3",
        "[sweep]\nload = []",
        "[sweep]\nk1 = [1.0]\n[sweep.solid]\nk1 = [2.0]",
        "[sweep]\ncombine='zip'\nload=[1.0,2.0]\nk1=[1.0]",
        "[surface]\npath='x.npy'\n[sweep]\nseeds = 3",
        "[surface]\npath='none.npy'",
        "[contact]\nseparation=1.0\n[sweep]\nload=[1.0]",
        "[sweep]\nseeds = [1, -1]",
        "[surface]\nkind = [1]\n[sweep]\nload = [1.0]",
        "[sweep]\nseeds = 20241121",
        "[sweep]\nload = [1.0, 2.0]\nk1 = [1.0, 2.0]\nseeds = 25001",
    ),
    f"{HALF_SPACES}[sweep]\n": (
        'modulus = ["1 GPa", 1e9]',
        'modulus = ["1 N"]',
        "k1 = [1.0]",
        "load = [1.0]",
        "branches = [[[0.5, 1.0]], [[0.5, 2.0]]]",
        "branches.2.time = [1.0]",
        "branches.0.modulus = [1.0]",
        "modulus.0 = [1.0]",
    ),
    f"{HISTORY}[sweep]\n": (
        "protocol.7.load = [3.0]",
        "protocol.0.kind = ['hold']",
        "protocol.1.load = [-3.0]",
    ),
}


def test_every_mistake_is_named_before_anything_starts(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for base, mistakes in MISTAKES.items():
        for text in mistakes:
            Path("campaign.toml").write_text(base + text)
            with pytest.raises(ConfigError) as caught:
                read_plan(Path("campaign.toml"))
            for problem in caught.value.problems:
                told(problem.replace(str(tmp_path), "HERE"))


def test_a_run_is_named_by_what_distinguishes_it(tmp_path):
    plan = plan_of(tmp_path, "load = [1.0, 2.0]\nk1 = [3.0]\nseeds = 2")
    assert [name_of(plan, run) for run in plan.runs[1:3]] == ["load = 1, seed = 4", "load = 2, seed = 3"]
    assert name_of(plan, *plan.runs[:2]) == "load = 1"
    assert name_of(plan, *plan.runs) == "several"
    alone = read_plan(written(tmp_path, BASE))
    assert name_of(alone, alone.runs[0]) == "the run"
