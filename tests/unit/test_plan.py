"""The plan of a campaign: how lists spread out, what identifies a run, how mistakes are named."""

import numpy as np
import pytest

from asperity.app.campaign import load_plan, read_plan
from asperity.app.campaign.plan import name_of
from asperity.app.campaign.sweeping import plan_to_json
from asperity.errors import ConfigError
from tests.campaign.conftest import written

BASE = """
[surface]
shape = [8, 8]
seed = 3
[aging]
last = 1.0
"""


def plan_of(folder, sweep, base=BASE):
    return read_plan(written(folder, f"{base}\n[sweep]\n{sweep}"))


def problems_of(folder, text):
    with pytest.raises(ConfigError) as caught:
        read_plan(written(folder, text))
    return [problem.partition("campaign.toml: ")[2] or problem for problem in caught.value.problems]


def test_a_grid_spreads_out_with_the_seeds_fastest(tmp_path):
    plan = plan_of(tmp_path, "load = [1, 2.0]\nk1 = [1.0, 3.0, 9.0]\nseeds = 2")
    assert [(axis.section, axis.name, axis.values) for axis in plan.axes] == [
        ("contact", "load", (1, 2.0)),
        ("solid", "k1", (1.0, 3.0, 9.0)),
    ]
    assert plan.seeds == (3, 4)
    assert len(plan.runs) == 12
    described = [(run.config.contact.load, run.config.solid.k1, run.config.surface.seed) for run in plan.runs]
    assert described[:3] == [(1.0, 1.0, 3), (1.0, 1.0, 4), (1.0, 3.0, 3)]
    assert len({run.identity for run in plan.runs}) == 12


def test_zipped_lists_go_pairwise_and_still_cross_the_seeds(tmp_path):
    plan = plan_of(tmp_path, "combine = 'zip'\nload = [1.0, 2.0]\nk1 = [1.0, 3.0]\nseeds = [5, 9]")
    described = [(run.config.contact.load, run.config.solid.k1, run.seed) for run in plan.runs]
    assert described == [(1.0, 1.0, 5), (1.0, 1.0, 9), (2.0, 3.0, 5), (2.0, 3.0, 9)]


def test_a_section_may_be_named_and_values_may_be_lists(tmp_path):
    plan = plan_of(tmp_path, "surface.shape = [[4, 4], [8, 6]]")
    assert plan.axes[0].values == ("4x4", "8x6")
    assert [run.config.surface.shape for run in plan.runs] == [[4, 4], [8, 6]]


def test_adding_values_keeps_the_identities_of_the_rest(tmp_path):
    few = plan_of(tmp_path, "load = [1.0, 2.0]\nseeds = 2")
    many = plan_of(tmp_path, "load = [0.5, 1.0, 2.0]\nk1 = [3.0]\nseeds = 5")
    assert {run.identity for run in few.runs} < {run.identity for run in many.runs}


@pytest.mark.parametrize(
    ("change", "same"),
    [
        ("[solid]\nR = 2.0", False),
        ("[contact]\nload = 3.0", False),
        ("[output]\nmaps_at = [1.0]", False),
        ("[output]\nfigures = ['pdf']", True),
    ],
)
def test_any_parameter_changes_the_identity_and_the_format_of_figures_does_not(tmp_path, change, same):
    before = plan_of(tmp_path, "k1 = [1.0]").runs[0].identity
    assert (plan_of(tmp_path, "k1 = [1.0]", base=f"{BASE}\n{change}").runs[0].identity == before) == same


def test_a_measured_surface_counts_by_its_content(tmp_path):
    heights = np.random.default_rng(0).normal(size=(6, 6))
    text = "[surface]\npath = 'rough.npy'\n[sweep]\nload = [1.0]"
    np.save(tmp_path / "rough.npy", heights)
    first = read_plan(written(tmp_path, text)).runs[0]
    assert first.seed is None
    (tmp_path / "elsewhere").mkdir()
    np.save(tmp_path / "elsewhere" / "rough.npy", heights)
    assert read_plan(written(tmp_path / "elsewhere", text)).runs[0].identity == first.identity
    np.save(tmp_path / "rough.npy", 2 * heights)
    assert read_plan(written(tmp_path, text)).runs[0].identity != first.identity


