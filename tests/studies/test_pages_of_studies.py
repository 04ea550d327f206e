"""The numbers on the pages of studies are those of their tables."""

import tomllib
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from asperity.studies import STUDIES

DOCS = Path(__file__).parents[2] / "docs"
PAGES = ("release", "slide_hold_slide", "patch_sizes", "growth_rate")


def release_rows(data):
    slopes = pd.read_csv(data / "slopes.csv")
    ratios = pd.read_csv(data / "ratios.csv")
    for row in slopes.itertuples():
        own = ratios[(ratios["solid"] == row.solid) & (ratios["move"] == row.move)]
        ends = [own["ratio"].iloc[at] for at in (0, -1)]
        linear = own["superposed_ratio"].iloc[-1]
        said = [f"{value:.2f}" if value == value else "–" for value in (*ends, linear)]
        found = f"{row.value:.3f} [{row.low:.3f}, {row.high:.3f}]"
        what = found if row.measured == "slope" else f"{row.value:.0%} have a maximum"
        yield f"| `{row.solid}` | {row.move:g} | {what} | {' | '.join(said)} | {row.runs} | {row.verdict} |"


def slide_hold_slide_rows(data):
    table: Any = pd.read_csv(data / "points.csv")
    for row in table.itertuples():
        at = f" {row.at:.4g}" if row.at == row.at else ""
        yield f"| {row.what}, {row.of}{at} | {row.value:.3f} [{row.low:.3f}, {row.high:.3f}] |"
    yield from ledger_rows(data)


def ledger_rows(data):
    for row in pd.read_csv(data / "ledger.csv").itertuples():
        yield f"| {row.claim} | {row.value:.2f} [{row.low:.2f}, {row.high:.2f}] | {row.verdict} |"


def patch_sizes_rows(data):
    for row in pd.read_csv(data / "ledger.csv").itertuples():
        found = f"{row.value:.3f} [{row.low:.3f}, {row.high:.3f}]"
        yield f"| {row.claim} | {row.what} | {found} | {row.verdict} |"
    for row in pd.read_csv(data / "exponents.csv").itertuples():
        found = f"{row.exponent:.2f} [{row.exponent_low:.2f}, {row.exponent_high:.2f}]"
        size = f"{row.mean_size:.0f} [{row.mean_size_low:.0f}, {row.mean_size_high:.0f}]"
        yield f"| {row.of}, {row.hurst:g}, {row.pressure:g} | {found} | {size} |"


def growth_rate_rows(data):
    for row in pd.read_csv(data / "ledger.csv").itertuples():
        yield f"**{row.claim}** ({row.place}): **{row.verdict}**"
        yield f"| {row.what} | {row.value:.3f} [{row.low:.3f}, {row.high:.3f}] | {row.runs} |"
    points: Any = pd.read_csv(data / "points.csv")
    for row in points.itertuples():
        found = f"{row.B:.4f} [{row.B_low:.4f}, {row.B_high:.4f}]"
        closed = f"{row.closed:.4f}" if row.closed == row.closed else "–"
        yield f"| {row.of}, {row.surfaces} | {row.at:g} | {found} | {closed} | {row.relative:.4f} |"


ROWS = {
    "release": release_rows,
    "slide_hold_slide": slide_hold_slide_rows,
    "patch_sizes": patch_sizes_rows,
    "growth_rate": growth_rate_rows,
}


@pytest.mark.parametrize("name", [name for name in PAGES if (DOCS / "studies" / f"{name}.md").exists()])
def test_every_row_of_a_table_stands_on_its_page(name):
    page = (DOCS / "studies" / f"{name}.md").read_text(encoding="utf-8")
    rows = list(ROWS[name](DOCS / "data" / "studies" / name))
    assert len(rows) > 3
    assert [row for row in rows if row not in page] == []


@pytest.mark.parametrize("name", [name for name in PAGES if (DOCS / "studies" / f"{name}.md").exists()])
def test_the_numbers_have_an_origin(name):
    path = DOCS / "data" / "studies" / name / "origin.toml"
    origin = tomllib.loads(path.read_text(encoding="utf-8"))["origin"]
    assert origin["study"] in STUDIES
    assert origin["effort"] == "full"
    assert origin["command"].startswith(f"asperity study {origin['study']}")
    assert STUDIES[origin["study"]].page == f"docs/studies/{name}.md"


def test_the_sentences_on_the_release_hold():
    data = DOCS / "data" / "studies" / "release"
    slopes: Any = pd.read_csv(data / "slopes.csv").set_index("solid")
    ratios: Any = pd.read_csv(data / "ratios.csv")
    scale_free = slopes.loc[["logarithm", "power"]]
    assert (scale_free[["low", "high"]] - 1).abs().to_numpy().max() < 0.003
    of_half_spaces = ratios[ratios["solid"].isin(["logarithm", "power"])]
    assert (of_half_spaces["superposed_ratio"] / of_half_spaces["ratio"] - 1).abs().max() < 0.2
    early = ratios[(ratios["solid"] == "conserved") & (ratios["waiting"] <= 100)]["ratio"]
    assert (round(early.min(), 2), round(early.max(), 2)) == (0.23, 0.5)
    assert slopes.loc["viscous", "low"] < 2 / 3 < slopes.loc["viscous", "high"]
    assert set(slopes.loc["conserved", "verdict"]) == {"undecided"}
