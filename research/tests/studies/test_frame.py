"""The frame of studies: from campaign files to a report, resumed, and refused."""

import dataclasses
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.refusals import refuses

import asperity_research.studies as studies
from asperity.app.campaign import read_plan
from asperity.app.campaign.sweeping import Tally
from asperity.app.cli import main
from asperity.app.cli.campaign import tally_shown
from asperity.errors import InputError
from asperity_research.paper.reproduce import prepared_in
from asperity_research.paper.studies import QUICK
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


@pytest.fixture(params=["study unloading", "reproduce"])
def command(request, monkeypatch, tmp_path, capsys):
    """A command that has a folder, called in an empty one; and who owns what it writes there."""
    monkeypatch.setitem(studies.STUDIES, "unloading", TINY)
    monkeypatch.chdir(tmp_path)

    def call(*words):
        status = main([*request.param.split(), *map(str, words)])
        said = capsys.readouterr()
        assert (status, said.out) == (2, "")
        return said.err

    if request.param == "reproduce":
        prepare, owner = partial(prepared_in, effort=QUICK), "a reproduction"
    else:
        prepare, owner = partial(TINY.prepared_in, quick=True), "the study unloading"
    return SimpleNamespace(call=call, owner=owner, prepared_in=prepare)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--out", "new", "--seed", "-1"], "seed: expected 0 or more, got -1"),
        (["--out", "new", "--seed", "1.5"], "--seed: expected a whole number, got 1.5"),
        (["--out", "new", "--workers", "0"], "--workers: expected 1 or more, got 0"),
        (["--out", "file"], "expected a folder, got file, which is a file"),
        (["--out", "full"], "expected a new folder, or that of OWNER"),
    ],
)
def test_mistakes(tmp_path, command, words, complaint):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "full" / "studies").mkdir(parents=True)
    (tmp_path / "full" / "thesis.tex").write_text("mine")
    assert complaint.replace("OWNER", command.owner) in command.call(*words)
    found = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*"))
    assert found == ["file", "full", "full/studies", "full/thesis.tex"]


def test_another_seed_wants_another_folder(command):
    with command.prepared_in("out", seed=3):
        pass
    assert "which is that of --seed 3; try another name" in command.call(
        "--out", "out", "--quick", "--seed", "4"
    )
    assert main(["status", "out"]) == 2


def test_one_at_a_time(command):
    with command.prepared_in("out"):
        complaint = command.call("--out", "out", "--quick")
    kind = command.owner.removeprefix("a ").removeprefix("the ")
    assert f"which another {kind} is writing; try waiting, or another name" in complaint


def test_a_negative_seed_is_refused_in_python(command):
    with pytest.raises(InputError, match="seed: expected 0 or more"), command.prepared_in("out", seed=-1):
        pass
    assert not Path("out").exists()


def test_an_unknown_study_in_python(asperity):
    assert "study: expected one of unloading" in asperity("unloadin")[2]  # and by the command
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
