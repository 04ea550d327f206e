"""Symbols and conditions as the report spells them: plain text with the tags i, sub and sup of HTML."""

from __future__ import annotations

from asperity.paper.evidence import Evidence

AREA = "<i>A</i>"
LOAD = "<i>F</i><sub>N</sub>"
K0 = "<i>k</i><sub>0</sub>"
K1 = "<i>k</i><sub>1</sub>"
STIFFNESS_RATIO = f"{K1}/{K0}"
K_EFF = "<i>k</i><sub>eff</sub>"
TIME = "<i>t</i>"
REDUCED_TIME = f"{K0}<i>R</i>{TIME}"
SITES = "<i>N</i><sub>0</sub>"
VISCOUS = "<i>R̃</i>"


def ratio(k1: float) -> str:
    """Spell a stiffness ratio, of a study in which k0 = 1."""
    return f"{STIFFNESS_RATIO} = {k1:g}"


def per_site(load: float, evidence: Evidence, study: str) -> str:
    """Spell a load of a study in which k0 = 1."""
    return f"{LOAD}/({SITES}{K0}) = {load / evidence.sites(study):.3g}"
