"""Reproduce the paper: run the studies, draw the figures, judge the claims, write the report."""

from pathlib import Path

from asperity_research.paper.claims import ledger
from asperity_research.paper.figures import draw
from asperity_research.paper.report import write_report
from asperity_research.paper.studies import FULL, QUICK, studies
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Outcome
from asperity_research.studies.report import About
from asperity_research.studies.study import Inquiry


def _report(_: Inquiry, folder: Path, evidence: Evidence, outcome: Outcome, about: About) -> Path:
    return write_report(folder, draw(evidence), outcome.findings, about)


PAPER = Inquiry(
    name="studies",
    owner="a reproduction",
    quick=studies(QUICK),
    full=studies(FULL),
    analyse=lambda evidence: Outcome(ledger(evidence)),
    report=_report,
    brief=True,
)
