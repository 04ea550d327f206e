"""The step of rock on rock: our parameters beside those published, where the record is there."""

import os
from pathlib import Path

import pytest

from asperity.errors import InputError
from asperity_research import experiments
from asperity_research.experiments import p655

THERE = Path(os.environ.get("ASPERITY_DATA", ""), "friction", p655.FILE).is_file()


@pytest.mark.skipif(not THERE, reason="the record is not ours to give")
def test_no_published_number_is_contradicted_and_one_moves(tmp_path):
    done = experiments.run("p655", tmp_path / "out")
    verdicts = {finding.key: finding.verdict.value for finding in done.outcome.findings}
    assert verdicts["published slip 1600"] == "agrees"
    assert (verdicts["robust"], verdicts["moves"]) == ("agrees", "agrees")
    assert "differs" not in verdicts.values()
    rows = done.outcome.tables["parameters"]
    assert rows["misfit"].between(4.2e-4, 5.3e-4).all()
    best = rows.sort_values("misfit").iloc[0]
    assert (best["law"], best["stiffness"]) == ("slip", 1600)


def test_without_the_record_it_says_where_it_is(monkeypatch, tmp_path):
    monkeypatch.setenv("ASPERITY_DATA", str(tmp_path))
    with pytest.raises(InputError, match="PennStateRockandSedimentMechanics/xlook"):
        experiments.run("p655", tmp_path / "out")
    assert not (tmp_path / "out").exists()
