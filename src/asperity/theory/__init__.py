"""Closed forms that judge the simulation, and import nothing of it."""

from asperity.theory.dilute import (
    dilute_area,
    dilute_horizon,
    exponential_growth,
    exponential_growth_paper,
    winkler_area,
)
from asperity.theory.full_contact import full_contact_load, full_contact_load_relaxed
from asperity.theory.heights import EmpiricalHeights, ExponentialHeights, GaussianHeights, HeightLaw
from asperity.theory.indentation import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    compliance,
    compliance_asymptote,
    compliance_rate,
    site_stiffness,
    torus_compliance,
)

__all__ = [
    "LATE_INTERCEPT",
    "LATE_SLOPE",
    "EmpiricalHeights",
    "ExponentialHeights",
    "GaussianHeights",
    "HeightLaw",
    "compliance",
    "compliance_asymptote",
    "compliance_rate",
    "dilute_area",
    "dilute_horizon",
    "exponential_growth",
    "exponential_growth_paper",
    "full_contact_load",
    "full_contact_load_relaxed",
    "site_stiffness",
    "torus_compliance",
    "winkler_area",
]
