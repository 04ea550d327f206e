"""The claims of the paper, section by section, each with what decides it."""

from __future__ import annotations

from asperity_research.paper.claims import area_and_load, discussion, few_contacts, growth, self_affine, spots
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding

CLAIMS = {
    claim.name: claim
    for part in (area_and_load, growth, self_affine, spots, few_contacts, discussion)
    for claim in part.CLAIMS
}
"""All claims by name, in the order of the paper's sections."""


def ledger(evidence: Evidence) -> tuple[Finding, ...]:
    """Judge every claim by the evidence."""
    return tuple(claim.judge(evidence) for claim in CLAIMS.values())
