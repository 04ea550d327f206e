"""The report of a reproduction: one page that needs no network, beside its figures, numbers and ledger.

The page is written last: where it stands, all that it links to is there.
"""

from __future__ import annotations

import base64
import datetime
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2
import matplotlib as mpl
import pandas as pd
from markupsafe import Markup, escape

from asperity.config.models import RunConfig
from asperity.errors import InputError, OutputError
from asperity.paper.corrections import corrections
from asperity.paper.figures.paper_figure import COLUMN, PaperFigure
from asperity.paper.ledger import Finding, Measurement, Verdict
from asperity.paper.places import SECTIONS, section_of
from asperity.paper.studies import Study
from asperity.paper.typeset import bounds, interval, number, plain, rich
from asperity.results.store import whole_file
from asperity.words import duration

_LARGEST_SVG = 1_500_000
_RESOLUTION = 250


@dataclass(frozen=True)
class Simulated:
    """A study as it was run.

    Attributes
    ----------
    study
        Its conditions.
    runs
        Finished runs.
    folder
        Where it lies, relative to the report; holds ``campaign.toml``.
    """

    study: Study
    runs: int
    folder: str

    @property
    def conditions(self) -> list[Markup]:
        """Its tables, a line each."""
        return [
            Markup("; ").join(
                Markup("{} = {}").format(name, _brief(name, value))
                for name, value in table.items()
                if name != "seeds"
            )
            for table in self.study.tables.values()
        ]

    @property
    def seeds(self) -> Markup:
        """Its seeds, or a dash for a surface that has none."""
        return _brief("seeds", self.study.tables["sweep"].get("seeds", "–"))


@dataclass(frozen=True)
class About:
    """Where a report comes from.

    Attributes
    ----------
    effort
        ``"quick"`` or ``"full"``.
    version
        Of Asperity.
    date
        Of the report.
    command
        The command line that made it.
    wall_seconds, run_seconds
        From the last start of the command to its end, and summed over all runs; NaN where unknown.
    studies
        What was simulated.
    """

    effort: str
    version: str
    date: datetime.date
    command: str
    wall_seconds: float
    run_seconds: float
    studies: tuple[Simulated, ...]


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
    """Write the figures, the numbers behind them, the ledger, and the page that explains them.

    Parameters
    ----------
    folder
        Where to: ``figures/figure-N.svg``, ``.pdf`` and ``.png``, ``data/figure-N-TABLE.csv``,
        ``ledger.csv``, ``ledger.md`` (the verdicts as one table) and, last, ``report.html``. What is there
        under these names is replaced.
    figures, findings
        In any order; the page has them in the paper's, and findings of one section as they come.
    about
        Where all this comes from.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        Two figures, two findings or two tables of a figure go by one name, or a text has a tag that is not
        closed. Nothing is written.
    OutputError
        The disk refused. Every file that stands is whole.
    """
    _check(figures, findings)
    for name in ("figures", "data"):
        try:
            (folder / name).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"could not write {folder / name}: {error.strerror or error}") from error
    pictures = [_write_figure(folder, figure) for figure in sorted(figures, key=lambda one: one.number)]
    ordered = sorted(findings, key=lambda finding: list(SECTIONS).index(section_of(finding.place)))
    _write_table(folder / "ledger.csv", ledger_table(ordered))
    templates = _templates()
    for name in ("ledger.md", "report.html"):
        page = templates.get_template(name).render(
            about=about,
            pictures=pictures,
            findings=ordered,
            ledger={name: [f for f in ordered if section_of(f.place) == name] for name in SECTIONS},
            tally=Counter(finding.verdict for finding in ordered),
            corrections=corrections(),
            usual=RunConfig(),
        )
        with whole_file(folder / name) as part:
            part.write_text(page, encoding="utf-8")
    return folder / "report.html"


