"""Theory that judges the simulation, and imports nothing of it.

One contact: `compliance`, its rate, asymptotes and finite-lattice form, `site_stiffness`, `displacement`
beside the load, `response` to any force. Many contacts, far apart: `dilute_area`, `dilute_history` and what
follows from them for a law of heights. Every site in contact: `full_contact_load`. Formulas as the paper
prints them have the same names with ``_paper``. Friction: `static_friction`. Elastic half-spaces: `hertz`,
`westergaard_area`, `persson_area`. An indenter on a viscoelastic one: `ting`. Activated creep:
`flowing_area`.

Arguments broadcast, and scalars give NumPy floats. `InputError` names a number out of range, or shapes that
do not broadcast. x1 is k1/k0, x2 the reduced time k0 R t, viscous R_tilde/R, dimension 2 (square lattice) or
1 (line).
"""

from asperity.base.calls import answered as _answered
from asperity.theory.asymptotes import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    compliance_asymptote,
    compliance_asymptote_paper,
    late_slope,
    late_slope_paper,
)
from asperity.theory.continua import Hertz, hertz, persson_area, westergaard_area
from asperity.theory.dilute import (
    contacts_at_start,
    contacts_at_start_paper,
    dilute_area,
    dilute_horizon,
    exponential_growth,
    exponential_growth_paper,
    winkler_area,
)
from asperity.theory.dip import displacement
from asperity.theory.heights import EmpiricalHeights, ExponentialHeights, GaussianHeights, HeightLaw
from asperity.theory.indentation import compliance, compliance_rate, site_stiffness, torus_compliance
from asperity.theory.indenters import ting
from asperity.theory.limits import (
    flowing_area,
    full_contact_load,
    full_contact_load_relaxed,
    static_friction,
)
from asperity.theory.memory import response, response_rate
from asperity.theory.panels import Dispersion
from asperity.theory.population import dilute_history

__all__ = [
    "LATE_INTERCEPT",
    "LATE_SLOPE",
    "Dispersion",
    "EmpiricalHeights",
    "ExponentialHeights",
    "GaussianHeights",
    "HeightLaw",
    "Hertz",
    "compliance",
    "compliance_asymptote",
    "compliance_asymptote_paper",
    "compliance_rate",
    "contacts_at_start",
    "contacts_at_start_paper",
    "dilute_area",
    "dilute_history",
    "dilute_horizon",
    "displacement",
    "exponential_growth",
    "exponential_growth_paper",
    "flowing_area",
    "full_contact_load",
    "full_contact_load_relaxed",
    "hertz",
    "late_slope",
    "late_slope_paper",
    "persson_area",
    "response",
    "response_rate",
    "site_stiffness",
    "static_friction",
    "ting",
    "torus_compliance",
    "westergaard_area",
    "winkler_area",
]
__dir__ = _answered(globals())
