"""Friction of contacts that age and slide: from their real area to the force, and to laws of friction."""

from asperity.ask.strength import ShearStrength
from asperity.base.calls import answered as _answered
from asperity.friction import rows as rows  # defines StateLaws.rows
from asperity.friction.comparing import StateLaws, compare_state_laws
from asperity.friction.events import Event, HoldPeaks, events_of, hold_peaks
from asperity.friction.experiments import slide_hold_slide, synthetic_record, velocity_steps
from asperity.friction.export import events_table, save_parameters
from asperity.friction.figures import events_figure, rate_and_state_figure
from asperity.friction.fitting import fit_events, rate_and_state
from asperity.friction.histories import record_of
from asperity.friction.laws import RateAndState
from asperity.friction.parameters import MachineFit, RateAndStateFit
from asperity.friction.reading import read_record
from asperity.friction.records import Record
from asperity.results.tabor import add_friction

__all__ = [
    "Event",
    "HoldPeaks",
    "MachineFit",
    "RateAndState",
    "RateAndStateFit",
    "Record",
    "ShearStrength",
    "StateLaws",
    "add_friction",
    "compare_state_laws",
    "events_figure",
    "events_of",
    "events_table",
    "fit_events",
    "hold_peaks",
    "rate_and_state",
    "rate_and_state_figure",
    "read_record",
    "record_of",
    "save_parameters",
    "slide_hold_slide",
    "synthetic_record",
    "velocity_steps",
]
__dir__ = _answered(globals())
