"""The report of a reproduction: one page that needs no network, beside its figures, numbers and ledger."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

import asperity_research.studies.report as reporting
from asperity.app.config import RunConfig
from asperity.errors import InputError
from asperity_research.paper.corrections import corrections
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure
from asperity_research.paper.places import SECTIONS, numbered, section_of
from asperity_research.studies.ledger import Finding, Measurement
from asperity_research.studies.report import About, file_name, write_drawing, write_table
from asperity_research.studies.typeset import interval, plain, rich

_LARGEST_SVG = 1_500_000


@dataclass(frozen=True)
class _Picture:
    """A figure as it stands on the page; the first of its files is the drawing that has no pixels."""

    figure: PaperFigure
    source: str
    files: tuple[str, ...]

    @property
    def wide(self) -> bool:
        """Whether it takes the width of a page: too much for a telephone."""
        return self.figure.figure.get_figwidth() > COLUMN


def write_report(
    folder: Path, figures: Sequence[PaperFigure], findings: Sequence[Finding], about: About
) -> Path:
    """Write figures, the numbers behind them, the ledger, and the page that explains them; return the page.

    ``figures/figure-N.svg``, ``.pdf`` and ``.png``, ``data/figure-N-TABLE.csv``, ``ledger.csv``,
    ``ledger.md`` (the verdicts as one table) and, last, ``report.html``. The page has figures and findings in
    the order of the paper. `InputError`, and nothing is written, if two figures, findings or tables of a
    figure go by one name, or a text has a tag that is not closed.
    """
    _check(figures, findings)
    pictures = [_write_figure(folder, figure) for figure in sorted(figures, key=lambda one: one.number)]
    ordered = sorted(findings, key=lambda finding: list(SECTIONS).index(section_of(finding.place)))
    return reporting.write_report(
        folder,
        "asperity_research.paper",
        ["ledger.md", "report.html"],
        ordered,
        spelled=rich_numbered,
        about=about,
        pictures=pictures,
        ledger={name: [f for f in ordered if section_of(f.place) == name] for name in SECTIONS},
        tally=Counter(finding.verdict for finding in ordered),
        corrections=corrections(),
        usual=RunConfig(),
        numbers=_numbers,
        SECTIONS=SECTIONS,
    )


def _check(figures: Sequence[PaperFigure], findings: Sequence[Finding]) -> None:
    _check_distinct("figures", [str(figure.number) for figure in figures])
    _check_distinct("findings", [finding.key for finding in findings])
    for figure in figures:
        _check_distinct("tables", [file_name(name) for name in figure.tables])
        rich_numbered(figure.title), rich_numbered(figure.caption)
    for finding in findings:
        for text in (finding.place, finding.claim, finding.correction, finding.note):
            rich_numbered(text)
        for measurement in (*finding.measured, *finding.corrected):
            rich_numbered(measurement.what)


def _check_distinct(name: str, keys: list[str]) -> None:
    if twice := [key for key, count in Counter(keys).items() if count > 1]:
        raise InputError(name, expected="each under a name of its own", got=f"{twice[0]} twice")


def _write_figure(folder: Path, figure: PaperFigure) -> _Picture:
    """Write the drawing in three formats and its tables, and choose what the page shows."""
    name = f"figure-{figure.number}"
    written = write_drawing(folder / "figures", name, figure.figure)
    tables = [
        write_table(folder / "data", f"{name}-{table}", figure.tables[table]) for table in figure.tables
    ]
    shown, kind = written["svg"], "image/svg+xml"
    if shown.stat().st_size > _LARGEST_SVG:
        shown, kind = written["png"], "image/png"
    encoded = base64.b64encode(shown.read_bytes()).decode("ascii")
    drawings = tuple(f"figures/{path.name}" for path in written.values())
    numbers = tuple(f"data/{path.name}" for path in tables)
    return _Picture(figure, f"data:{kind};base64,{encoded}", drawings + numbers)


def rich_numbered(text: str) -> Markup:
    """Make HTML of a text, whose equations get their numbers for their labels, as in Eq. (17)."""
    return rich(numbered(text))


def _numbers(measured: Sequence[Measurement]) -> str:
    """Spell different numbers of a claim in plain text; equal ones once."""
    return "; ".join(dict.fromkeys(plain(interval(one.estimate)) for one in measured))
