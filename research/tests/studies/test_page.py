"""The numbers that the page states are those of the tables beside it."""

import csv
import tomllib
from pathlib import Path

import numpy as np

import asperity_research.studies as studies
from asperity.fits.resampling import Estimate
from asperity_research.studies.typeset import interval, plain

DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "studies" / "unloading.md").read_text(encoding="utf-8")


def lines_of(ledger):
    """Lines of a table in Markdown, one for each number."""
    for row in ledger:
        value, low, high = (np.array(float(row[name])) for name in ("value", "low", "high"))
        estimate = Estimate(value, value, low, high, int(row["runs"]))
        shown = plain(str(interval(estimate)))
        yield f"| {row['what']} | {shown} | {row['runs']} | {row['verdict']} |"


def test_the_page_states_the_ledger():
    folder = DOCS / "data" / "studies" / "unloading"
    with (folder / "ledger.csv").open(encoding="utf-8") as stream:
        ledger = list(csv.DictReader(stream))
    assert ledger
    for line in lines_of(ledger):
        assert line in PAGE
    origin = tomllib.loads((folder / "origin.toml").read_text(encoding="utf-8"))["origin"]
    assert f"{origin['runs']} runs, Asperity {origin['version']}, {origin['date']}" in PAGE


def test_every_study_has_a_row_and_its_page():
    index = (DOCS / "studies.md").read_text(encoding="utf-8")
    for study in studies.STUDIES.values():
        assert f"| [`{study.name}`]({study.page.removeprefix('docs/')}) | {study.question}" in index
        assert (DOCS.parent / study.page).exists()
