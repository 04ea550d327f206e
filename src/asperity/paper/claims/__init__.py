"""The claims of the paper, section by section, each with what decides it."""

from __future__ import annotations

from asperity.paper.claims import discussion, few_contacts, self_affine, uncorrelated
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding


def ledger(evidence: Evidence) -> tuple[Finding, ...]:
    """Judge every claim by the evidence, in the order of the paper's sections."""
    sections = (uncorrelated, self_affine, few_contacts, discussion)
    return tuple(finding for section in sections for finding in section.findings(evidence))
