"""The numbers on the pages of studies are those of their tables."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from asperity.fits import Estimate
from asperity_research.studies import STUDIES, typeset
from asperity_research.studies.ledger import Measurement

DOCS = Path(__file__).parents[3] / "docs"
DATA = DOCS / "data" / "studies"
PLAIN = "{value:.3f} [{low:.3f}, {high:.3f}]"
VERDICTS = f"| {{what}} | {PLAIN} | {{runs}} | {{own}} |"
PAGES = {study.page.removeprefix("docs/studies/").removesuffix(".md"): study for study in STUDIES.values()}


def span(name, digits):
    ends = [f"{{{one}:.{digits}f}}" for one in (name, f"{name}_low", f"{name}_high")]
    return "{} [{}, {}]".format(*ends)


# Each row of a table as it stands on the page: a text to format, or a function of the row.
ROWS: dict[str, dict[str, Any]] = {
    "activated_creep": {
        "powers": f"| `{{solid}}` | {{load_ratio:g}} | {span('depth', 3)} | {span('minimum', 2)} "
        f"| {span('growth', 2)} | {span('estimated', 2)} |",
        "rests": f"| {{kT:g}} | {span('rest', 4)} | {{s0_over_s:.4f}} | {span('steady', 4)} |",
        "ledger": VERDICTS,
    },
    "growth_rate": {
        "ledger": f"**{{claim}}** ({{place}}): **{{verdict}}**\n| {{what}} | {PLAIN} | {{runs}} |",
        "points": f"| {{of}}, {{surfaces}} | {{at:g}} | {span('B', 4)} | {{closed:.4f}} | {{relative:.4f}} |",
    },
    "logarithm": {"ledger": lambda row: logarithm_row(**row)},
    "patch_sizes": {
        "ledger": f"| {{claim}} | {{what}} | {PLAIN} | {{verdict}} |",
        "exponents": "| {of}, {hurst:g}, {pressure:g} "
        f"| {span('exponent', 2)} | {span('mean_size', 0)} |",
    },
    "pmma": {
        "numbers": lambda row: (
            span("pressure", 3)
            if row["family"] == "B = 0.02"
            else f"| {{family}} | {{at:.4g}} | {span('B', 4)} | {span('pressure', 3)} | {span('share', 2)} |"
        ).format_map(row),
        "ledger": VERDICTS,
    },
    "release": {
        "slopes": lambda row: release_row(**row),
        "waits": "| {side} × {side} | {from:g} to {to:g} | {slope:.3f} [{low:.3f}, {high:.3f}] | {runs} |",
    },
    "slide_hold_slide": {
        "laws": lambda row: law_row(row),
        "slips": f"| `{{family}}` | {{length:.2f}} | {span('slip', 2)} |",
        "lines": f"| `{{family}}` | {{length:.1f}} | {{patch:.1f}} | {span('slip', 1)} |",
        "ledger": VERDICTS,
    },
    "unloading": {"ledger": "| {what} | {typeset} | {runs} | {verdict} |"},
}


def release_row(solid, move, value, low, high, runs, measured, verdict):
    ratios = pd.read_csv(DATA / "release" / "ratios.csv")
    own = ratios[(ratios["solid"] == solid) & (ratios["move"] == move)]
    said = [f"{one:.2f}" for one in (*own["ratio"].iloc[[0, -1]], own["superposed_ratio"].iloc[-1])]
    what = PLAIN.format(value=value, low=low, high=high)
    what = what if measured == "slope" else f"{value:.0%} have a maximum"
    return f"| `{solid}` | {move:g} | {what} | {' | '.join(said)} | {runs} | {verdict} |"


def law_row(row):
    if row["events"] == "all":
        return ""
    found = f"{span('b', 3)} | {span('D_c', 2)}" if row["determined"] else "– | –"
    return f"| `{{solid}}` | {{load:g}} | {{events}} | {{law}} | {found} | {{misfit:.3f}} |".format_map(row)


def logarithm_row(what, value, low, high, runs, own, **_):
    numbers = (round(one, 4) + 0.0 for one in (value, low, high))
    start = "| {} | {:.4f} [{:.4f}, {:.4f}] |".format(what, *numbers)
    return re.compile(f"^{re.escape(start)}.*{re.escape(f'| {runs} | {own} |')}$", re.MULTILINE)


def rows_of(name):
    for table, said in ROWS[name].items():
        for row in pd.read_csv(DATA / name / f"{table}.csv").to_dict("records"):
            if table == "ledger":  # each number with its own verdict, whatever that of the claim
                value, low, high = (np.asarray(row[end]) for end in ("value", "low", "high"))
                found = Estimate(value, value, low, high, row["runs"])
                one = Measurement("", found, row["range_low"], row["range_high"])
                row |= {"own": one.verdict, "typeset": typeset.plain(str(typeset.interval(one.estimate)))}
            found = said(row) if callable(said) else said.format_map(row)
            if isinstance(found, re.Pattern):
                yield found
                continue
            for line in re.sub(r"nan( \[nan, nan\])?", "–", found).split("\n"):
                yield re.compile(re.escape(line))


@pytest.mark.parametrize("name", ROWS)
def test_every_row_of_a_table_stands_on_its_page_and_the_numbers_have_an_origin(name):
    study, page = PAGES[name], (DOCS / "studies" / f"{name}.md").read_text(encoding="utf-8")
    rows = list(rows_of(name))
    assert len(rows) > 3
    assert [row for row in rows if not row.search(page)] == []
    origin = tomllib.loads((DATA / name / "origin.toml").read_text(encoding="utf-8"))["origin"]
    assert (origin["study"], origin["effort"]) == (study.name, "full")
    assert origin["command"].startswith(f"asperity study {study.name}")
    listed = f"| [`{study.name}`](studies/{name}.md) | {study.question}"
    assert listed in (DOCS / "studies.md").read_text(encoding="utf-8")
    if name == "unloading":
        assert "{runs} runs (Asperity {version}, {date})".format_map(origin) in page


def test_every_study_has_its_page():
    assert sorted(PAGES) == sorted(ROWS)


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
