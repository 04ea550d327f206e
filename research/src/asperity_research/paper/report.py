"""The report of a reproduction: one page that needs no network, beside its figures, numbers and ledger."""

import base64
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

import asperity_research.studies.report as reporting
from asperity.app.config import RunConfig
from asperity_research.paper.corrections import corrections
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure
from asperity_research.paper.places import SECTIONS, numbered, section_of
from asperity_research.studies.ledger import Finding, Measurement
from asperity_research.studies.report import About, write_drawing, write_table
from asperity_research.studies.typeset import interval, plain, rich


def write_report(
    folder: Path, figures: Sequence[PaperFigure], findings: Sequence[Finding], about: About
) -> Path:
    """Write figures, the numbers behind them, the ledger, and the page that explains them; return the page.

    ``figures/figure-N.svg``, ``.pdf`` and ``.png``, ``data/figure-N-TABLE.csv``, ``ledger.csv``,
    ``ledger.md`` (the verdicts as one table) and, last, ``report.html``. The findings stand in the order of
    the paper.
    """
    sections = {name: [one for one in findings if section_of(one.place) == name] for name in SECTIONS}
    ordered = [finding for some in sections.values() for finding in some]
    return reporting.write_report(
        folder,
        "asperity_research.paper",
        ["ledger.md", "report.html"],
        ordered,
        spelled=rich_numbered,
        about=about,
        pictures=[_write_figure(folder, figure) for figure in figures],
        ledger=sections,
        tally=Counter(finding.verdict for finding in ordered),
        corrections=corrections(),
        usual=RunConfig(),
        numbers=_numbers,
        SECTIONS=SECTIONS,
    )


def _write_figure(folder: Path, figure: PaperFigure) -> dict[str, Any]:
    """Write the drawing in three formats and its tables; return what the page shows and links to."""
    name = f"figure-{figure.number}"
    written = write_drawing(folder / "figures", name, figure.figure)
    tables = [
        write_table(folder / "data", f"{name}-{table}", numbers) for table, numbers in figure.tables.items()
    ]
    encoded = base64.b64encode(written["svg"].read_bytes()).decode("ascii")
    return {
        "figure": figure,
        "source": f"data:image/svg+xml;base64,{encoded}",
        "files": [path.relative_to(folder).as_posix() for path in (*written.values(), *tables)],
        "wide": figure.figure.get_figwidth() > COLUMN,  # too much for a telephone
    }


def rich_numbered(text: str) -> Markup:
    """Make HTML of a text, whose equations get their numbers for their labels, as in Eq. (17)."""
    return rich(numbered(text))


def _numbers(measured: Sequence[Measurement]) -> str:
    """Spell different numbers of a claim in plain text; equal ones once."""
    return "; ".join(dict.fromkeys(plain(interval(one.estimate)) for one in measured))
