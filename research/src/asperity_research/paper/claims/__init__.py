"""The claims of the paper, section by section, each with what decides it."""

from asperity_research.paper.claims import section_3, section_4, section_5
from asperity_research.paper.claims.claim import CLAIMS
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding

__all__ = ["CLAIMS", "ledger", "section_3", "section_4", "section_5"]


def ledger(evidence: Evidence) -> tuple[Finding, ...]:
    """Judge every claim by the evidence."""
    return tuple(claim.judge(evidence) for claim in CLAIMS.values())
