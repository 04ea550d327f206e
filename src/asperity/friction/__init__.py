"""Friction of contacts that age and slide: from their real area to the force, and to laws of friction."""

from asperity.ask.strength import ShearStrength as ShearStrength
from asperity.base.calls import answered as _answered
from asperity.friction import rows as rows
from asperity.friction.comparing import StateLaws as StateLaws
from asperity.friction.comparing import compare_state_laws as compare_state_laws
from asperity.friction.events import Event as Event
from asperity.friction.events import HoldPeaks as HoldPeaks
from asperity.friction.events import events_of as events_of
from asperity.friction.events import hold_peaks as hold_peaks
from asperity.friction.experiments import slide_hold_slide as slide_hold_slide
from asperity.friction.experiments import synthetic_record as synthetic_record
from asperity.friction.experiments import velocity_steps as velocity_steps
from asperity.friction.export import events_table as events_table
from asperity.friction.export import save_parameters as save_parameters
from asperity.friction.figures import events_figure as events_figure
from asperity.friction.figures import rate_and_state_figure as rate_and_state_figure
from asperity.friction.fitting import fit_events as fit_events
from asperity.friction.fitting import rate_and_state as rate_and_state
from asperity.friction.histories import record_of as record_of
from asperity.friction.laws import RateAndState as RateAndState
from asperity.friction.parameters import MachineFit as MachineFit
from asperity.friction.parameters import RateAndStateFit as RateAndStateFit
from asperity.friction.reading import read_record as read_record
from asperity.friction.records import Record as Record
from asperity.results.tabor import add_friction as add_friction

__dir__ = _answered(globals())