def ledger_table(findings: Iterable[Finding]) -> pd.DataFrame:
    """Return the ledger with one row a measurement, in plain text and full precision."""
    return pd.DataFrame(
        {
            "key": finding.key,
            "place": plain(finding.place),
            "claim": plain(finding.claim),
            "verdict": finding.verdict.value,
            "judged": judged,
            "what": plain(measurement.what),
            "value": float(measurement.estimate.value),
            "low": float(measurement.estimate.low),
            "high": float(measurement.estimate.high),
            "range_low": measurement.low,
            "range_high": measurement.high,
            "runs": measurement.estimate.runs,
            "correction": plain(finding.correction),
            "note": plain(finding.note),
            "needs": finding.needs,
        }
        for finding in findings
        for judged, part in (("as it stands", finding.measured), ("corrected", finding.corrected))
        for measurement in part
    )


def _check(figures: Sequence[PaperFigure], findings: Sequence[Finding]) -> None:
    _check_distinct("figures", [str(figure.number) for figure in figures])
    _check_distinct("findings", [finding.key for finding in findings])
    for figure in figures:
        _check_distinct("tables", [_table_file(figure, name) for name in figure.tables])
        rich(figure.title), rich(figure.caption)
    for finding in findings:
        for text in (finding.place, finding.claim, finding.correction, finding.note):
            rich(text)
        for measurement in (*finding.measured, *finding.corrected):
            rich(measurement.what)


def _check_distinct(name: str, keys: list[str]) -> None:
    if twice := [key for key, count in Counter(keys).items() if count > 1]:
        raise InputError(name, expected="each under a name of its own", got=f"{twice[0]} twice")


def _write_figure(folder: Path, figure: PaperFigure) -> _Picture:
    """Write the drawing in three formats and its tables, and choose what the page shows."""
    written: dict[str, Path] = {}
    for suffix, metadata in (("svg", {"Date": None}), ("pdf", {"CreationDate": None}), ("png", {})):
        path = folder / "figures" / f"figure-{figure.number}.{suffix}"
        # Letters as paths, so that the page looks the same where a font is missing.
        with whole_file(path) as part, mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "asperity"}):
            figure.figure.savefig(part, format=suffix, dpi=_RESOLUTION, metadata=metadata)
        written[suffix] = path
    for name, table in figure.tables.items():
        _write_table(folder / "data" / _table_file(figure, name), table)
    shown, kind = written["svg"], "image/svg+xml"
    if shown.stat().st_size > _LARGEST_SVG:
        shown, kind = written["png"], "image/png"
    encoded = base64.b64encode(shown.read_bytes()).decode("ascii")
    drawings = tuple(f"figures/{path.name}" for path in written.values())
    tables = tuple(f"data/{_table_file(figure, name)}" for name in figure.tables)
    return _Picture(figure, f"data:{kind};base64,{encoded}", drawings + tables)


def _table_file(figure: PaperFigure, name: str) -> str:
    return f"figure-{figure.number}-{re.sub(r'[^A-Za-z0-9_]+', '-', name).strip('-')}.csv"


def _write_table(path: Path, table: pd.DataFrame) -> None:
    with whole_file(path) as part:
        table.to_csv(part, index=False)


def _templates() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("asperity.paper", "templates"),
        autoescape=jinja2.select_autoescape(),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "rich": rich,
        "plain": plain,
        "number": number,
        "interval": interval,
        "duration": duration,
        "file_name": lambda path: Path(path).name,
    }
    environment.globals |= {
        "bounds": bounds,
        "numbers": _numbers,
        "Verdict": Verdict,
        "SECTIONS": SECTIONS,
    }
    return environment


def _numbers(measured: Sequence[Measurement]) -> str:
    """Spell different numbers of a claim in plain text; equal ones once."""
    return "; ".join(dict.fromkeys(plain(interval(one.estimate)) for one in measured))


def _brief(name: str, value: object) -> Markup:
    """A value of a campaign file in words: a shape as 200 × 200, a long list by its ends."""
    if not isinstance(value, list):
        return number(value) if isinstance(value, float) else escape(value)
    words = [_brief(name, item) for item in value]
    if name == "shape":
        return Markup("\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}").join(words)
    ends = Markup("{} to {}").format(words[0], words[-1])
    if name == "seeds" and value == list(range(value[0], value[-1] + 1)) and len(value) > 1:
        return ends
    return Markup(", ").join(words) if len(words) <= 6 else Markup("{} ({} values)").format(ends, len(words))
