"""The frame of studies: from campaign files to a report, resumed, and refused."""

import dataclasses
import shutil
from functools import partial
from types import SimpleNamespace
from unittest.mock import Mock

import pytest
from tests.refusals import refuses

import asperity_research.studies as studies
from asperity.app.campaign.sweeping import Tally
from asperity.app.cli import main
from asperity.app.cli.campaign import tally_shown
from asperity_research.paper.reproduce import PAPER
from asperity_research.studies import unloading
from research.tests.conftest import do_here

TINY = dataclasses.replace(studies.STUDIES["unloading"], quick=unloading.campaigns(surfaces=2, side=8))


@pytest.fixture
def study(monkeypatch, asperity):
    monkeypatch.setitem(studies.STUDIES, "unloading", TINY)
    return partial(asperity, "study")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "out"
    with TINY.prepared_in(folder, quick=True, seed=7) as prepared:
        do_here(prepared)
    return folder


def test_a_finished_study_is_reported_without_new_runs(done, study):
    status, out, err = study("unloading", "--out", done, "--quick", "--seed", "7")
    assert status == 0, err
    assert "campaign 1" not in err
    assert out.rstrip().endswith("report.md")
    report = (done / "report.md").read_text(encoding="utf-8")
    assert f"--out {done} --quick --seed 7" in report
    for name in ("figure.png", "figure.svg", "figure.pdf", "ledger.csv", "origin.toml", "data/dips.csv"):
        assert (done / name).stat().st_size > 100
    with TINY.prepared_in(done, quick=True, seed=7) as prepared:
        outcome = studies.conclude(TINY, done, prepared, quick=True, command="", seed=7).outcome
    assert all(f"**{one.claim}** ({one.place}): {one.verdict.value}." in report for one in outcome.findings)
    assert all(one.plan.seeds == (7, 8) for one in prepared)


def test_a_figure_that_fails_is_a_remark_and_no_loss(done, study, tmp_path, monkeypatch):
    folder = tmp_path / "again"
    shutil.copytree(done, folder)
    (folder / "report.md").unlink()
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", Mock(side_effect=IndexError("no axis fits")))
    status, _, err = study("unloading", "--out", folder, "--quick", "--seed", "7")
    assert status == 0, err
    assert "remark: the figure could not be drawn: no axis fits" in err
    assert (folder / "report.md").exists()


def test_the_list_and_what_a_study_takes(done, study):
    status, out, _ = study()
    assert status == 0
    for one in studies.STUDIES.values():
        assert f"{one.name} " in out
        assert one.question in out
    status, out, _ = study("unloading", "--quick", "--dry-run", "--out", done, "--seed", "7")
    assert (status, len(out.splitlines())) == (0, 1 + len(TINY.quick))


@pytest.fixture(params=["study unloading", "reproduce"])
def command(request, monkeypatch, tmp_path, capsys):
    """A command that has a folder, called in an empty one; and who owns what it writes there."""
    monkeypatch.setitem(studies.STUDIES, "unloading", TINY)
    monkeypatch.chdir(tmp_path)

    def refused(*words):
        assert main([*request.param.split(), *words]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        return said.err

    if request.param == "reproduce":
        return refused, "reproduction", partial(PAPER.prepared_in, quick=True)
    return refused, "study unloading", partial(TINY.prepared_in, quick=True)


def test_mistakes_leave_everything_as_it_is(tmp_path, command):
    refused, owner, _ = command
    (tmp_path / "file").write_text("mine")
    (tmp_path / "full" / "studies").mkdir(parents=True)
    (tmp_path / "full" / "thesis.tex").write_text("mine")
    for words, complaint in (
        ("--out new --seed -1", "seed: expected 0 or more, got -1"),
        ("--out new --seed 1.5", "--seed: expected a whole number, got 1.5"),
        ("--out new --workers 0", "--workers: expected 1 or more, got 0"),
        ("--out file", "expected a folder, got file, which is a file"),
        ("--out full", "expected a new folder, or that of "),
    ):
        said = refused(*words.split())
        assert complaint in said
        assert (owner in said) is complaint.endswith("that of ")
    found = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*"))
    assert found == ["file", "full", "full/studies", "full/thesis.tex"]


def test_a_folder_is_for_one_seed_and_for_one_at_a_time(command):
    refused, owner, prepare = command
    with prepare("out", seed=3):
        busy = refused("--out", "out", "--quick", "--seed", "3")
    assert f"which another {owner} is writing; try waiting, or another name" in busy
    other = refused("--out", "out", "--quick", "--seed", "4")
    assert "which is that of --seed 3; try another name" in other
    assert main(["status", "out"]) == 2


def test_an_unknown_study_in_python(study):
    assert "study: expected one of unloading" in study("unloadin")[2]
    with refuses("study", "'unload'"):
        studies.named("unload")


@pytest.mark.parametrize("study", [*studies.STUDIES.values(), PAPER], ids=lambda study: study.name)
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