def test_a_key_given_twice_is_refused(tmp_path):
    text = f"{BASE}\n[sweep]\nk1 = [1.0]\n[sweep.solid]\nk1 = [2.0]"
    assert problems_of(tmp_path, text) == ["[sweep] k1: given twice"]


def test_every_mistake_is_named_before_anything_starts(tmp_path):
    problems = problems_of(
        tmp_path,
        """
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
        """,
    )
    assert problems == [
        "[sweep] combine: expected 'grid' or 'zip', got 'product'",
        "[sweep] seeds: expected a number of seeds or a list of different ones, got -2",
        "[sweep] laod: no such key; did you mean 'load'?",
        "[sweep] k1: expected a list of values, got 3.0",
        "[sweep] seed: cannot be swept; try seeds",
        "[sweep] times: cannot be swept; these can: edges, shape, rms, creep, creep_rate, creep_stress, "
        "creep_exponent, k0, k1, R, R_viscous, hardness, load, pressure, separation, hold, rtol, "
        "shear_strength, rate_coefficient, reference_velocity, stiffness, resistivity, conductivity, shear, "
        "friction_coefficient",
        "[sweep] R: expected different values, got [1.0, 1.0]",
        "[surface] shap: no such key; did you mean 'shape'?",
    ]


def test_mistakes_in_any_run_are_named_once(tmp_path):
    text = f"{BASE}\n[sweep]\nload = [1.0, -1.0]\nk1 = [1.0, 'two']\nseeds = 3"
    assert problems_of(tmp_path, text) == [
        "[solid] k1: expected a number, got 'two'",
        "[contact] load: expected a number of at least 0.0, got -1.0",
    ]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("sweep = 3", "sweep: expected a section [sweep], got 3"),
        ("[sweep]\nload = []", "[sweep] load: expected a list of values, got []"),
        (
            "[sweep]\ncombine='zip'\nload=[1.0,2.0]\nk1=[1.0]",
            "lists of one length for combine = 'zip', got load 2, k1 1",
        ),
        (
            "[surface]\npath='x.npy'\n[sweep]\nseeds = 3",
            "[sweep] seeds: a surface of kind 'file' has no seed",
        ),
        ("[surface]\npath='none.npy'", "none.npy: No such file"),
        ("[contact]\nseparation=1.0\n[sweep]\nload=[1.0]", "expected load or separation, got both"),
        ("[sweep]\nseeds = [1, -1]", "[surface] seed: expected a number of at least 0, got -1"),
        (
            "[sweep]\nseeds = 20241121",
            "[sweep] seeds: expected how many surfaces, at most 100,000, got 20,241,121; for one surface of "
            "your choice, try seed in [surface]",
        ),
        (
            "[sweep]\nload = [1.0, 2.0]\nk1 = [1.0, 2.0]\nseeds = 25001",
            "[sweep]: expected at most 100,000 runs, got 100,004 (load 2 x k1 2 x seeds 25001); "
            "try several campaigns",
        ),
    ],
)
def test_single_mistakes(tmp_path, text, problem):
    assert any(problem in line for line in problems_of(tmp_path, text))


def test_a_large_campaign_is_planned(tmp_path):
    plan = plan_of(tmp_path, "load = [1.0, 2.0]\nseeds = 5000")
    assert len({run.identity for run in plan.runs}) == 10_000
    last = plan.runs[-1]
    assert (last.config.contact.load, last.seed, last.config.surface.seed) == (2.0, 5002, 5002)
    (tmp_path / "plan.json").write_text(plan_to_json(plan), encoding="utf-8")
    assert load_plan(tmp_path) == plan


def test_a_run_is_named_by_what_distinguishes_it(tmp_path):
    plan = plan_of(tmp_path, "load = [1.0, 2.0]\nk1 = [3.0]\nseeds = 2")
    assert [name_of(plan, run) for run in plan.runs[:3]] == [
        "load = 1.0, seed = 3",
        "load = 1.0, seed = 4",
        "load = 2.0, seed = 3",
    ]
    assert name_of(plan, *plan.runs[:2]) == "load = 1.0"
    assert name_of(plan, *plan.runs) == "several"
    alone = read_plan(written(tmp_path, BASE))
    assert name_of(alone, alone.runs[0]) == "the run"
