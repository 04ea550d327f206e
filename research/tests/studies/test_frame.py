"""The frame of studies: from campaign files to a report, resumed, and refused."""

import dataclasses
from types import SimpleNamespace

import pytest
from tests.refusals import refuses

import asperity_research.studies as studies
from asperity.app.campaign import read_plan
from asperity.app.campaign.sweeping import Tally
from asperity.app.cli import main
from asperity.app.cli.campaign import tally_shown
from asperity_research.studies import unloading
from research.tests.conftest import do_here

TINY = dataclasses.replace(studies.STUDIES["unloading"], quick=unloading.campaigns(surfaces=2, side=8))


@pytest.fixture
def asperity(monkeypatch, capsys):
    monkeypatch.setitem(studies.STUDIES, "unloading", TINY)

    def call(*words):
        status = main(["study", *map(str, words)])
        said = capsys.readouterr()
        return status, said.out, said.err

    return call


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "out"
    with TINY.prepared_in(folder, quick=True, seed=7) as prepared:
        do_here(prepared)
    return folder


def test_a_finished_study_is_reported_without_new_runs(done, asperity):
    status, out, err = asperity("unloading", "--out", done, "--quick", "--seed", "7")
    assert status == 0, err
    assert "campaign 1" not in err
    assert out.rstrip().endswith("report.md")
    report = (done / "report.md").read_text(encoding="utf-8")
    assert f"--out {done} --quick --seed 7" in report
    for name in ("figure.png", "figure.svg", "figure.pdf", "ledger.csv", "origin.toml", "data/dips.csv"):
        assert (done / name).stat().st_size > 100
    # Numbers of the ledger stand in the report, with their verdicts.
    for finding in studies.conclude(
        TINY, done, _prepared(done), quick=True, command="", seed=7
    ).outcome.findings:
        assert finding.verdict.value in report
    for campaign in TINY.quick:
        plan = read_plan(done / "unloading" / campaign.name / "campaign.toml")
        assert plan.seeds == (7, 8)


def _prepared(folder):
    with TINY.prepared_in(folder, quick=True, seed=7) as prepared:
        return prepared


def test_the_list_and_what_a_study_takes(done, asperity):
    status, out, _ = asperity()
    assert status == 0
    for study in studies.STUDIES.values():
        assert f"{study.name} " in out
        assert study.question in out
    status, out, _ = asperity("unloading", "--quick", "--dry-run", "--out", done, "--seed", "7")
    assert (status, len(out.splitlines())) == (0, 1 + len(TINY.quick))


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["unloadin"], "study: expected one of unloading"),
        (["unloading", "--seed", "-1"], "seed: expected 0 or more, got -1"),
        (["unloading", "--out", "file"], "which is a file"),
        (["unloading", "--out", "full"], "expected a new folder, or that of the study unloading"),
    ],
)
def test_mistakes(tmp_path, monkeypatch, asperity, words, complaint):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("mine")
    status, out, err = asperity(*words)
    assert (status, out) == (2, "")
    assert complaint in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "full"]


def test_another_seed_wants_another_folder(done, asperity):
    status, _, err = asperity("unloading", "--out", done, "--quick", "--seed", "8")
    assert status == 2
    assert "which is that of --seed 7; try another name" in err
    assert main(["status", str(done)]) == 2


def test_one_at_a_time(tmp_path, asperity):
    with TINY.prepared_in(tmp_path, quick=True):
        status, _, err = asperity("unloading", "--out", tmp_path, "--quick")
    assert status == 2
    assert "which another study unloading is writing; try waiting, or another name" in err


def test_an_unknown_study_in_python():
    with refuses("study"):
        studies.named("unload")


@pytest.mark.parametrize("study", studies.STUDIES.values(), ids=lambda study: study.name)
def test_campaigns_are_sound_and_the_full_ones_hold_the_quick(study, tmp_path):
    runs = {}
    for effort in ("quick", "full"):
        folder = tmp_path / effort
        with study.prepared_in(folder, quick=effort == "quick") as prepared:
            runs[effort] = {run.identity for one in prepared for run in one.plan.runs}
    assert runs["quick"] <= runs["full"]


def test_the_time_left_leaves_out_the_start_of_the_workers(monkeypatch, capsys):
    """The first run ends after 100 s, the others every 20 s: four runs take 80 s."""
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr("asperity.app.cli.campaign.clock", SimpleNamespace(monotonic=lambda: clock.now))
    with tally_shown(quiet=False) as show:
        for done, clock.now in ((0, 0.0), (1, 100.0), (2, 120.0)):
            show(Tally(6, done, 0, 1, {}))
    first, second, third = capsys.readouterr().err.splitlines()
    assert (first, second) == ("runs: 0 of 6", "runs: 1 of 6")
    assert third == "runs: 2 of 6, about 80 seconds left"
