"""The numbers on the pages of studies are those of their tables."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from asperity.fits.resampling import Estimate
from asperity_research.studies import STUDIES, typeset
from asperity_research.studies.ledger import Measurement
from asperity_research.studies.typeset import plain

DOCS = Path(__file__).parents[3] / "docs"


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
    for row in pd.read_csv(data / "waits.csv").itertuples():
        found = f"{row.slope:.3f} [{row.low:.3f}, {row.high:.3f}]"
        yield f"| {row.side} × {row.side} | {row[2]:g} to {row.to:g} | {found} | {row.runs} |"


def interval(row, name, digits=2):
    ends = (row[name], row[f"{name}_low"], row[f"{name}_high"])
    return "{:.{d}f} [{:.{d}f}, {:.{d}f}]".format(*ends, d=digits) if ends[0] == ends[0] else "–"


def activated_creep_rows(data):
    for row in pd.read_csv(data / "powers.csv").to_dict("records"):
        said = [interval(row, name) for name in ("minimum", "growth", "estimated")]
        fell = interval(row, "depth", 3)
        yield f"| `{row['solid']}` | {row['load_ratio']:g} | {fell} | {' | '.join(said)} |"
    for row in pd.read_csv(data / "rests.csv").to_dict("records"):
        rest, steady = (interval(row, name, 4) for name in ("rest", "steady"))
        yield f"| {row['kT']:g} | {rest} | {row['s0_over_s']:.4f} | {steady} |"
    yield from verdict_rows(data)


def slide_hold_slide_rows(data):
    for row in pd.read_csv(data / "laws.csv").to_dict("records"):
        if row["events"] != "all":
            digits = {"b": 3, "D_c": 2}
            found = [interval(row, name, n) if row["determined"] else "–" for name, n in digits.items()]
            words = f"`{row['solid']}` | {row['load']:g} | {row['events']} | {row['law']}"
            yield f"| {words} | {' | '.join(found)} | {row['misfit']:.3f} |"
    for row in pd.read_csv(data / "slips.csv").to_dict("records"):
        yield f"| `{row['family']}` | {row['length']:.2f} | {interval(row, 'slip')} |"
    for row in pd.read_csv(data / "lines.csv").to_dict("records"):
        lengths = f"{row['length']:.1f} | {row['patch']:.1f}"
        yield f"| `{row['family']}` | {lengths} | {interval(row, 'slip', 1)} |"
    yield from verdict_rows(data)


def pmma_rows(data):
    numbers = pd.read_csv(data / "numbers.csv").to_dict("records")
    for row in numbers[:-1]:
        found = [interval(row, "B", 4), interval(row, "pressure", 3), interval(row, "share")]
        yield f"| {row['family']} | {row['at']:.4g} | {' | '.join(found)} |"
    yield interval(numbers[-1], "pressure", 3)
    yield from verdict_rows(data)


def verdict_rows(data):
    """Each number with its own verdict, whatever that of the claim."""
    for row in pd.read_csv(data / "ledger.csv").to_dict("records"):
        found = f"{row['value']:.3f} [{row['low']:.3f}, {row['high']:.3f}]"
        yield f"| {row['what']} | {found} | {row['runs']} | {verdict_of(row)} |"


def verdict_of(row):
    value, low, high = (np.asarray(row[name]) for name in ("value", "low", "high"))
    estimate = Estimate(value, np.asarray(np.nan), low, high, row["runs"])
    return Measurement(row["what"], estimate, row["range_low"], row["range_high"]).verdict


def logarithm_rows(data):
    for row in pd.read_csv(data / "ledger.csv").to_dict("records"):
        numbers = (round(row[name], 4) + 0.0 for name in ("value", "low", "high"))
        start = "| {} | {:.4f} [{:.4f}, {:.4f}] |".format(row["what"], *numbers)
        end = f"| {row['runs']} | {verdict_of(row)} |"
        yield re.compile(f"^{re.escape(start)}.*{re.escape(end)}$", re.MULTILINE)


def unloading_rows(data):
    for row in pd.read_csv(data / "ledger.csv").to_dict("records"):
        value, low, high = (np.array(row[name]) for name in ("value", "low", "high"))
        shown = plain(str(typeset.interval(Estimate(value, value, low, high, row["runs"]))))
        yield f"| {row['what']} | {shown} | {row['runs']} | {row['verdict']} |"
    origin = tomllib.loads((data / "origin.toml").read_text(encoding="utf-8"))["origin"]
    yield f"{origin['runs']} runs (Asperity {origin['version']}, {origin['date']})"


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
    "activated_creep": activated_creep_rows,
    "growth_rate": growth_rate_rows,
    "logarithm": logarithm_rows,
    "patch_sizes": patch_sizes_rows,
    "pmma": pmma_rows,
    "release": release_rows,
    "slide_hold_slide": slide_hold_slide_rows,
    "unloading": unloading_rows,
}


@pytest.mark.parametrize("name", ROWS)
def test_every_row_of_a_table_stands_on_its_page(name):
    page = (DOCS / "studies" / f"{name}.md").read_text(encoding="utf-8")
    rows = list(ROWS[name](DOCS / "data" / "studies" / name))
    assert len(rows) > 3
    assert [row for row in rows if not re.search(re.escape(row) if isinstance(row, str) else row, page)] == []


@pytest.mark.parametrize("name", ROWS)
def test_the_numbers_have_an_origin(name):
    path = DOCS / "data" / "studies" / name / "origin.toml"
    origin = tomllib.loads(path.read_text(encoding="utf-8"))["origin"]
    assert origin["study"] in STUDIES
    assert origin["effort"] == "full"
    assert origin["command"].startswith(f"asperity study {origin['study']}")
    study = STUDIES[origin["study"]]
    assert study.page == f"docs/studies/{name}.md"
    row = f"| [`{study.name}`](studies/{name}.md) | {study.question}"
    assert row in (DOCS / "studies.md").read_text(encoding="utf-8")


def test_every_study_has_its_page():
    pages = sorted(study.page for study in STUDIES.values())
    assert pages == [f"docs/studies/{name}.md" for name in sorted(ROWS)]


def test_the_sentences_on_the_release_hold():
    data = DOCS / "data" / "studies" / "release"
    slopes: Any = pd.read_csv(data / "slopes.csv").set_index("solid")
    ratios: Any = pd.read_csv(data / "ratios.csv")
    scale_free = slopes.loc[["logarithm", "power"]]
    assert (scale_free[["low", "high"]] - 1).abs().to_numpy().max() < 0.003
    of_half_spaces = ratios[ratios["solid"].isin(["logarithm", "power"])]
    assert (of_half_spaces["superposed_ratio"] / of_half_spaces["ratio"] - 1).abs().max() < 0.2
    for waits in (10, 100):
        ratio = ratios[(ratios["solid"] == "conserved") & (ratios["waiting"] == waits)]["ratio"]
        assert [round(one, 2) for one in ratio] == [0.23, 0.43 if waits == 10 else 0.44]
    assert list(slopes.loc["conserved", "verdict"]) == ["undecided", "agrees"]
