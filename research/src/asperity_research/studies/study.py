"""A study: a question, the campaigns that answer it, and one function for the numbers and one for the figure.

Its words stand in a text file beside its module. The report lies in its folder, beside its campaigns::

    report.md  ledger.csv  figure.svg .pdf .png  data/TABLE.csv  origin.toml  NAME/CAMPAIGN/campaign.toml
"""

import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import pandas as pd
import tomli_w
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity_research.studies.campaigns as campaigns
from asperity.base.calls import showing
from asperity.base.checks import instance
from asperity.fits import Estimate
from asperity_research.studies.campaigns import Campaign, Home, Prepared, Solid
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement, Outcome
from asperity_research.studies.report import About, write_drawing, write_report, write_table, write_text

__all__ = ["Concluded", "Inquiry", "Outcome", "Study", "Words", "conclude", "write_page"]


@dataclass(frozen=True)
class Words:
    """What a study says: its name, question, caption and page; and its claims, by key.

    A claim has a place in the literature, a sentence, what its numbers are (with braces for which), the range
    (``ends``) that they share if they do, and a note or several by key. Sentences have facts in braces. The
    axes of the figure have their scales, labels and legends: methods of `Axes`, each with what it is given.
    Solids have the fields of `Solid`.
    """

    study: Mapping[str, Any]
    axes: Sequence[Mapping[str, Mapping[str, Any]]]
    solids: Mapping[str, Solid]
    claims: Mapping[str, Mapping[str, Any]]

    @classmethod
    def beside(cls, module: str) -> Self:
        """Read them from the text file beside a module."""
        tables = tomllib.loads(Path(module).with_suffix(".toml").read_text(encoding="utf-8"))
        solids = {name: Solid(**one) for name, one in tables.pop("solids", {}).items()}
        return cls(tables.pop("study", {}), tables.pop("axes", ()), solids, tables)

    def dress(self, *axes: Axes) -> None:
        """Give axes, all of the figure in order, their scales, labels and legends."""
        for ax, looks in zip(axes, self.axes, strict=True):
            for method, how in looks.items():
                getattr(ax, method)(**how)

    def judge(
        self,
        claim: str,
        numbers: Estimate | Mapping[str, Estimate] | Sequence[Measurement],
        *,
        key: str = "",
        ends: Sequence[float] = (),
        **facts: object,
    ) -> Finding:
        """Put numbers into a claim: by what they are, within the ends of the claim or others, or measured."""
        words, key = self.claims[claim], key or claim
        numbers = {"": numbers} if isinstance(numbers, Estimate) else numbers
        if isinstance(numbers, Mapping):
            low, high = ends or words["ends"]
            label = words.get("what", "{}").format
            numbers = [Measurement(label(which), one, low, high) for which, one in numbers.items()]
        note = words.get("note", "")
        note = note if isinstance(note, str) else note.get(key, "")
        sentences = (words["claim"].format(**facts), tuple(numbers))
        return Finding(key, words["place"], *sentences, note=note.format(**facts))


Report = Callable[[Any, Path, Evidence, Outcome, About], Path]  # Writes; returns the page to read


@dataclass(frozen=True, kw_only=True)
class Inquiry:
    """Campaigns, and what is concluded from them: a study, a comparison, or the reproduction of the paper.

    Attributes
    ----------
    name
        What it is called; also the folder of its campaigns.
    quick, full
        The campaigns; the full ones hold the runs of the quick ones where that can be.
    analyse
        Computes the outcome from the finished campaigns.
    report
        Writes what was found.
    owner
        Whose folder it is, such as ``"a reproduction"``. [default: the study of the name]
    takes
        How long `analyse` takes, if longer than seconds.
    brief
        Whether the command counts the verdicts in place of saying each.
    """

    name: str
    quick: tuple[Campaign, ...]
    full: tuple[Campaign, ...]
    analyse: Callable[[Evidence], Outcome]
    report: Report
    owner: str = ""
    takes: str = ""
    brief: bool = False

    @property
    def home(self) -> Home:
        """Whose folder it writes to."""
        return Home(self.owner or f"the study {self.name}", self.name)

    def prepared_in(
        self, directory: str | Path, *, quick: bool = False, seed: int = 0
    ) -> AbstractContextManager[tuple[Prepared, ...]]:
        """Write the campaign files; see `asperity_research.studies.campaigns.prepared_in`."""
        return campaigns.prepared_in(directory, self.quick if quick else self.full, self.home, seed=seed)


def write_page(study: "Study", folder: Path, _: Evidence, outcome: Outcome, about: About) -> Path:
    """Write report, ledger, tables, origin and figure, as at the head of this module; return the report.

    `OutputError` if the disk refused.
    """
    for name, table in outcome.tables.items():
        write_table(folder / "data", name, table)
    origin = {
        "study": study.name,
        "effort": about.effort,
        "command": about.command,
        "version": about.version,
        "date": about.date.isoformat(),
        "first_seed": about.seed,
        "runs": about.runs,
        "cpu_seconds": round(about.run_seconds),
    }
    write_text(folder / "origin.toml", tomli_w.dumps({"origin": origin}))
    facts: dict[str, Any] = {"study": study, "origin": origin, "tables": outcome.tables, "about": about}
    page = write_report(folder, "asperity_research.studies", ["report.md"], outcome.findings, **facts)
    with showing("the figure"):
        write_drawing(folder, "figure", study.draw(outcome.tables))
    return page


@dataclass(frozen=True, kw_only=True)
class Study(Inquiry):
    """A question, one sentence, and what answers it.

    Attributes
    ----------
    caption
        What the figure shows; plain text with the tags i, sub and sup of HTML.
    page
        Page of the documentation that says what follows.
    draw
        Draws the figure of the tables of the outcome.
    """

    question: str
    caption: str
    page: str
    draw: Callable[[Mapping[str, pd.DataFrame]], Figure]
    report: Report = write_page


@dataclass(frozen=True, eq=False)
class Concluded:
    """What came out: the page to read, and what was found."""

    report: Path
    outcome: Outcome


def conclude(
    study: Inquiry,
    directory: str | Path,
    prepared: Sequence[Prepared],
    *,
    quick: bool,
    command: str,
    seed: int = 0,
    seconds: float = math.nan,
) -> Concluded:
    """Compute the numbers, judge, draw, and write the report, from campaigns that are finished.

    Command, first seed and the seconds that it took are for the report. `InputError` for anything but a
    study; `AsperityError` if a campaign is not finished, or the disk refused. An earlier report stays.
    """
    instance("study", study, Inquiry, 'asperity.studies.named("unloading")')
    folder = Path(directory)
    evidence = Evidence(folder / study.home.inside)
    effort = "quick" if quick else "full"
    about = About.of(evidence, prepared, effort, command, wall_seconds=seconds, seed=seed)
    outcome = study.analyse(evidence)
    return Concluded(study.report(study, folder, evidence, outcome, about), outcome)
