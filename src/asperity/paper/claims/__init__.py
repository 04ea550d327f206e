"""The claims of the paper, section by section, each with what decides it."""

from __future__ import annotations

from asperity.paper.claims import area_and_load, discussion, few_contacts, growth, self_affine, spots
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding


def ledger(evidence: Evidence) -> tuple[Finding, ...]:
    """Judge every claim by the evidence, in the order of the paper's sections."""
    parts = (area_and_load, growth, self_affine, spots, few_contacts, discussion)
    return tuple(finding for part in parts for finding in part.findings(evidence))
