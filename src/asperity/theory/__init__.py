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
from asperity.theory.asymptotes import LATE_INTERCEPT as LATE_INTERCEPT
from asperity.theory.asymptotes import LATE_SLOPE as LATE_SLOPE
from asperity.theory.asymptotes import compliance_asymptote as compliance_asymptote
from asperity.theory.asymptotes import compliance_asymptote_paper as compliance_asymptote_paper
from asperity.theory.asymptotes import late_slope as late_slope
from asperity.theory.asymptotes import late_slope_paper as late_slope_paper
from asperity.theory.continua import Hertz as Hertz
from asperity.theory.continua import hertz as hertz
from asperity.theory.continua import persson_area as persson_area
from asperity.theory.continua import westergaard_area as westergaard_area
from asperity.theory.dilute import contacts_at_start as contacts_at_start
from asperity.theory.dilute import contacts_at_start_paper as contacts_at_start_paper
from asperity.theory.dilute import dilute_area as dilute_area
from asperity.theory.dilute import dilute_horizon as dilute_horizon
from asperity.theory.dilute import exponential_growth as exponential_growth
from asperity.theory.dilute import exponential_growth_paper as exponential_growth_paper
from asperity.theory.dilute import winkler_area as winkler_area
from asperity.theory.dip import displacement as displacement
from asperity.theory.heights import EmpiricalHeights as EmpiricalHeights
from asperity.theory.heights import ExponentialHeights as ExponentialHeights
from asperity.theory.heights import GaussianHeights as GaussianHeights
from asperity.theory.heights import HeightLaw as HeightLaw
from asperity.theory.indentation import compliance as compliance
from asperity.theory.indentation import compliance_rate as compliance_rate
from asperity.theory.indentation import site_stiffness as site_stiffness
from asperity.theory.indentation import torus_compliance as torus_compliance
from asperity.theory.indenters import ting as ting
from asperity.theory.limits import flowing_area as flowing_area
from asperity.theory.limits import full_contact_load as full_contact_load
from asperity.theory.limits import full_contact_load_relaxed as full_contact_load_relaxed
from asperity.theory.limits import static_friction as static_friction
from asperity.theory.memory import response as response
from asperity.theory.memory import response_rate as response_rate
from asperity.theory.panels import Dispersion as Dispersion
from asperity.theory.population import dilute_history as dilute_history

__dir__ = _answered(globals())
