"""Reports of studies and of the reproduction: pages from templates, drawings, tables and ledgers."""

import datetime
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any, Self

import jinja2
import matplotlib as mpl
import pandas as pd
from markupsafe import Markup, escape
from matplotlib.figure import Figure

import asperity as asp
from asperity.base.words import duration
from asperity.errors import OutputError
from asperity.results import whole_file
from asperity_research.studies.campaigns import Campaign, Prepared, finished
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Outcome, Verdict
from asperity_research.studies.typeset import bounds, interval, number, plain, rich


@dataclass(frozen=True)
class Simulated:
    """A campaign as it was run: its finished runs, and its folder, relative to the report."""

    campaign: Campaign
    runs: int
    folder: str

    @property
    def conditions(self) -> list[Markup]:
        """Its tables, and each of a list of tables, a line each."""
        tables = [each if isinstance(each, list) else [each] for each in self.campaign.tables.values()]
        return [
            Markup("; ").join(
                Markup("{} = {}").format(key, _brief(key, value))
                for key, value in one.items()
                if key != "seeds"
            )
            for one in chain.from_iterable(tables)
        ]

    @property
    def seeds(self) -> Markup:
        """Its seeds, or a dash for a surface that has none."""
        return _brief("seeds", self.campaign.tables["sweep"].get("seeds", "–"))


@dataclass(frozen=True)
class About:
    """Where a report comes from: effort, command, what was simulated, version and date.

    Seconds of all runs together, and from the last start of the command to its end; NaN where unknown. The
    seed is the first of every ensemble.
    """

    effort: str
    command: str
    studies: tuple[Simulated, ...]
    run_seconds: float
    wall_seconds: float = math.nan
    version: str = asp.__version__
    date: datetime.date = field(default_factory=lambda: datetime.datetime.now(datetime.UTC).date())
    seed: int = 0

    @classmethod
    def of(
        cls, evidence: Evidence, prepared: Sequence[Prepared], effort: str, command: str, **more: Any
    ) -> Self:
        """Say it of campaigns that are finished; `AsperityError` if one is not."""
        runs = finished(evidence, prepared)
        simulated = tuple(
            Simulated(one.campaign, runs[one.campaign.name], f"{evidence.folder.name}/{one.campaign.name}")
            for one in prepared
        )
        seconds = sum(float(evidence[name]["seconds"].sum()) for name in runs)
        return cls(effort, command, simulated, seconds, **more)

    @property
    def runs(self) -> int:
        """Number of all runs."""
        return sum(one.runs for one in self.studies)


def write_report(
    folder: Path,
    package: str,
    pages: Sequence[str],
    findings: Sequence[Finding],
    *,
    spelled: Callable[[str], Markup] = rich,
    **facts: Any,
) -> Path:
    """Write ``ledger.csv``, and pages of findings and facts by the templates of a package; return the last.

    The pages come after all that they link to: where they stand, it is there. ``spelled`` makes HTML of a
    text. `OutputError` if the disk refused; every file that stands is whole.
    """
    write_table(folder, "ledger", Outcome(tuple(findings)).table())
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(package, "templates"),
        autoescape=jinja2.select_autoescape(),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "rich": spelled,
        "plain": plain,
        "number": number,
        "interval": interval,
        "duration": duration,
        "file_name": lambda path: Path(path).name,
    }
    environment.globals |= {"bounds": bounds, "Verdict": Verdict, "findings": findings, **facts}
    for name in pages:
        write_text(folder / name, environment.get_template(name).render())
    return folder / pages[-1]


def write_text(path: Path, text: str) -> None:
    """Write a file that is whole or not there; `OutputError` if the disk refused."""
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")


def write_drawing(folder: Path, name: str, figure: Figure) -> dict[str, Path]:
    """Write a drawing as ``NAME.svg``, ``.pdf`` and ``.png``; return its files by their suffixes.

    `OutputError` if the disk refused.
    """
    written: dict[str, Path] = {}
    for suffix, metadata in (("svg", {"Date": None}), ("pdf", {"CreationDate": None}), ("png", {})):
        written[suffix] = path = _in(folder) / f"{name}.{suffix}"
        # Letters as paths, so that the drawing looks the same where a font is missing.
        look: Any = {"svg.fonttype": "path", "svg.hashsalt": "asperity", "pdf.fonttype": 42}
        with whole_file(path) as part, mpl.rc_context(look):
            Figure.savefig(figure, part, format=suffix, dpi=250, metadata=metadata)
    return written


def write_table(folder: Path, name: str, table: pd.DataFrame) -> Path:
    """Write a table as ``NAME.csv``, with a hyphen for what no name of a file has; return the file.

    `OutputError` if the disk refused.
    """
    path = _in(folder) / f"{file_name(name)}.csv"
    with whole_file(path) as part:
        table.to_csv(part, index=False)
    return path


def file_name(name: str) -> str:
    """Return a name with a hyphen for whatever is no letter, digit or underscore."""
    return re.sub(r"[^A-Za-z0-9_]+", "-", name).strip("-")


def _brief(name: str, value: object) -> Markup:
    """A value of a campaign file in words: a shape as 200 × 200, a long list by its ends."""
    if not isinstance(value, list):
        return number(value) if isinstance(value, float) else escape(value)
    words = [_brief(name, item) for item in value]
    if not words:
        return escape("none")
    if name == "shape":
        return Markup("\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}").join(words)
    ends = Markup("{} to {}").format(words[0], words[-1])
    if name == "seeds" and value == list(range(value[0], value[-1] + 1)) and len(value) > 1:
        return ends
    return Markup(", ").join(words) if len(words) <= 6 else Markup("{} ({} values)").format(ends, len(words))


def _in(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"could not write {folder}: {error.strerror or error}") from error
    return folder
