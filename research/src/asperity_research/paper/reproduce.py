"""Reproduce the paper: run the studies, draw the figures, judge the claims, write the report."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import asperity_research.studies.campaigns as campaigns
from asperity_research.paper.claims import ledger
from asperity_research.paper.figures import draw
from asperity_research.paper.report import write_report
from asperity_research.paper.studies import Effort, studies
from asperity_research.studies.campaigns import Home, Prepared
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.report import About
from asperity_research.studies.study import Concluded, Outcome

HOME = Home("a reproduction", "studies")  # Whose folder it is


def prepared_in(
    directory: str | Path, effort: Effort, *, seed: int = 0
) -> AbstractContextManager[tuple[Prepared, ...]]:
    """Write the campaign files of an effort; see `asperity_research.studies.campaigns.prepared_in`."""
    return campaigns.prepared_in(directory, studies(effort), HOME, seed=seed)


def conclude(
    directory: str | Path, prepared: Sequence[Prepared], *, effort: Effort, command: str, seconds: float
) -> Concluded:
    """Draw the figures, judge the claims and write the report, from studies that are finished.

    The command and the seconds that it took are for the report. `AsperityError` if a study is not finished,
    or the disk refused; an earlier report stays.
    """
    folder = Path(directory)
    evidence = Evidence(folder / HOME.inside)
    about = About.of(evidence, prepared, effort.name, command, wall_seconds=seconds)
    outcome = Outcome(ledger(evidence), {})
    return Concluded(write_report(folder, draw(evidence), outcome.findings, about), outcome)
