"""The numbers on the pages of studies are those of their tables."""

import importlib.util
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from asperity_research.studies import STUDIES

DOCS = Path(__file__).parents[3] / "docs"
DATA = DOCS / "data" / "studies"
PAGES = {study.page.removeprefix("docs/studies/").removesuffix(".md"): study for study in STUDIES.values()}
TABLE = re.compile(r"```\{(ledger|rows)\} (\S+)\n(.*?)```", re.DOTALL)


@pytest.fixture(scope="module")
def numbers():
    """The module that makes tables for the pages."""
    pytest.importorskip("docutils")
    spec: Any = importlib.util.spec_from_file_location("numbers", DOCS / "_ext" / "numbers_of_studies.py")
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(DOCS / "_ext")
        spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", PAGES)
def test_the_tables_of_a_page_can_be_made_and_their_numbers_have_an_origin(name, numbers):
    study, page = PAGES[name], (DOCS / "studies" / f"{name}.md").read_text(encoding="utf-8")
    found = TABLE.findall(page)
    assert ("ledger", name) in [one[:2] for one in found]
    for kind, of_what, content in found:
        lines = content.splitlines()
        made = numbers.ledger(of_what) if kind == "ledger" else numbers.rows(of_what, lines)
        assert len(made) > 3
        assert not [line for line in made if "nan" in line.lower() or "{" in line]
    origin = tomllib.loads((DATA / name / "origin.toml").read_text(encoding="utf-8"))["origin"]
    assert (origin["study"], origin["effort"]) == (study.name, "full")
    assert origin["command"].startswith(f"asperity study {study.name}")
    listed = f"| [`{study.name}`](studies/{name}.md) | {study.question}"
    assert listed in (DOCS / "studies.md").read_text(encoding="utf-8")
    assert "{runs} runs (Asperity {version}, {date})".format_map(origin) in page


def test_a_number_has_its_interval_and_a_dash_where_it_is_not_determined(numbers):
    row = numbers.numbers_of(
        {"b": 0.25, "b_low": 0.125, "b_high": 0.5, "runs": 3, "misfit": 1.5, "none": math.nan}
    )
    assert "{b:2} {b:.1f} {runs} {misfit:.2f} {none:1}".format_map(row) == "0.25 [0.12, 0.50] 0.2 3 1.50 –"
    undetermined = numbers.numbers_of({"b": 0.25, "b_low": -1e9, "b_high": 1e9, "determined": False})
    assert f"{undetermined['b']:2}" == "–"
    for low, high, verdict in ((0.95, 1.0, "agrees"), (0.8, 0.89, "differs"), (0.8, 1.0, "undecided")):
        decided = {"range_low": 0.9, "range_high": 1.1, "low": low, "high": high}
        assert numbers.verdict_of(decided) == verdict


def test_the_sentences_on_the_release_hold():
    slopes: Any = pd.read_csv(DATA / "release" / "slopes.csv").set_index("solid")
    ratios: Any = pd.read_csv(DATA / "release" / "ratios.csv")
    scale_free = slopes.loc[["logarithm", "power"]]
    assert (scale_free[["low", "high"]] - 1).abs().to_numpy().max() < 0.003
    of_half_spaces = ratios[ratios["solid"].isin(["logarithm", "power"])]
    assert (of_half_spaces["superposed_ratio"] / of_half_spaces["ratio"] - 1).abs().max() < 0.2
    for waits in (10, 100):
        ratio = ratios[(ratios["solid"] == "conserved") & (ratios["waiting"] == waits)]["ratio"]
        assert [round(one, 2) for one in ratio] == [0.23, 0.43 if waits == 10 else 0.44]
    assert list(slopes.loc["conserved", "verdict"]) == ["undecided", "agrees"]
