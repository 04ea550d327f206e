"""The whole reproduction, on tiny lattices: from studies to the report, and as a command."""

import csv
import re
import shutil
from contextlib import nullcontext

import pytest
from tests.refusals import refuses

from asperity.app.campaign import read_plan, tally
from asperity.app.campaign.store import Store
from asperity.app.cli import main
from asperity.errors import InputError
from asperity_research.commands import study as working
from asperity_research.paper import reproduce as reproducing
from asperity_research.paper.claims import ledger
from asperity_research.paper.studies import QUICK, studies
from asperity_research.studies import STUDIES as OTHERS
from asperity_research.studies import conclude
from asperity_research.studies.campaigns import run_campaigns
from asperity_research.studies.evidence import Evidence
from research.tests.conftest import do_here
from research.tests.paper.conftest import TINY

pytestmark = pytest.mark.xdist_group("reproduction")  # one process computes it


class _NothingIsRunError(Exception):
    """Ends a command when its campaigns are written."""


@pytest.fixture
def reproduce(reproduction, monkeypatch, capsys):
    """The command in the folder of the reproduction."""
    monkeypatch.setattr(reproducing, "PAPER", TINY)

    def call(*flags):
        status = main(["reproduce", "--out", str(reproduction[0]), "--quick", "--seed", "3", *flags])
        assert status == 0
        return capsys.readouterr()

    return call


def test_report_of_finished_studies(reproduction, evidence, reproduce):
    folder, _ = reproduction
    out, err = reproduce()
    assert "campaign" not in err  # nothing was left to run
    assert out.rstrip().endswith("report.html")
    findings = ledger(evidence)
    assert re.search(rf"^claims +{len(findings)}$", out, re.MULTILINE)
    page = (folder / "report.html").read_text(encoding="utf-8")
    for number in range(1, 10):
        for suffix in ("svg", "pdf", "png"):
            assert (folder / "figures" / f"figure-{number}.{suffix}").stat().st_size > 1000
        assert list((folder / "data").glob(f"figure-{number}-*.csv"))
        assert f"figure-{number}.pdf" in page
    with (folder / "ledger.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["key"]: row["verdict"] for row in rows} == {f.key: f.verdict.value for f in findings}
    # No name of a symbol is left where the symbol should stand. Style sheets and BibTeX have braces too.
    words = re.sub(r"(?s)<(style|pre)\b.*?</\1>", "", page).splitlines()
    assert not [text for text in words if {*text} & {*"{}"}]
    assert not [text for row in rows for text in row.values() if {*text} & {*"{}"}]
    assert "--seed 3" in page


def test_only_what_is_missing_is_run(reproduction, reproduce):
    sketch = next(one for one in reproduction[1] if one.campaign.name == "sketch")
    (run,) = sketch.plan.runs
    shutil.rmtree(sketch.folder / "runs.zarr" / run.identity)
    assert tally(sketch.plan, sketch.folder).done == 0
    _, err = reproduce("--workers", "1")
    assert err.count("campaign") == 1
    assert sketch.campaign.purpose in err
    assert tally(sketch.plan, sketch.folder).done == 1
    assert re.search(r"^all +0 runs", reproduce("--dry-run").out, re.MULTILINE)


def test_every_study_is_an_ordinary_campaign(tmp_path):
    with TINY.prepared_in(tmp_path, quick=True) as prepared:
        for one in prepared:
            plan = read_plan(one.folder / "campaign.toml")
            assert [run.identity for run in plan.runs] == [run.identity for run in one.plan.runs]


@pytest.mark.parametrize("words", [("reproduce",), *(("study", name) for name in OTHERS)], ids=" ".join)
def test_another_seed_is_of_other_surfaces(tmp_path, monkeypatch, words):
    def seeds(first):
        folder = tmp_path / str(first)
        asked = [*words, "--out", str(folder), "--quick", "--seed", str(first)]
        with pytest.raises(_NothingIsRunError):
            main(asked)
        files = sorted(folder.glob("*/*/campaign.toml"))
        return {path.parent.name: read_plan(path).seeds for path in files}

    def stop(*_, **__):
        raise _NothingIsRunError

    monkeypatch.setattr(working, "run_campaigns", stop)
    here, there = seeds(0), seeds(3)
    assert set(here) == set(there)
    assert any(here.values())
    for name, of_this in here.items():
        assert of_this == tuple(range(len(of_this)))  # none for the surfaces that are files
        assert there[name] == tuple(seed + 3 for seed in of_this)


def test_seeds_that_are_a_list_are_not_taken_for_other_seeds():
    with refuses("seeds of sketch", "[0]"):
        next(one for one in studies(QUICK) if one.name == "sketch").seeded(0).seeded(3)


def test_an_unfinished_study_is_not_judged(tmp_path):
    with TINY.prepared_in(tmp_path / "out", quick=True) as prepared:
        one = next(each for each in prepared if each.campaign.name == "sketch")
        do_here([one])
        with pytest.raises(InputError, match="campaign"):
            conclude(TINY, tmp_path / "out", prepared, quick=True, command="")
        Store(one.folder).runs.joinpath(one.plan.runs[0].identity, "zarr.json").unlink()
    assert not (tmp_path / "out" / "report.html").exists()


def test_a_folder_swept_with_another_plan_is_read_by_this_one(tmp_path):
    with TINY.prepared_in(tmp_path / "out", quick=True) as prepared:
        one = next(each for each in prepared if each.campaign.name == "sketch")
        do_here([one])
        (one.folder / "plan.json").write_text("{}")
        run_campaigns([one], workers=1, watch=lambda _: nullcontext(lambda _: None))
    assert Evidence(tmp_path / "out" / TINY.home.inside)["sketch"].attrs["finished"] == 1
