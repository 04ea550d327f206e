"""Gels under an AFM: what the solid of an approach predicts."""

import pytest

from asperity_research import experiments
from asperity_research.experiments import gels_2022


def test_the_numbers_have_a_source_and_rise_to_the_largest_force():
    for gel, peak in (("polyacrylamide", 3.7), ("agarose", 1.9)):
        for speed in gels_2022.SPEEDS:
            series = gels_2022.MEASURED.series[f"{gel}_{speed}"]
            assert series["force"].attrs["source"] == "gels"
            assert series["force"].values.max() == pytest.approx(peak, rel=0.1)


@pytest.mark.slow
def test_polyacrylamide_agrees_and_agarose_differs(tmp_path):
    done = experiments.run("gels-2022", tmp_path / "out")
    verdicts = {finding.key: finding.verdict.value for finding in done.outcome.findings}
    assert verdicts == {
        f"{gel} {speed}": word
        for gel, word in (("polyacrylamide", "agrees"), ("agarose", "differs"))
        for speed in gels_2022.SPEEDS
    }
    rows = done.outcome.tables["gels"]
    of = {gel: rows[rows["gel"] == gel]["deviation_contact_fitted"].to_numpy() for gel in gels_2022.GELS}
    assert of["agarose"].min() > 0.2
    assert of["polyacrylamide"].max() < 0.1
